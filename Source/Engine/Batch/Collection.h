// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Batch/LawsOfUnits.h"
#include "Engine/Batch/Units.h"

#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace excursion {

/// What a quantity of a batch must be, in the unit of the table.
struct Limits {
    std::optional<double> least {}, most {};
};

/// One number of every unit, in the unit of datasheets; NaN where a unit does not have it.
struct Quantities {
    std::string name;  ///< "fs", "Bl(+2 mm)", "error current"
    std::string unit;
    /// what the loudspeaker is; else how well it was measured and fitted
    bool ofDriver = true;
    std::vector<double> value, standardError;  ///< one a unit

    std::size_t known = 0;  ///< units that have it
    double median = std::numeric_limits<double>::quiet_NaN();
    double spread = std::numeric_limits<double>::quiet_NaN();  ///< 1.4826 median |value - median|, a standard
                                                               ///< deviation that outliers do not move
    double mean = std::numeric_limits<double>::quiet_NaN();
    double deviation = std::numeric_limits<double>::quiet_NaN();  ///< sample standard deviation; NaN for fewer than two
    double least = std::numeric_limits<double>::quiet_NaN(), most = std::numeric_limits<double>::quiet_NaN();

    /// Slope of the straight line through the values over the units' places in the batch, per unit, and its standard
    /// error; NaN for fewer than four.
    double drift = std::numeric_limits<double>::quiet_NaN(), driftError = std::numeric_limits<double>::quiet_NaN();
    bool drifts() const;  ///< the slope exceeds 4 (1 + 8/(n - 3.5)) of its errors, n units >= 5: none of chance

    Limits limits;
    bool limited() const { return limits.least || limits.most; }
    std::size_t within = 0;  ///< units within the limits, where there are any
    /// min(mean - least, most - mean)/(3 deviation); none without limits, or for fewer than two units, or where all are
    /// the same.
    std::optional<double> Cpk;
};

/// What the batch says of one unit.
struct UnitResult {
    std::string name, verdict, sentence;
    std::string remainder;  ///< what its model leaves, in words; empty where nothing
    bool measured = true;
    std::vector<std::string> effects;       ///< found and in its model, sorted
    std::vector<std::string> beyondLimits;  ///< quantities, those among them that it does not have
    std::vector<std::string> outlying;      ///< quantities that lie off the batch
    /// effects that it has and most others do not have, and the reverse
    std::vector<std::string> additional, absent;
    bool otherVerdict = false;  ///< more than half of the batch has another one in common
    /// rms of its distances from the median, in units of spread; NaN where too little is known.
    double distance = std::numeric_limits<double>::quiet_NaN();

    /// Quantities, "has creep", "lacks creep", "its verdict".
    std::vector<std::string> standsOutBy() const;
    bool outlier() const { return !outlying.empty() || !additional.empty() || !absent.empty() || otherVerdict; }
};

struct Collection {
    std::vector<UnitResult> units;  ///< in the order of the batch
    std::vector<Quantities> quantities;
    std::vector<LawsOfUnits> laws;
    std::vector<Unread> unread;
    double threshold = 3.5;             ///< of outliers
    std::optional<std::size_t> golden;  ///< the unit nearest to the median of all; none for fewer than three
    bool limited = false;
    std::size_t measured = 0, passed = 0;  ///< units; passed: within all limits

    const Quantities* find(const std::string& name) const;
};

struct CollectOptions {
    /// m to either side, of laws over x; empty: half and all of what every unit visited
    std::vector<double> places;
    double threshold = 3.5;  ///< |value - median| over the spread, from which a unit is an outlier
    std::map<std::string, Limits> limits;
};

/// One table of a batch. Outliers are robust (Iglewicz & Hoaglin 1993): a value lies off where |value - median| exceeds
/// threshold (1 + 10/(n - 3.5)) times the spread, which counts as no less than the median standard error of the values.
/// The factor, found by simulation, makes normal values outliers in a batch of n >= 5 no more often than in a large
/// one; fewer units tell no outlier.
/// @throws Error (usage) for limits with a name that no quantity has, naming those that there are
Collection collect(const Units&, const CollectOptions&);

/// Of a JSON {"fs": {"min": 45, "max": 55}, "Qts": {"max": 0.6}}. @throws Error (input)
std::map<std::string, Limits> readLimits(const std::filesystem::path&);

}  // namespace excursion
