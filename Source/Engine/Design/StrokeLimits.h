// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"

#include <optional>
#include <string>
#include <vector>

namespace excursion {

/// How far the coil may go before something has changed by as much as designers allow for about 10 % distortion (IEC
/// 62458; Klippel, "Assessment of voice coil peak displacement Xmax", JAES 51, 2003). Nothing is said beyond the
/// visited range.
struct StrokeLimit {
    /// "force factor Bl(x)", "compliance 1/K(x)", "impedance", "Doppler shift"
    std::string name;
    std::string criterion;  ///< "falls to 82 %"
    /// m, both positive; none where the criterion is not met within the range
    std::optional<double> inward, outward;
    double inwardEnd = 0.0, outwardEnd = 0.0;  ///< what is judged at the two ends of the range, %

    /// m, the shorter of both sides; none where neither is met.
    std::optional<double> stroke() const;
};

/// A figure with its standard error, NaN where unknown.
struct Estimate {
    double value = 0.0, standardError = 0.0;
};

struct StrokeLimits {
    double range = 0.0;      ///< m, visited to either side
    double resonance = 0.0;  ///< Hz, of the base
    /// Hz, at which impedance and Doppler shift are judged: 8.5 times the resonance
    double tone = 0.0;
    std::vector<StrokeLimit> limits;  ///< of the laws that the model has; the Doppler shift always

    /// Half the sum of the two places where Bl is as large as at that end of the range where it is larger: the middle
    /// of the gap as seen from where the coil rests, m, positive outward. None without Bl(x), or where Bl rises to an
    /// end of the range.
    std::optional<Estimate> gapCentre;

    /// 2 (K(-X) - K(X))/(K(-X) + K(X)) at the end X of the range, %: positive where the suspension is stiffer inward.
    std::optional<Estimate> stiffnessAsymmetry;

    /// The limit that is met first; null when none is.
    const StrokeLimit* tightest() const;
};

StrokeLimits strokeLimits(const Model&);

}  // namespace excursion
