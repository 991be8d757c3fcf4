// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/BlackBox/BlackBoxStep.h"
#include "Engine/BlackBox/RateConverter.h"
#include "Engine/Predistortion/PeakHold.h"

#include <vector>

namespace excursion {

/// The factor that keeps the linear part of a black box in the region of its fit, and the input within the peak of the
/// fit: nobody has measured what is beyond. The linear part hears the band of the fit alone, as above it the model is
/// an accident of the fit. It gets each sample before the sample is due. A low tone that starts suddenly, far too loud,
/// nevertheless takes the loudspeaker out of the region for its first half period, because the system has a memory. The
/// peak of the input is always kept. Protection handles the excursion limit.
class RegionLimiter {
public:
    RegionLimiter(const BlackBox&, const Region&, double sampleRate);

    int reach() const { return converter_.reach(); }  ///< delay of the factor, samples
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
