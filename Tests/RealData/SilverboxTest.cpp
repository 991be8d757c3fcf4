// SPDX-License-Identifier: GPL-3.0-or-later
// The Silverbox, an electronic Duffing oscillator (Wigren and Schoukens 2013): the ladder sees the multisines only and
// is then asked about the arrow, noise that grows to 1.3 times what the multisines reached.
#include "Engine/Diagnosis/Improve.h"
#include "Engine/Import/ImportMat.h"
#include "Engine/Loudspeaker/Laws.h"
#include "Engine/Loudspeaker/ModelFile.h"
#include "Engine/Loudspeaker/Trajectory.h"
#include "Scratch.h"
#include "SilverboxColumns.h"

#include <Eigen/QR>

#include <cmath>

using namespace excursion;
using namespace excursion::test;

namespace {

constexpr std::size_t arrowEnd = 40500, multisineEnd = 127400;  // the input is silent at both
// of the benchmark: may tell the state at the start, is not scored
constexpr std::size_t initialWindow = 50;

std::vector<double> run(const Model& model, std::span<const double> input, double rate)
{
    Trajectory trajectory;
    REQUIRE(integrate(model, Drive(input, rate, 8), {}, trajectory));
    return trajectory.displacement;
}

/// What is left of the arrow, V rms. At its start the circuit still rings a little; while the signal is that small it
/// is linear, so the ringing is that of an undriven oscillator whose two constants the first samples tell.
double arrowError(const Model& model, const Measurement& all)
{
    const auto &u = all.find(Quantity::force)->samples, &y = all.find(Quantity::displacement)->samples;
    auto simulated = run(model, std::span(u).first(arrowEnd + 64), all.sampleRate);
    const double m = model.baseParameter("m").value, decay = model.baseParameter("Rms").value / (2.0 * m);
    const double omega = std::sqrt(model.baseParameter("K").value / m - decay * decay);
    const auto ringing = [&](std::size_t n) -> Eigen::RowVector2d {
        const double t = static_cast<double>(n) / all.sampleRate;
        return Eigen::RowVector2d(std::cos(omega * t), std::sin(omega * t)) * std::exp(-decay * t);
    };
    Eigen::MatrixXd basis(initialWindow, 2);
    Eigen::VectorXd missing(initialWindow);
    for (std::size_t n = 0; n < initialWindow; ++n) {
        basis.row(static_cast<Eigen::Index>(n)) = ringing(n);
        missing[static_cast<Eigen::Index>(n)] = y[n] - simulated[n];
    }
    const Eigen::Vector2d constants = basis.colPivHouseholderQr().solve(missing);
    double sum = 0.0;
    for (std::size_t n = initialWindow; n < arrowEnd; ++n)
        sum += std::pow(simulated[n] + ringing(n).dot(constants) - y[n], 2);
    return std::sqrt(sum / static_cast<double>(arrowEnd - initialWindow));
}

}  // namespace

TEST_CASE("The ladder climbs the Silverbox and extrapolates to the arrow", "[slow]")
{
    const auto folder = dataFolder("silverbox");
    if (folder.empty())
        return;
    auto options = silverboxColumns();
    const auto all = importMat(folder / "SNLS80mV.mat", options);
    options.from = arrowEnd;
    options.to = multisineEnd;
    const auto ladder = improve(importMat(folder / "SNLS80mV.mat", options));
    REQUIRE(ladder.rungs.size() >= 3);
    CHECK(ladder.rungs[1].added == "stiffness");
    CHECK(ladder.rungs[2].added == "damping-velocity");
    std::vector<double> millivolts;
    for (const auto& rung : ladder.rungs)
        millivolts.push_back(1e3 * arrowError(rung.model, all));
    CAPTURE(millivolts);
    CHECK(millivolts[0] == Approx(14.4).margin(0.5));  // a linear model
    CHECK(millivolts[1] <= 0.45);
    CHECK(millivolts.back() <= 0.35);
    // A model without a coil can be kept and read again.
    const auto kept = modelFromJson(nlohmann::json::parse(toJson(ladder.model()).dump()), "kept");
    CHECK(parameterVector(kept) == parameterVector(ladder.model()));
    // K(x) of a Duffing circuit is a parabola: K (1 + 3.9 x^2), and hardly bent otherwise.
    const auto curves = laws(ladder.model());
    REQUIRE(curves.size() == 2);
    const auto& K = curves.front();
    const double middle = K.value[K.value.size() / 2], end = K.argument.back();
    CHECK(K.value.back() / middle - 1.0 == Approx(3.95 * end * end).epsilon(0.06));
    CHECK(K.value.front() / middle - 1.0 == Approx(3.95 * end * end).epsilon(0.06));
}
