// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include <string>
#include <vector>

namespace excursion {

/// How a fit begins; see fitPnlss.
enum class PnlssSearch {
    plain,   ///< by simulation
    guided,  ///< following the measured output
    grown,   ///< on the first quarter of each record
    any      ///< in all three ways, one after the other as long as none comes to enoughDb; the best one goes on
};

struct PnlssFitOptions {
    /// of a way, by simulation of the whole records; what leads up to that comes on top
    int maximumIterations = 100;
    /// stop when three accepted steps in a row lower the cost by less than this fraction
    double costTolerance = 1e-8;
    /// singular values of the scaled Jacobian below this, relative to the largest, are cut off
    double rankTolerance = 1e-13;
    bool linearFree = true;  ///< A, B, C, D move too
    bool estimateInitialStates =
        false;  ///< each record's first state is a parameter; else it is zero, and `skip` has to do
    PnlssSearch search = PnlssSearch::any;
    std::vector<double> guideGains {1.0, 0.5, 0.2, 0.1, 0.05, 0.02};  ///< of a guided search: see fitPnlss
    /// relative rms error, on the validation records where there are any, below which no other way is tried; of the
    /// weighted error where there are weights and no such records
    double enoughDb = -200.0;
    /// where the noise is not known: no other way is tried either once what is left is noise, as far as the input can
    /// tell (see ResidualTest.h). A gain of less than 0.1 over the number of samples, which changes no likelihood, then
    /// counts as none.
    bool judgeResidual = false;

    /// Weights of the error's spectrum, one a line 0 .. N/2 of the judged samples of each record (all equally long,
    /// periodic); empty: all equal.
    Eigen::VectorXd lineWeights;

    bool isValid(std::string* reason = nullptr) const;
};

}  // namespace excursion
