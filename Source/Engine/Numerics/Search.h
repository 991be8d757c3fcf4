// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Numerics/SearchSummary.h"

#include <Eigen/Core>

#include <functional>
#include <limits>
#include <string>

namespace excursion {

/// What a search lowers: a sum of squares that is known through triangular factors, so no Jacobian need stand in
/// memory as a whole and no condition number is squared. Values are what describes a place; a step may have fewer
/// numbers, where values lie on a curved surface or where some of them are solved for.
class SearchProblem {
public:
    virtual ~SearchProblem() = default;

    static constexpr double ranAway = std::numeric_limits<double>::infinity();

    /// |error|^2, best relative to what is to be explained; `ranAway` where the model does, and where no search may go
    /// (poles that are not stable).
    virtual double cost(const Eigen::VectorXd& values) = 0;

    /// The triangular factor of [J, error] (see TallQr), J = -d(error)/d(step), square. At the scale of the cost's
    /// root, if curvature() is known.
    virtual Eigen::MatrixXd factor(const Eigen::VectorXd& values) = 0;

    /// J^T e'' at the scale of factor(), e'' = d^2 error(values + h step) / dh^2 at the values of the last factor():
    /// how the error bends along a step, as the parameters see it. Empty where it is not known; the search then goes
    /// straight.
    virtual Eigen::VectorXd curvature(const Eigen::VectorXd& /*values*/, const Eigen::VectorXd& /*step*/) { return {}; }

    /// Where a step leads. A bent step is two of them, one after the other.
    virtual Eigen::VectorXd moved(const Eigen::VectorXd& values, const Eigen::VectorXd& step) { return values + step; }
};

/// How far a search trusts its linearization: lambda in min |J d - error|^2 + lambda |d/scale|^2, the columns of J
/// scaled to unit length.
struct Damping {
    double last = 1.0;                 ///< of the step before the first one, which is tried at last / fall
    double fall = 1000.0;              ///< by which it falls with a step that is taken
    double rise = 3.1622776601683795;  ///< by which it rises with one that is refused
    double least = 1e-26, most = 1e6;
    int attempts = 64;  ///< in an iteration
    /// relative to the square of the largest singular value of the scaled J; else to 1, and where no singular value is
    /// cut off either, steps go straight and no singular values are computed
    bool ofLargest = true;

    /// Falls fivefold, rises sixfold, where the default falls a thousandfold (for errors of simulations, see search()):
    /// for poles, whose valleys are short.
    static Damping steady() { return {5e-3, 5.0, 6.0, 1e-14, std::numeric_limits<double>::infinity(), 12, false}; }
};

struct SearchOptions {
    int maximumIterations = 100;
    double costTolerance = 1e-8;  ///< an accepted step that lowers the cost by less than this fraction gains nothing
    int settledSteps = 3;         ///< so many of them in a row end the search
    double roundingCost = 1e-31;  ///< a cost below this is rounding; 0 where the cost is not a relative one
    /// singular values of the scaled Jacobian below this, relative to the largest, are cut off
    double rankTolerance = 1e-13;
    Damping damping;
    std::function<void()> begun;  ///< called before each iteration; may be empty, and may throw to cancel
    /// called with the start and after each step that is taken
    std::function<void(const Eigen::VectorXd& values, double cost)> accepted;

    bool isValid(std::string* reason = nullptr) const;
};

struct SearchResult : SearchSummary {
    Eigen::VectorXd values;
    double damping = 1.0;  ///< at the end: another search may go on with it as Damping::last
};

/// Levenberg and Marquardt's search with columns scaled to unit length and singular values truncated (More 1978;
/// [B 4.3.1, appendix C]).
///
/// Errors of simulations have long curved valleys. Two things carry the search along them. The damping falls a
/// thousandfold with every step that is taken and rises by small factors until a step lowers the error at all: the
/// boldest such step, not the one that lowers the error most. And a step follows the valley's bend (geodesic
/// acceleration: Transtrum and Sethna 2012, "Improvements to the Levenberg-Marquardt algorithm", equation 8):
///     (J'J + lambda) d = J'e,  (J'J + lambda) a = J'e'',  values + d + a/2   where that is better than values + d.
/// A step on which the model runs away is refused. Throws Error (usage) for options that make no sense.
SearchResult search(SearchProblem&, const Eigen::VectorXd& start, const SearchOptions& = {});

}  // namespace excursion
