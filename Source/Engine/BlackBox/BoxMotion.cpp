// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/BlackBox/BoxMotion.h"

#include "Engine/Error.h"
#include "Engine/Linear/Response.h"
#include "Engine/Numerics/LuFactors.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace excursion {
namespace {

using Eigen::MatrixXd;

constexpr double perOctave = 24.0, mostError = 0.1;
constexpr double someResonance = 60.0;  // Hz, where nothing is known of any: it splits bands, and no more

/// Hz, of the fit and below half the rate.
std::vector<double> bandOf(const BlackBox& box)
{
    std::vector<double> frequency;
    const double to = std::min(box.stimulus.highest(), 0.3 * box.linear.sampleRate);
    for (double f = box.stimulus.lowest(); f <= to; f *= std::exp2(1.0 / perOctave))
        frequency.push_back(f);
    return frequency;
}

}  // namespace

bool tellsExcursion(const BlackBox& box) { return box.output == "displacement"; }

bool drivesCoil(const BlackBox& box) { return box.input == "voltage"; }

BoxMotion::BoxMotion(const BlackBox& box)
{
    linear.ohms = 1.0;
    linear.currentByInput = 1.0;
    linear.resonance = someResonance;
    const auto band = bandOf(box);
    if (!tellsExcursion(box) || band.empty()) {
        linear.A = MatrixXd::Constant(1, 1, -1.0);
        linear.B = MatrixXd::Zero(1, 1);
        linear.displacement = Eigen::RowVectorXd::Zero(1);
        offset = Eigen::RowVectorXd::Zero(box.combinations());
        return;
    }
    const auto& of = box.linear;
    const auto n = of.order();
    const MatrixXd I = MatrixXd::Identity(n, n);
    const auto responses = respond(of, band);
    double fastest = 0.0, most = 0.0;
    for (std::size_t k = 0; k < band.size(); ++k) {
        const double moves = std::abs(responses[k](0, 0));
        most = std::max(most, moves);
        if (band[k] * moves > fastest) {
            fastest = band[k] * moves;
            linear.resonance = band[k];
        }
    }
    const double w0 = 2.0 * std::numbers::pi * linear.resonance, K = w0 / std::tan(0.5 * w0 / of.sampleRate);
    const RealLu half(I + of.A);
    linear.A = K * half.solve(of.A - I);
    linear.B = half.solve(of.B);
    linear.displacement = 2.0 * K * of.C * half.inverse();
    offset = of.C * RealLu(I - of.A).solve(box.E) + box.F;
    for (std::size_t k = 0; k < band.size(); ++k) {
        const std::complex<double> s(0.0, 2.0 * std::numbers::pi * band[k]);
        const Eigen::VectorXcd states =
            ComplexLu(s * I - linear.A.cast<std::complex<double>>()).solve(linear.B.cast<std::complex<double>>());
        const std::complex<double> foreseen = linear.displacement.cast<std::complex<double>>() * states;
        error = std::max(error, std::abs(foreseen - responses[k](0, 0)) / most);
    }
    if (!(error < mostError) || !linear.A.allFinite() || !linear.displacement.allFinite())
        throw Error(Error::Kind::data,
                    "The excursion of this model cannot be foreseen, so no limit of it could be kept.");
}

}  // namespace excursion
