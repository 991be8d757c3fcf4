// SPDX-License-Identifier: GPL-3.0-or-later
// Targets of models without physics: what comes out is played by the model's own class.
#include "BlackBox/RandomModels.h"

#include "Engine/BlackBox/BoxLinearPart.h"
#include "Engine/BlackBox/PlayedBox.h"
#include "Engine/Error.h"
#include "Engine/Linear/Response.h"

#include <catch2/catch.hpp>

#include <complex>

using namespace excursion;

namespace {

constexpr double targetRate = 48000.0;

/// As randomPnlss() draws it.
Resonance drawnResonance(std::uint64_t seed)
{
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> draw(-1.0, 1.0);
    const double f0 = 70.0 * std::exp2(draw(random));
    return {f0, std::exp2(0.5 * draw(random))};
}

/// Output over input of a soft tone through the predistorter and the model, once it is steady.
std::complex<double> playedGain(BlackBoxPredistorter& predistorter, const Pnlss& model, double volts, double f)
{
    std::vector<double> u(static_cast<std::size_t>(1.5 * targetRate));
    const double step = 2.0 * std::numbers::pi * f / targetRate;
    for (std::size_t n = 0; n < u.size(); ++n)
        u[n] = volts * std::sin(step * static_cast<double>(n)) * std::min(1.0, static_cast<double>(n) / 4800.0);
    auto bent = u;
    predistorter.reset();
    predistorter.process(bent.data(), bent.data(), bent.size());
    const Eigen::VectorXd y =
        simulate(model, Eigen::Map<const Eigen::VectorXd>(bent.data(), static_cast<Eigen::Index>(bent.size()))).col(0);
    const auto periods = static_cast<std::size_t>(std::round(std::floor(0.4 * f) / f * targetRate));
    std::complex<double> in, out;
    for (std::size_t n = u.size() - periods; n < u.size(); ++n) {
        const auto turn = std::polar(1.0, -step * static_cast<double>(n));
        in += u[n] * turn;
        out += y[static_cast<Eigen::Index>(n)] * turn;
    }
    return out / in * std::polar(1.0, step * predistorter.latency());
}

}  // namespace

TEST_CASE("The resonance of a black box is found among its poles, and another one is put in its place", "[target]")
{
    const auto stimulus = pinkStimulus(1.5);
    for (const std::uint64_t seed : {21U, 24U}) {
        const auto model = randomPnlss(seed, targetRate, stimulus);
        const auto box = boxOf(model, stimulus);
        const auto truth = drawnResonance(seed);
        const auto own = ownLinearPart(box);
        REQUIRE(own.single);
        CHECK(own.single->frequency == Approx(truth.frequency).epsilon(0.01));
        CHECK(own.single->quality == Approx(truth.quality).epsilon(0.02));
        PredistortionControls controls;
        controls.target = {Target::Kind::resonance, 0.7 * truth.frequency, 0.6, 0.02};
        const RehearsedBox rehearsed(box);
        BlackBoxPredistorter predistorter(rehearsed, targetRate, controls);
        for (const double ratio : {0.5, 0.7, 1.0, 2.0, 5.0}) {
            const double f = ratio * truth.frequency;
            const std::complex<double> s(0.0, f),
                own2 = s * s + s * truth.frequency / truth.quality + truth.frequency * truth.frequency,
                wanted = s * s + s * controls.target.frequency / controls.target.quality
                         + controls.target.frequency * controls.target.frequency;
            const auto expected = respond(model.linear, {f}).front()(0, 0) * own2 / wanted;
            const auto found = playedGain(predistorter, model, 0.05 * stimulus.rms, f);
            INFO("seed " << seed << ", " << f << " Hz: " << std::abs(found / expected));
            CHECK(std::abs(found - expected) < 0.02 * std::abs(expected));
        }
        controls.target = {Target::Kind::closedBox, 40.0, 0.7, 0.02};
        CHECK_THROWS_AS(own.require(controls.target), Error);  // it knows no cone
    }
}

TEST_CASE("A flat band of a black box is flat in the sound that its model makes, and told as such", "[target]")
{
    const auto stimulus = pinkStimulus(1.5);
    const auto model = randomPnlss(24, targetRate, stimulus);
    const RehearsedBox rehearsed(boxOf(model, stimulus));
    PredistortionControls controls;
    controls.target.kind = Target::Kind::flat;
    controls.target.low = 0.8 * drawnResonance(24).frequency;
    controls.target.high = 500.0;
    controls.displacementLimit = rehearsed.region.farthest;
    BlackBoxPredistorter predistorter(rehearsed, targetRate, controls);
    double least = 1e9, most = -1e9;
    for (double f = controls.target.low; f <= controls.target.high; f *= 1.33) {
        const double sound = 20.0
                             * std::log10(f * f * std::abs(playedGain(predistorter, model, 0.02 * stimulus.rms, f)));
        least = std::min(least, sound);
        most = std::max(most, sound);
    }
    INFO(most - least << " dB");
    CHECK(most - least < 1.5);
    const auto told = forecastTarget(rehearsed.box, rehearsed.region, rehearsed.rest, rehearsed.rehearsal, controls,
                                     stimulus.rms);
    REQUIRE(told.targetMoves.size() == told.frequency.size());
    for (std::size_t k = 0; k < told.frequency.size(); k += 12)
        CHECK(told.ownMoves[k]
              == Approx(stimulus.rms * std::abs(respond(model.linear, {told.frequency[k]}).front()(0, 0))));
    CHECK(told.targetPink.displacement > 0.0);
    CHECK(told.targetPink.voltage > 0.9 * told.ownPink.voltage);
}

TEST_CASE("A black box of the current, which is not the sound, is given no target", "[target]")
{
    auto box = boxOf(randomPnlss(22, targetRate, pinkStimulus(1.5)), pinkStimulus(1.5));
    box.output = "current";
    const auto own = ownLinearPart(box);
    CHECK_FALSE(own.single);
    Target target {Target::Kind::resonance, 50.0, 0.7, 0.02};
    CHECK_THROWS_AS(own.require(target), Error);
    target.kind = Target::Kind::flat;
    CHECK_THROWS_WITH(own.require(target), Catch::Contains("cannot be equalized"));
    target.kind = Target::Kind::bands;
    target.curve[10] = 3.0;
    CHECK_NOTHROW(own.require(target));
}

TEST_CASE("The room that a black box is told is within the region of its fit and its margin", "[target]")
{
    const auto stimulus = pinkStimulus(1.5);
    auto box = boxOf(randomPnlss(24, targetRate, stimulus), stimulus);
    PredistortionControls controls;
    controls.margin = 0.15;
    const RehearsedBox moving(box);
    controls.displacementLimit = 0.4 * moving.region.farthest;
    const auto forecast = [&](const RehearsedBox& one, double volts) {
        return forecastTarget(one.box, one.region, one.rest, one.rehearsal, controls, volts);
    };
    const double volts = stimulus.peak, room = forecast(moving, volts).ownSine.roomDb;
    double within = 0.0, region = 0.0;
    for (double f = 15.0; f < 400.0; f *= 1.5) {
        BlackBoxPredistorter predistorter(moving, targetRate, controls);
        std::vector<double> u(static_cast<std::size_t>(1.5 * targetRate));
        for (std::size_t n = 0; n < u.size(); ++n)
            u[n] = volts * std::pow(10.0, 0.05 * (room - 0.5))
                   * std::min(1.0, 2.0 * static_cast<double>(n) / targetRate)
                   * std::sin(2.0 * std::numbers::pi * f * static_cast<double>(n) / targetRate);
        predistorter.process(u.data(), u.data(), u.size());
        const auto meters = predistorter.collectMeters();
        within = std::max(within, meters.displacementReduction);
        region = std::max(region, meters.regionReduction);
    }
    INFO(room << " dB");
    CHECK(within < 0.1);
    CHECK(region < 0.1);
    box.output = "pressure";
    const RehearsedBox heard(box);
    CHECK(forecast(heard, 6.0 * stimulus.peak).ownSine.roomDb < -15.0);
    CHECK(forecast(heard, 6.0 * stimulus.peak).ownPink.roomDb < -15.0);
}
