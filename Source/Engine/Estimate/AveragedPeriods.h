// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Estimate/Periods.h"

#include <map>
#include <mutex>
#include <tuple>
#include <vector>

namespace excursion {

/// The noise of one channel at one level, pooled over the realizations.
struct PeriodNoise {
    std::vector<double> variance;  ///< of the averaged period Ybar_k; empty when P = 1: unknown
    int degreesOfFreedom = 0;      ///< of each line, real: 2 M (P - 1); 0 when unknown
};

/// The averaged periods of a take. Each is computed when it is first asked for, and kept: a check and a record ask for
/// the same ones many times. Keeps a reference to the take, which must outlive it. Any thread may ask.
/// What is asked of a take without periods throws Error (data) as periodicExcitation() does.
class AveragedPeriods {
public:
    explicit AveragedPeriods(const Measurement& take) : take_(take) {}
    explicit AveragedPeriods(const Measurement&&) = delete;

    const Measurement& take() const { return take_; }
    const Excitation& excitation() const { return periodicExcitation(take_); }
    const std::vector<int>& lines() const { return excitedLines(take_); }  ///< that are excited

    /// The average period of one realization in the time domain (averagePeriod()).
    const std::vector<double>& inTime(const Channel&, int level, int realization) const;

    /// Its spectrum, and the scatter of the periods about it (averagedPeriod()).
    const AveragedPeriod& spectrum(const Channel&, int level, int realization) const;

    /// The scatter at one level.
    const PeriodNoise& noise(const Channel&, int level) const;

private:
    using Place = std::tuple<const Channel*, int, int>;  ///< level and realization; -1: all
    template <class Value, class Make>
    const Value& kept(std::map<Place, Value>&, const Place&, const Make&) const;

    const Measurement& take_;
    mutable std::mutex mutex_;
    mutable std::map<Place, std::vector<double>> inTime_;
    mutable std::map<Place, AveragedPeriod> spectra_;
    mutable std::map<Place, PeriodNoise> noise_;
};

}  // namespace excursion
