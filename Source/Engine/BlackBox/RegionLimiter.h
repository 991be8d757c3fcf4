// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/BlackBox/BlackBoxStep.h"
#include "Engine/BlackBox/RateConverter.h"
#include "Engine/Predistortion/PeakHold.h"
#include "Engine/Predistortion/Recovery.h"

#include <vector>

namespace excursion {

/// Turns a signal down so that the linear part of a black box stays in the region that its fit has visited, and the
/// input within its peak: what is beyond, nobody has measured. Looks ahead: the gain is there before the sample is,
/// without a step. A low tone that sets in at once far beyond takes the loudspeaker out for its first half period
/// nevertheless (at 20 times the peak 1.7 times as far as the fit has been), as what is turned down has a memory; the
/// peak of the input is kept at any time. A sample that is no number, or beyond 100 times the peak, is silence, and so
/// is what is around it.
class RegionLimiter {
public:
    RegionLimiter(const BlackBox&, const Region&, double sampleRate);

    int latency() const { return static_cast<int>(delayed_.size()); }
    void reset();

    /// @returns the sample of latency() ago, turned down where it is on; then gain() is by how much
    double step(double sample, bool on);
    double gain() const { return gain_; }
    bool faulty() const { return faulty_; }  ///< the latest sample was none

private:
    double levelOf(double sample);

    BlackBoxStep linear_;
    RateConverter converter_;
    double peak_, decay_;
    std::vector<double> x_, z_, none_, place_, white_;
    PaddedMatrix whiten_;
    double out_ = 0.0;  ///< how far out the latest place is
    PeakHold hold_;
    Recovery recovery_;
    double level_ = 1.0, gain_ = 1.0, sum_ = 0.0;
    std::vector<double> gains_, delayed_;
    std::size_t gainAt_ = 0, at_ = 0;
    bool faulty_ = false;
};

}  // namespace excursion
