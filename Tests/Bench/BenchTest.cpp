// SPDX-License-Identifier: GPL-3.0-or-later
#include "Bench/Draw.h"
#include "Bench/Fixture.h"
#include "Bench/Stimulus.h"
#include "Bench/Truth.h"
#include "Engine/Check/TakeCheck.h"
#include "Engine/Error.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

using namespace excursion;
using namespace excursion::bench;

namespace {

double rms(std::span<const double> x)
{
    double square = 0.0;
    for (const double value : x)
        square += value * value;
    return std::sqrt(square / static_cast<double>(x.size()));
}

BenchSetup smallSetup()
{
    auto setup = quietSetup();
    setup.channels = {Quantity::voltage, Quantity::current, Quantity::displacement};
    setup.excitation.period = 8192;
    setup.excitation.levels = {1.0, 4.0};
    setup.excitation.realizations = 2;
    setup.excitation.periods = 2;
    return setup;
}

}  // namespace

TEST_CASE("a take is laid out as the format says", "[bench]")
{
    const auto setup = smallSetup();
    const auto take = measure(Loudspeaker {}, setup);
    const auto& plan = *take.excitation;
    const auto& u = take.find(Quantity::voltage)->samples;
    REQUIRE(u.size() == static_cast<std::size_t>(plan.totalSamples()));
    CHECK(take.driver.coneArea == 0.0132);
    const auto period = static_cast<std::size_t>(plan.period),
               part = static_cast<std::size_t>(plan.samplesPerRealization());
    for (std::size_t l = 0; l < 2; ++l)
        for (std::size_t r = 0; r < 2; ++r) {
            const auto first = std::span(u).subspan((2 * l + r) * part + period, period),
                       second = std::span(u).subspan((2 * l + r) * part + 2 * period, period);
            CHECK(rms(first) == Approx(plan.levels[l]).epsilon(1e-6));
            std::vector<double> change(period);
            for (std::size_t n = 0; n < period; ++n)
                change[n] = second[n] - first[n];
            CHECK(rms(change) < 1e-9);  // periodic to the last sample
        }
    CHECK(std::all_of(plan.lines.begin(), plan.lines.end(), [](int k) { return k % 2 == 1; }));
    CHECK(plan.lines.front() * setup.sampleRate / plan.period >= plan.bandLow);
    CHECK(plan.lines.back() * setup.sampleRate / plan.period <= plan.bandHigh);
}

TEST_CASE("sections that jump ring before they end, and nowhere else", "[bench]")
{
    auto setup = smallSetup();
    setup.jumps = true;
    const auto take = measure(Loudspeaker {}, setup);
    const auto& plan = *take.excitation;
    const auto& u = take.find(Quantity::voltage)->samples;
    const auto period = static_cast<std::size_t>(plan.period),
               part = static_cast<std::size_t>(plan.samplesPerRealization());
    for (std::size_t section = 0; section + 1 < 4; ++section) {
        const auto end = (section + 1) * part;
        const auto change = [&](std::size_t from, std::size_t length) {  // from one period to the next, before the end
            std::vector<double> difference(length);
            for (std::size_t n = 0; n < length; ++n)
                difference[n] = u[end - from + n] - u[end - from - period + n];
            return rms(difference) / rms(std::span(u).subspan(end - period, period));
        };
        CHECK(change(16, 16) > 1e-3);
        CHECK(change(2048, 1024) < 1e-3 * change(16, 16));
        // The first sample of the next section is already its own.
        CHECK(u[end + 16] == Approx(u[end + 16 + period]).margin(0.05 * plan.levels.back()));
    }
}

TEST_CASE("the same seed gives the same take, another one does not", "[bench]")
{
    auto setup = smallSetup();
    setup.noiseDb = -60.0;
    const auto a = measure(Loudspeaker {}, setup), b = measure(Loudspeaker {}, setup);
    for (std::size_t c = 0; c < a.channels.size(); ++c)
        CHECK(a.channels[c].samples == b.channels[c].samples);
    setup.seed = 2;
    CHECK(measure(Loudspeaker {}, setup).channels[1].samples != a.channels[1].samples);
}

TEST_CASE("noise has the level asked for, in white and pink", "[bench]")
{
    auto setup = smallSetup();
    const auto clean = measure(Loudspeaker {}, setup);
    setup.noiseDb = -60.0;
    setup.channelNoiseDb[Quantity::displacement] = -40.0;
    for (const auto colour : {NoiseColour::white, NoiseColour::pink}) {
        setup.noiseColour = colour;
        const auto take = measure(Loudspeaker {}, setup);
        for (std::size_t c = 0; c < 3; ++c) {
            auto hiss = take.channels[c].samples;
            for (std::size_t n = 0; n < hiss.size(); ++n)
                hiss[n] -= clean.channels[c].samples[n];
            const double loud = rms(std::span(clean.channels[c].samples).last(hiss.size() / 2));
            CHECK(dB(rms(hiss) / loud) == Approx(c == 2 ? -40.0 : -60.0).margin(0.5));
        }
    }
}

TEST_CASE("faults are what they say", "[bench]")
{
    auto setup = smallSetup();
    const auto good = measure(Loudspeaker {}, setup);
    const auto& x = good.find(Quantity::displacement)->samples;
    const auto faulty = [&](Fault fault) {
        setup.faults = {fault};
        const auto take = measure(Loudspeaker {}, setup);
        CHECK(take.find(Quantity::current)->samples == good.find(Quantity::current)->samples);
        return *take.find(Quantity::displacement);
    };
    using enum Fault::Kind;
    const auto late = faulty({delay, Quantity::displacement, 3.0}).samples;
    CHECK(late[20003] == Approx(x[20000]).epsilon(1e-8));
    CHECK(faulty({polarity, Quantity::displacement, 0.0}).samples[20000] == -x[20000]);
    CHECK(rms(faulty({dead, Quantity::displacement, 0.0}).samples) == 0.0);
    const auto clipped = faulty({clipping, Quantity::displacement, 0.5});
    CHECK(*std::max_element(clipped.samples.begin(), clipped.samples.end()) == clipped.fullScale);
    CHECK(clipped.fullScale
          == Approx(0.5 * std::max(*std::max_element(x.begin(), x.end()), -*std::min_element(x.begin(), x.end()))));
    CHECK(faulty({drift, Quantity::displacement, 100.0}).samples[30000] == Approx(x[29997]).epsilon(1e-8));
    const double loud = rms(std::span(x).last(x.size() / 2));
    CHECK(faulty({offset, Quantity::displacement, 0.1}).samples[20000] == Approx(x[20000] + 0.1 * loud));
    auto hummed = faulty({hum, Quantity::displacement, -30.0}).samples;
    for (std::size_t n = 0; n < hummed.size(); ++n)
        hummed[n] -= x[n];
    CHECK(dB(rms(hummed) / loud) == Approx(-30.0).margin(0.1));
}

TEST_CASE("senseless setups are refused in a sentence", "[bench]")
{
    auto setup = smallSetup();
    setup.excitation.bandHigh = 23000.0;
    CHECK_THROWS_AS(measure(Loudspeaker {}, setup), Error);
    setup = smallSetup();
    setup.excitation.grid = "R20";
    CHECK_THROWS_AS(measure(Loudspeaker {}, setup), Error);
    DrawOptions options;
    options.driver = "tweeter";
    CHECK_THROWS_AS(draw(1, options), Error);
    options = {};
    options.hidden = std::vector<HiddenEffect> {{"magic", 0.0}};
    CHECK_THROWS_AS(draw(1, options), Error);
}

namespace {

Draw someDraw(std::uint64_t seed)  // of fourteen, every class and every effect is one
{
    DrawOptions options;
    options.driver = driverClasses()[seed % driverClasses().size()];
    options.hidden = std::vector<HiddenEffect> {{effectIds()[seed % effectIds().size()], 0.0}};
    options.channels = std::vector {Quantity::voltage, Quantity::displacement};
    options.noiseDb = -INFINITY;
    options.seconds = 5.0;
    return draw(seed, options);
}

}  // namespace

TEST_CASE("a draw is repeatable", "[bench]")
{
    CHECK(truthOf(someDraw(3)) == truthOf(someDraw(3)));
    CHECK(truthOf(someDraw(3)) != truthOf(someDraw(4)));
}

TEST_CASE("draws are plausible and reach the excursion they are made for", "[bench][slow]")
{
    for (std::uint64_t seed = 1; seed <= 14; ++seed) {
        auto drawn = someDraw(seed);
        INFO("seed " << seed << " " << drawn.driver << " " << drawn.hidden.front().id);
        auto expected = std::vector<std::string> {drawn.hidden.front().id};
        if (expected.front() == "port-and-air")
            expected.insert(expected.begin(), "vented-box");
        CHECK(drawn.speaker.effects() == expected);
        CHECK(drawn.setup.excitation.period >= 8192);
        const double f0 = std::sqrt(drawn.speaker.K / drawn.speaker.m) / 6.283185307179586;
        CHECK(drawn.setup.sampleRate / drawn.setup.excitation.period <= f0 / 10.0);
        drawn.setup.excitation.levels = {drawn.setup.excitation.levels.back()};
        const auto take = measure(drawn.speaker, drawn.setup);
        const auto& x = take.find(Quantity::displacement)->samples;
        const double peak = std::max(*std::max_element(x.begin(), x.end()), -*std::min_element(x.begin(), x.end()));
        CHECK(peak > 0.4 * drawn.speaker.xmax);
        CHECK(peak < 0.95 * drawn.speaker.xmax);
    }
}

TEST_CASE("a part that swings on the cone is no delay", "[bench][slow]")
{
    for (const unsigned seed : {8320u, 9001u, 9043u, 9056u}) {
        DrawOptions options;
        options.seconds = 5.0;
        options.hidden = {{"side-resonance", 0.0}};
        const auto drawn = draw(seed, options);
        INFO("seed " << seed);
        CHECK(check(measure(drawn.speaker, drawn.setup)).fitForUse());
    }
}
