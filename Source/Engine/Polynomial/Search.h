// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include <functional>
#include <string>

namespace excursion {

/// What a search lowers: the error of a simulation, which may run away.
class SearchProblem {
public:
    virtual ~SearchProblem() = default;

    /// |error|^2, relative to what is to be explained; infinite where the simulation runs away.
    virtual double cost(const Eigen::VectorXd& values) = 0;

    /// The triangular factor of [J, error] at the same scale (see TallQr), J = -d(error)/d(values).
    virtual Eigen::MatrixXd factor(const Eigen::VectorXd& values) = 0;
};

struct SearchOptions {
    int maximumIterations = 100;
    double costTolerance = 1e-8;    ///< stop when three accepted steps in a row lower the cost by less than this fraction
    double rankTolerance = 1e-13;   ///< singular values of the scaled Jacobian below this, relative to the largest, are cut off
    std::function<void()> begun;    ///< called before each iteration; may be empty, and may throw to cancel
    std::function<void(const Eigen::VectorXd& values, double cost)> accepted;   ///< called with the start and after each step that is taken
};

/// The default is failure.
struct SearchSummary {
    Eigen::VectorXd values;
    double cost = 0.0;
    int iterations = 0;
    bool converged = false;
    std::string reason = "the search was not run";
};

/// Levenberg and Marquardt's search with columns scaled to unit length and singular values truncated. The damping falls a hundredfold with every step
/// that is taken, boldly towards Gauss and Newton's: weak directions have to move early, or the search creeps along curved valleys. A step on which the
/// simulation runs away is refused.
SearchSummary search(SearchProblem&, const Eigen::VectorXd& start, const SearchOptions&);

} // namespace excursion
