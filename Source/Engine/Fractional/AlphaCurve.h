// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Fractional/FractionalOptions.h"
#include "Engine/Linear/PartialFractionFit.h"

#include <limits>
#include <string>
#include <vector>

namespace excursion {

/// The best fit of a fractional model at one alpha.
struct AlphaPoint {
    double alpha = 0.0;
    double V = std::numeric_limits<double>::infinity();  ///< sum |e|^2/sigma^2; without deviations the cost
    PartialFractionFit fit;
    std::string start;
    SearchSummary refinement;
};

/// The curve V(alpha), everything but alpha at its best (see FractionalOptions). Refers to data and options, which must
/// outlive it.
class AlphaCurve {
public:
    AlphaCurve(const FrequencyData& data, const FractionalOptions& options) : data_(data), options_(options) {}

    /// Finds the points of the grid, by starts of their own and by what their neighbours have found.
    /// Throws Error (numerical) when none of them gave a model.
    void search(const Progress&);

    /// Any other point, with the poles of a near one carried to it.
    AlphaPoint at(double alpha, const AlphaPoint& near) const;

    /// The lowest point about the lowest of the grid, by golden section.
    AlphaPoint lowest() const;

    const std::vector<AlphaPoint>& points() const { return points_; }  ///< of the grid, ascending

private:
    void offer(const AlphaPoint& from, AlphaPoint& to) const;

    const FrequencyData& data_;
    const FractionalOptions& options_;
    std::vector<AlphaPoint> points_;
};

/// d2V/dalpha2 of the curve, from the Jacobian: twice the squared length of dG/dalpha/sigma at right angles to the
/// derivatives by poles, C and D. Differences of V would ask for searches that all end in the same minimum to many
/// digits. Without deviations 1/sigma is weightsOf().
double curvatureInAlpha(const PartialFractionFit&, const FrequencyData&);

}  // namespace excursion
