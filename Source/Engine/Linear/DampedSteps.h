// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Linear/PartialFractionFit.h"

#include <Eigen/Core>
#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <string>

namespace excursion {

/// The steps of Levenberg and Marquardt's search, min |rest - J d|^2 + damping |d/scale|^2, the columns of J scaled to
/// unit length: the damping grows sixfold with every step that is refused, and falls fivefold with one that is taken.
class DampedSteps {
public:
    explicit DampedSteps(const PoleRefinementOptions& options) : options_(options) {}

    /// @param J     square, triangular or not; @param rest as long
    /// @param lower  tries a step: takes it and returns by which fraction it lowers the error, or returns 0
    template <class Lower>
    void take(const Eigen::MatrixXd& J, const Eigen::VectorXd& rest, Lower lower)
    {
        const auto n = J.cols();
        const Eigen::VectorXd scale = J.colwise().norm().transpose().unaryExpr(
            [](double length) { return length > 0.0 ? 1.0 / length : 0.0; });
        double gain = 0.0;
        accepted_ = false;
        for (int attempt = 0; attempt < 12 && !accepted_; ++attempt) {
            Eigen::MatrixXd system(2 * n, n);
            system << J * scale.asDiagonal(), std::sqrt(damping_) * Eigen::MatrixXd::Identity(n, n);
            Eigen::VectorXd right = Eigen::VectorXd::Zero(2 * n);
            right.head(n) = rest;
            const Eigen::VectorXd step = scale.cwiseProduct(Eigen::HouseholderQR<Eigen::MatrixXd>(system).solve(right));
            gain = step.allFinite() ? lower(step) : 0.0;
            accepted_ = gain > 0.0;
            damping_ = accepted_ ? std::max(0.2 * damping_, 1e-14) : 6.0 * damping_;
        }
        still_ = accepted_ && gain < options_.costTolerance ? still_ + 1 : 0;
    }

    /// Whether the search is over; then and at its largest number of iterations `summary`, with iterations, converged
    /// and reason, tells why.
    template <class Summary>
    bool ended(Summary& summary) const
    {
        summary.converged = !accepted_ || still_ >= 2;
        summary.reason = !accepted_          ? "no step lowers the error any further"
                         : summary.converged ? "the error no longer falls"
                                             : "the largest number of iterations was reached";
        return summary.converged || summary.iterations >= options_.maximumIterations;
    }

private:
    const PoleRefinementOptions& options_;
    double damping_ = 1e-3;
    int still_ = 0;
    bool accepted_ = false;
};

}  // namespace excursion
