// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include <functional>
#include <limits>
#include <string>

namespace excursion {

/// What a search lowers: the error of a simulation, which may run away.
class SearchProblem {
public:
    virtual ~SearchProblem() = default;

    static constexpr double ranAway = std::numeric_limits<double>::infinity();

    /// |error|^2, relative to what is to be explained; `ranAway` where the simulation does.
    virtual double cost(const Eigen::VectorXd& values) = 0;

    /// The triangular factor of [J, error] at the same scale (see TallQr), J = -d(error)/d(values).
    virtual Eigen::MatrixXd factor(const Eigen::VectorXd& values) = 0;

    /// J^T e'' at the scale of factor(), e'' = d^2 error(values + h step) / dh^2 at the values of the last factor():
    /// how the error bends along a step, as the parameters see it. Empty where it is not known; the search then goes
    /// straight.
    virtual Eigen::VectorXd curvature(const Eigen::VectorXd& /*values*/, const Eigen::VectorXd& /*step*/) { return {}; }
};

struct SearchOptions {
    int maximumIterations = 100;
    /// stop when three accepted steps in a row lower the cost by less than this fraction
    double costTolerance = 1e-8;
    /// singular values of the scaled Jacobian below this, relative to the largest, are cut off
    double rankTolerance = 1e-13;
    double damping = 1.0;         ///< to begin with, relative to the square of the largest singular value
    std::function<void()> begun;  ///< called before each iteration; may be empty, and may throw to cancel
    /// called with the start and after each step that is taken
    std::function<void(const Eigen::VectorXd& values, double cost)> accepted;
};

/// The default is failure.
struct SearchSummary {
    Eigen::VectorXd values;
    double cost = 0.0;
    double damping = 1.0;  ///< at the end: another search may go on with it
    int iterations = 0;
    bool converged = false;
    std::string reason = "the search was not run";
};

/// Levenberg and Marquardt's search with columns scaled to unit length and singular values truncated.
///
/// Errors of simulations have long curved valleys. Two things carry the search along them. The damping falls a
/// thousandfold with every step that is taken and rises by small factors until a step lowers the error at all: the
/// boldest such step, not the one that lowers the error most. And a step follows the valley's bend (geodesic
/// acceleration: Transtrum and Sethna 2012, "Improvements to the Levenberg-Marquardt algorithm", equation 8):
///     (J'J + lambda) d = J'e,  (J'J + lambda) a = J'e'',  values + d + a/2   where that is better than values + d.
/// A step on which the simulation runs away is refused.
SearchSummary search(SearchProblem&, const Eigen::VectorXd& start, const SearchOptions&);

}  // namespace excursion
