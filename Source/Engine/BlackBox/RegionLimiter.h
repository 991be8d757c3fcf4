// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/BlackBox/BlackBoxStep.h"
#include "Engine/BlackBox/RateConverter.h"
#include "Engine/Predistortion/PeakHold.h"

#include <vector>

namespace excursion {

/// By how much a signal has to be turned down so that the linear part of a black box stays in the region that its fit
/// has visited, and the input within its peak: what is beyond, nobody has measured. It is told of a sample before that
/// is due. A low tone that sets in at once far beyond takes the loudspeaker out of the region for its first half period
/// nevertheless, as what is turned down has a memory; the peak of the input is kept at any time, and a limit of the
/// excursion is Protection's.
class RegionLimiter {
public:
    RegionLimiter(const BlackBox&, const Region&, double sampleRate);

    int reach() const { return converter_.reach(); }  ///< samples by which the answer is late
    void reset();

    /// @param sample  finite
    /// @returns the factor, 0 to 1, of the sample of reach() ago and those around it
    double step(double sample);
    double latest() const { return latest_; }  ///< what the latest sample is of the most that may be

private:
    double levelOf(double sample);

    BlackBoxStep linear_;
    RateConverter converter_;
    double peak_, decay_;
    std::vector<double> x_, z_, none_, place_, white_;
    PaddedMatrix whiten_;
    double out_ = 0.0;  ///< how far out the latest place is
    PeakHold hold_;
    double level_ = 1.0, latest_ = 0.0;
};

}  // namespace excursion
