// SPDX-License-Identifier: GPL-3.0-or-later
// No unit matters: a take whose channels are scaled, each by a factor of its own, climbs the same ladder.
#include "Bench/Draw.h"
#include "Diagnosis/DuffingTake.h"
#include "Engine/Diagnosis/Improve.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/SmallSignal.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <complex>
#include <cstdio>
#include <limits>
#include <map>
#include <random>

using namespace excursion;
using namespace excursion::test;

namespace {

using Factors = std::map<Quantity, double>;

std::vector<double>& numbers(Channel& channel) { return channel.samples; }
std::vector<std::complex<double>>& numbers(Spectra::Channel& channel) { return channel.values; }

template <class AnyTake>
AnyTake scaled(AnyTake take, const Factors& factors)
{
    for (auto& channel : take.channels)
        for (auto& value : numbers(channel))
            value *= factors.at(channel.quantity);
    return take;
}

/// A power of ten between 1e-6 and 1e6 for each channel, no whole one.
Factors drawFactors(const Measurement& take, std::uint64_t seed)
{
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> exponent(-6.0, 6.0);
    Factors factors;
    for (const auto& channel : take.channels)
        factors[channel.quantity] = std::pow(10.0, exponent(random));
    return factors;
}

std::string text(const Factors& factors)
{
    std::string result;
    for (const auto& [quantity, factor] : factors) {
        char number[32];
        std::snprintf(number, sizeof number, " %.3g", factor);
        result += " " + std::string(name(quantity)) + number;
    }
    return result;
}

/// A short take of the dissertation's driver with one effect hidden (or none).
Measurement benchTake(const std::string& effect, std::vector<Quantity> channels)
{
    bench::DrawOptions options;
    options.driver = "seed";
    options.hidden.emplace();
    if (!effect.empty())
        options.hidden->push_back({effect, 0.25});
    options.noiseDb = -65.0;
    options.sampleRate = 44100.0;
    options.seconds = 1.0;
    channels.insert(channels.begin(), Quantity::voltage);
    options.channels = std::move(channels);
    auto drawn = bench::draw(7, options);
    drawn.setup.excitation.realizations = 2;
    return bench::measure(drawn.speaker, drawn.setup);
}

/// What must not depend on units.
struct Outcome {
    std::string steps;       ///< verdict, effects, those taken back
    std::vector<double> dB;  ///< by rung and channel
};

Outcome outcomeOf(const Take& take)
{
    Outcome outcome;
    try {
        const auto ladder = improve(take);
        outcome.steps = name(ladder.verdict);
        for (const auto& rung : ladder.rungs) {
            outcome.steps += " " + rung.added;
            for (const auto& channel : rung.comparison.channels)
                outcome.dB.push_back(channel.total.db);
        }
        for (const auto& effect : ladder.withdrawn)
            outcome.steps += " without " + effect;
        if (ladder.verdict == Verdict::badMeasurement)
            outcome.steps += " " + ladder.sentence;
    } catch (const std::exception& error) {
        outcome.steps = error.what();
    }
    return outcome;
}

/// Largest difference in dB; infinite when the steps differ.
double apart(const Outcome& a, const Outcome& b)
{
    if (a.steps != b.steps || a.dB.size() != b.dB.size())
        return std::numeric_limits<double>::infinity();
    double worst = 0.0;
    for (std::size_t n = 0; n < a.dB.size(); ++n)
        worst = std::max(worst, std::abs(a.dB[n] - b.dB[n]));
    return worst;
}

constexpr double tolerated = 0.01;  // dB: what rounding may do

template <class AnyTake>
void requireSameLadder(const AnyTake& take, const Outcome& plain, const Factors& factors)
{
    const auto other = outcomeOf(scaled(take, factors));
    INFO(text(factors));
    CHECK(other.steps == plain.steps);
    CHECK(apart(other, plain) < tolerated);
}

}  // namespace

TEST_CASE("A circuit read as force and displacement climbs the same ladder in any unit", "[units]")
{
    const auto take = duffingTake(0.05, -55.0, 3);
    const auto plain = outcomeOf(take);
    CAPTURE(plain.dB);
    REQUIRE(plain.steps == "complete  stiffness");
    for (const auto& [force, displacement] :
         {std::pair {1e-6, 1e6}, {1e6, 1e-6}, {1e6, 1e6}, {1e-6, 1e-6}, {3.4e-3, 3.4e-3}})
        requireSameLadder(take, plain, {{Quantity::force, force}, {Quantity::displacement, displacement}});
}

TEST_CASE("A loudspeaker climbs the same ladder in any unit", "[units]")
{
    using enum Quantity;
    const auto take = benchTake("stiffness", {current, displacement, pressure});
    const auto plain = outcomeOf(take);
    CAPTURE(plain.dB);
    REQUIRE(plain.steps == "complete  stiffness");
    requireSameLadder(take, plain, {{voltage, 3e5}, {current, 2e-6}, {displacement, 1e3}, {pressure, 7e-6}});
}

TEST_CASE("A frequency response climbs the same ladder in any unit", "[.thorough][units]")
{
    using enum Quantity;
    auto truth = makeModel("electrodynamic");
    truth = withEffect(truth, effectNamed("eddy-currents"), {});
    truth.components.back().parameters.front().value = 0.02;
    Spectra spectra;
    for (double f = 15.0; f < 8000.0; f *= 1.05)
        spectra.frequency.push_back(f);
    auto responses = respond(truth, {current, displacement}, spectra.frequency);
    for (auto& response : responses)  // as rough as measured curves are
        for (std::size_t k = 0; k < response.value.size(); ++k)
            response.value[k] *= 1.0 + std::polar(3e-3, 2.4 * static_cast<double>(k * k));
    spectra.channels = {{voltage, "V", std::vector<std::complex<double>>(spectra.frequency.size(), 1.0)},
                        {current, "A", responses[0].value},
                        {displacement, "m", responses[1].value}};
    const auto plain = outcomeOf(spectra);
    CAPTURE(plain.dB);
    // what is left of a response is never known to be noise
    REQUIRE(plain.steps == "unknown-effect  eddy-currents");
    for (const auto& [u, i, x] : {std::tuple {1e-6, 1e6, 1e6}, {1e6, 2e-6, 1e-6}, {3.4, 5e3, 1e-3}})
        requireSameLadder(spectra, plain, {{voltage, u}, {current, i}, {displacement, x}});
}

/// Ladders of one take in `draws` drawn units; how many are as in its own.
int countSame(const std::string& what, const Measurement& take, int draws, std::uint64_t seed)
{
    const auto plain = outcomeOf(take);
    std::printf("%s: %s, %.2f dB\n", what.c_str(), plain.steps.c_str(), plain.dB.empty() ? 0.0 : plain.dB.back());
    REQUIRE_FALSE(plain.dB.empty());  // two failures are no ladders
    int same = 0;
    for (int draw = 0; draw < draws; ++draw) {
        const auto factors = drawFactors(take, seed + static_cast<std::uint64_t>(draw));
        const auto other = outcomeOf(scaled(take, factors));
        const double distance = apart(other, plain);
        same += distance < tolerated;
        std::printf("  %s: %s, %.1e dB apart\n", text(factors).c_str(), other.steps.c_str(), distance);
        std::fflush(stdout);
    }
    return same;
}

TEST_CASE("Ladders in units drawn at random are the same", "[.study]")
{
    using enum Quantity;
    const std::vector<std::pair<std::string, Measurement>> takes {
        {"circuit", duffingTake(0.05, -55.0, 3)},
        {"linear circuit", duffingTake(0.0, -70.0, 4)},
        {"force factor", benchTake("force-factor", {current, displacement})},
        {"stiffness", benchTake("stiffness", {current, displacement, pressure})},
        {"inductance", benchTake("inductance-position", {current, displacement})},
        {"eddy currents", benchTake("eddy-currents", {current})},
        {"creep", benchTake("creep", {current, velocity})},
        {"damping", benchTake("damping-velocity", {current, pressure})},
        {"stiffness by current", benchTake("stiffness", {current})},
        {"force factor by motion", benchTake("force-factor", {displacement})},
    };
    constexpr int draws = 5;
    for (std::size_t k = 0; k < takes.size(); ++k)
        CHECK(countSame(takes[k].first, takes[k].second, draws, 500 * k + 1) == draws);
}

TEST_CASE("Ladders of takes that tell less are the same in units drawn at random", "[.study]")
{
    using enum Quantity;
    constexpr int draws = 3;
    auto noArea = benchTake("damping-velocity", {current, pressure});
    noArea.driver.coneArea.reset();
    auto aperiodic = duffingTake(0.05, -55.0, 3);
    aperiodic.excitation.reset();
    for (auto& channel : aperiodic.channels)
        channel.samples.resize(6000);
    CHECK(countSame("damping, area unknown", noArea, draws, 1) == draws);
    CHECK(countSame("circuit, no periods", aperiodic, draws, 1) == draws);
    CHECK(countSame("stiffness by pressure", benchTake("stiffness", {pressure}), draws, 1) == draws);
}
