// SPDX-License-Identifier: GPL-3.0-or-later
// The sound of virtual loudspeakers, spoilt as microphones and rooms spoil it.
#include "Bench/Draw.h"
#include "Engine/Check/PreparedTake.h"
#include "SeedDriver.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>
#include <random>

using namespace excursion;

namespace {

const std::vector<Quantity> withMotion {Quantity::current, Quantity::displacement, Quantity::pressure};

Channel& pressureOf(Measurement& take)
{
    for (auto& channel : take.channels)
        if (channel.quantity == Quantity::pressure)
            return channel;
    throw std::logic_error("no pressure");
}

/// A coupling capacitor, by the bilinear transform with the corner where it belongs.
void rollOff(std::vector<double>& x, double corner, double sampleRate)
{
    const double g = std::tan(std::numbers::pi * corner / sampleRate);
    double before = 0.0, y = 0.0;
    for (auto& value : x) {
        y = ((value - before) + (1.0 - g) * y) / (1.0 + g);
        before = value;
        value = y;
    }
}

void echo(std::vector<double>& x, std::size_t late, double gain)
{
    for (std::size_t n = x.size(); n-- > late;)
        x[n] += gain * x[n - late];
}

/// Noise that decays by 60 dB within a time (s), a millisecond after the sound, of this power relative to it.
void room(std::vector<double>& x, double time, double gain, double sampleRate)
{
    std::mt19937 generator(11);
    std::normal_distribution<double> normal;
    const auto length = static_cast<std::size_t>(time * sampleRate),
               begin = static_cast<std::size_t>(1e-3 * sampleRate);
    std::vector<double> response(length, 0.0);
    double power = 0.0;
    for (std::size_t n = begin; n < length; ++n) {
        response[n] = normal(generator) * std::pow(10.0, -3.0 * static_cast<double>(n) / static_cast<double>(length));
        power += response[n] * response[n];
    }
    const auto dry = x;
    for (std::size_t n = begin; n < length; ++n) {
        const double h = response[n] * gain / std::sqrt(power);
        for (std::size_t t = n; t < x.size(); ++t)
            x[t] += h * dry[t - n];
    }
}

const Problem* found(const CheckReport& report, const char* kind)
{
    for (const auto& problem : report.problems)
        if (problem.kind == kind)
            return &problem;
    return nullptr;
}

}  // namespace

TEST_CASE("A microphone's roll-off is told, and the record is free of it", "[check][sound]")
{
    const auto straight = seedTake({{"stiffness", 0.3}}, withMotion);
    auto take = straight;
    const double corner = 9.0;
    rollOff(pressureOf(take).samples, corner, take.sampleRate);
    const PreparedTake prepared(take);
    CHECK(prepared.report().fitForUse());
    const auto* problem = found(prepared.report(), "roll-off");
    REQUIRE(problem);
    CHECK(problem->channel == Quantity::pressure);
    CHECK(problem->value == Approx(corner).epsilon(0.02));
    CHECK_FALSE(found(prepared.report(), "sound-path"));
    // The high-pass settles within the period that is left out; what it makes of the noise is not compared.
    const PreparedTake plain(straight);
    const auto &record = prepared.record(), &truth = plain.record();
    REQUIRE(record.sections.size() == truth.sections.size());
    REQUIRE_FALSE(record.sections.empty());
    const auto c = *record.channelIndex(Quantity::pressure);
    for (std::size_t s = 0; s < record.sections.size(); ++s) {
        double error = 0.0, noise = 0.0;
        for (const int line : record.sections[s].excited) {
            const auto k = static_cast<std::size_t>(line);
            error += std::norm(record.sections[s].measured[c][k] - truth.sections[s].measured[c][k]);
            noise += std::pow(truth.sections[s].deviation[c][k], 2);
        }
        CHECK(error < 4.0 * noise);
    }
}

TEST_CASE("A microphone's roll-off is told behind a port, which bends the sound near it, and only where there is one",
          "[check][sound]")
{
    for (const std::uint64_t seed : {31U, 33U, 35U, 38U, 41U, 42U}) {
        bench::DrawOptions options;
        options.driver = "woofer";
        options.hidden = {{"vented-box", 0.4}};
        options.seconds = 2.0;
        options.noiseDb = seed % 2 == 0 ? -75.0 : -90.0;
        options.channels = withMotion;
        options.channels->insert(options.channels->begin(), Quantity::voltage);
        const auto drawn = bench::draw(seed, options);
        auto take = bench::measure(drawn.speaker, drawn.setup);
        INFO("seed " << seed);
        CHECK_FALSE(found(PreparedTake(take).report(), "roll-off"));
        const double corner = 6.0 + 2.0 * static_cast<double>(seed % 4);
        rollOff(pressureOf(take).samples, corner, take.sampleRate);
        const PreparedTake prepared(take);
        const auto* problem = found(prepared.report(), "roll-off");
        REQUIRE(problem);
        CHECK(problem->value == Approx(corner).epsilon(0.2));
        CHECK_FALSE(found(prepared.report(), "sound-path"));
    }
}

TEST_CASE("Pressure of which a part comes from a room is set aside", "[check][sound]")
{
    const auto straight = seedTake({{"stiffness", 0.3}}, withMotion);
    const auto judged = [](Measurement take) {
        const PreparedTake prepared(std::move(take));
        CHECK(prepared.report().fitForUse());
        CHECK_FALSE(found(prepared.report(), "roll-off"));
        const auto* problem = found(prepared.report(), "sound-path");
        REQUIRE(problem);
        CHECK(problem->channel == Quantity::pressure);
        CHECK(prepared.record().channels == std::vector {Quantity::current, Quantity::displacement});
        return problem->value;  // dB
    };
    auto wall = straight;
    echo(pressureOf(wall).samples, 300, 0.1);
    CHECK(judged(wall) == Approx(-20.0).margin(2.0));
    auto hall = straight;
    room(pressureOf(hall).samples, 0.2, 0.2, hall.sampleRate);
    CHECK(judged(hall) == Approx(-14.0).margin(4.0));
}

TEST_CASE("What a loudspeaker does to its own sound is no fault of the path", "[check][sound]")
{
    for (const auto* effect : {"stiffness", "force-factor", "vented-box", "cone-breakup", "doppler", "side-resonance",
                               "eddy-currents", "creep", "friction"})
        for (const auto* driver : {"micro", "midrange", "woofer"}) {
            INFO(driver << " with " << effect);
            bench::DrawOptions options;
            options.driver = driver;
            options.hidden = {{effect, 0.4}};
            options.seconds = 2.0;
            options.channels = withMotion;
            options.channels->insert(options.channels->begin(), Quantity::voltage);
            const auto drawn = bench::draw(21, options);
            const PreparedTake prepared(bench::measure(drawn.speaker, drawn.setup));
            CHECK_FALSE(found(prepared.report(), "roll-off"));
            CHECK_FALSE(found(prepared.report(), "sound-path"));
        }
}
