// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Check/TakeCheck.h"

#include "Check/SoundTake.h"
#include "Engine/Check/PreparedTake.h"
#include "Engine/Error.h"
#include "Estimate/SyntheticTake.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

using namespace excursion;

TEST_CASE("a sound take is fit for use")
{
    const auto report = check(soundTake());
    INFO(fatalSentences(report));
    CHECK(report.fitForUse());
    CHECK(report.problems.empty());
    REQUIRE(report.channels.size() == 4);
    CHECK(*report.channels[1].snrDb > 65.0);
    CHECK_FALSE(report.channels[1].bands.empty());
}

TEST_CASE("a late channel is named with its delay", "[slow]")
{
    for (const auto quantity : {Quantity::current, Quantity::displacement})
        for (const double samples : {3.4, -3.4, 1.0, 30.0}) {
            auto take = soundTake();
            samplesOf(take, quantity) = synthetic::delayed(samplesOf(take, quantity), samples);
            const auto report = check(take);
            INFO(name(quantity) << " by " << samples << ": " << fatalSentences(report));
            const auto* problem = find(report, "channel-delay", quantity);
            REQUIRE(problem);
            CHECK(problem->fatal);
            CHECK(problem->unit == "samples");
            CHECK(problem->value == Approx(samples).margin(0.1));
            CHECK(
                std::count_if(report.problems.begin(), report.problems.end(), [](const Problem& p) { return p.fatal; })
                == 1);
        }
}

TEST_CASE("a late voltage is blamed when current and displacement agree")
{
    auto take = soundTake();
    samplesOf(take, Quantity::voltage) = synthetic::delayed(samplesOf(take, Quantity::voltage), 3.4);
    const auto report = check(take);
    INFO(fatalSentences(report));
    const auto* problem = find(report, "channel-delay", Quantity::voltage);
    REQUIRE(problem);
    CHECK(problem->value == Approx(3.4).margin(0.1));
    CHECK_FALSE(find(report, "channel-delay", Quantity::current));
}

TEST_CASE("a reversed channel is named", "[slow]")
{
    for (const auto quantity : {Quantity::voltage, Quantity::current, Quantity::displacement, Quantity::pressure}) {
        auto take = soundTake();
        for (auto& value : samplesOf(take, quantity))
            value = -value;
        const auto report = check(take);
        INFO(name(quantity) << ": " << fatalSentences(report));
        const auto* problem = find(report, "polarity", quantity);
        REQUIRE(problem);
        CHECK(problem->fatal == (quantity != Quantity::pressure));
        CHECK(std::count_if(report.problems.begin(), report.problems.end(),
                            [](const Problem& p) { return p.kind == "polarity"; })
              == 1);
    }
}

TEST_CASE("a reversed and late channel is named for both")
{
    auto take = soundTake();
    auto& samples = samplesOf(take, Quantity::displacement);
    samples = synthetic::delayed(samples, 20.0);
    for (auto& value : samples)
        value = -value;
    const auto report = check(take);
    REQUIRE(find(report, "channel-delay", Quantity::displacement));
    CHECK(find(report, "channel-delay", Quantity::displacement)->value == Approx(20.0).margin(0.2));
    CHECK(find(report, "polarity", Quantity::displacement));
}

TEST_CASE("clipping is counted")
{
    for (const auto quantity : {Quantity::current, Quantity::pressure}) {
        auto take = soundTake();
        auto& samples = samplesOf(take, quantity);
        const double limit = 0.7 * *std::max_element(samples.begin(), samples.end());
        long clamped = 0;
        for (auto& value : samples) {
            clamped += std::abs(value) >= limit;
            value = std::clamp(value, -limit, limit);
        }
        const auto report = check(take);
        const auto* problem = find(report, "clipping", quantity);
        REQUIRE(problem);
        CHECK(problem->fatal);
        // Tops of one or two samples are not told from a peak.
        CHECK(problem->value <= static_cast<double>(clamped));
        CHECK(problem->value > 0.5 * static_cast<double>(clamped));
        CHECK(othersThan(report, "clipping") == 0);
    }
}

TEST_CASE("coarse quantization is not clipping")
{
    auto take = soundTake();
    for (auto& channel : take.channels) {
        const double step = synthetic::rms(channel.samples) / 1000.0;
        for (auto& value : channel.samples)
            value = step * std::round(value / step);
    }
    const auto report = check(take);
    INFO(fatalSentences(report));
    CHECK(report.fitForUse());
    CHECK_FALSE(find(report, "clipping", Quantity::displacement));
}

TEST_CASE("a dead channel is named, constant or noise")
{
    std::mt19937_64 random(3);
    auto take = soundTake();
    auto& samples = samplesOf(take, Quantity::displacement);
    std::fill(samples.begin(), samples.end(), 0.01);
    CHECK(find(check(take), "channel-dead", Quantity::displacement));
    std::fill(samples.begin(), samples.end(), 0.0);
    synthetic::addNoise(samples, 1e-4, random);
    auto report = check(take);
    REQUIRE(find(report, "channel-dead", Quantity::displacement));
    CHECK(othersThan(report, "channel-dead") == 0);
    take.excitation.reset();
    report = check(take);
    CHECK(find(report, "channel-dead", Quantity::displacement));
    CHECK(othersThan(report, "channel-dead") == 0);
}

TEST_CASE("a sensor that bends is named with what it takes off the peaks")
{
    for (const auto quantity : {Quantity::current, Quantity::displacement, Quantity::pressure}) {
        INFO(name(quantity));
        auto take = soundTake();
        const auto& e = *take.excitation;
        auto& samples = samplesOf(take, quantity);
        const auto loudest = samples.begin()
                             + e.samplesPerRealization() * e.realizations * (static_cast<long>(e.levels.size()) - 1);
        double most = 0.0;
        for (auto sample = loudest; sample != samples.end(); ++sample)
            most = std::max(most, std::abs(*sample));
        for (auto sample = loudest; sample != samples.end(); ++sample)
            *sample = 0.6 * most * std::tanh(*sample / (0.6 * most));
        const auto report = check(take);
        INFO(fatalSentences(report));
        const auto* problem = find(report, "overload", quantity);
        REQUIRE(problem);
        CHECK(problem->fatal);
        CHECK(problem->value == Approx(-20.0 * std::log10(0.6 * std::tanh(1.0 / 0.6))).epsilon(0.25));
        CHECK(othersThan(report, "overload") == 0);
    }
}

TEST_CASE("a cone that is nearer to the microphone when it is out bends no pressure")
{
    // p(t + x/c) on a grid of odd lines alone, where even powers of the signal are what a bend would show
    std::mt19937_64 random(4);
    synthetic::Loudspeaker driver;
    synthetic::Plan plan;
    plan.noiseDb = -75.0;
    plan.pink = false;
    plan.bandHigh = 4000.0;
    plan.outputs = {Quantity::current, Quantity::displacement, Quantity::pressure};
    for (const bool odd : {true, false}) {
        plan.everyOdd = odd;
        auto take = synthetic::record(driver, plan, random);
        auto& pressure = samplesOf(take, Quantity::pressure);
        const auto& x = samplesOf(take, Quantity::displacement);
        std::vector<double> moved(pressure.size());
        for (std::size_t n = 1; n + 1 < pressure.size(); ++n)
            moved[n] = x[n] * (pressure[n + 1] - pressure[n - 1]);
        const double scale = 0.035 * synthetic::rms(pressure) / synthetic::rms(moved);  // -29 dB
        for (std::size_t n = 0; n < pressure.size(); ++n)
            pressure[n] += scale * moved[n];
        const auto report = check(take);
        INFO((odd ? "odd: " : "odd-random: ") << fatalSentences(report));
        CHECK_FALSE(find(report, "overload", Quantity::pressure));
        CHECK(report.fitForUse());
    }
}

TEST_CASE("neither an offset nor a dead input is taken for a bend or a wrong label")
{
    auto take = soundTake();
    auto& samples = samplesOf(take, Quantity::displacement);
    const double offset = 3.0 * synthetic::rms(samples);
    for (auto& sample : samples)
        sample += offset;
    CHECK_FALSE(find(check(take), "overload", Quantity::displacement));

    auto silent = soundTake();
    std::fill(samplesOf(silent, Quantity::voltage).begin(), samplesOf(silent, Quantity::voltage).end(), 0.0);
    CHECK(find(check(silent), "channel-dead", Quantity::voltage));
}

TEST_CASE("channels that are exchanged, or called something else, are told apart by their shapes")
{
    const auto sound = soundTake();
    const auto exchanged = [&](Quantity a, Quantity b) {
        auto take = sound;
        std::swap(samplesOf(take, a), samplesOf(take, b));
        for (auto& channel : take.channels)  // in other units, too
            if (channel.quantity == a)
                for (auto& sample : channel.samples)
                    sample *= 1e3;
        return check(take);
    };
    const std::pair<Quantity, Quantity> pairs[] {{Quantity::current, Quantity::displacement},
                                                 {Quantity::current, Quantity::pressure},
                                                 {Quantity::displacement, Quantity::pressure},
                                                 {Quantity::voltage, Quantity::current}};
    for (const auto& [a, b] : pairs) {
        const auto report = exchanged(a, b);
        INFO(name(a) << " and " << name(b) << ": " << fatalSentences(report));
        CHECK(find(report, "mislabelled", a));
        CHECK(find(report, "mislabelled", b));
        CHECK(othersThan(report, "mislabelled") == 0);
    }
    for (const auto kind : {Quantity::velocity, Quantity::acceleration}) {
        auto take = sound;
        for (auto& channel : take.channels)
            if (channel.quantity == Quantity::displacement) {
                channel.quantity = kind;
                channel.unit = siUnit(kind);
            }
        const auto report = check(take);
        INFO(name(kind) << ": " << fatalSentences(report));
        const auto* problem = find(report, "mislabelled", kind);
        REQUIRE(problem);
        CHECK_THAT(problem->sentence, Catch::Contains("displacement"));
    }
}

TEST_CASE("an offset, a weak signal and a loose contact are told")
{
    std::mt19937_64 random(9);
    auto take = soundTake();
    for (auto& value : samplesOf(take, Quantity::current))
        value += 0.1;
    auto report = check(take);
    REQUIRE(find(report, "dc-offset", Quantity::current));
    CHECK(find(report, "dc-offset", Quantity::current)->value == Approx(0.1).epsilon(0.1));
    CHECK(report.fitForUse());

    take = soundTake();
    auto& samples = samplesOf(take, Quantity::pressure);
    synthetic::addNoise(samples, 0.5 * synthetic::rms(samples), random);
    report = check(take);
    CHECK(find(report, "low-snr", Quantity::pressure));
    CHECK(find(report, "poor-repeatability", Quantity::pressure));
}

TEST_CASE("a stated period in which nothing repeats is told")
{
    auto take = soundTake();
    CHECK(find(check(take), "excitation", Quantity::voltage) == nullptr);
    take.excitation->lines.clear();
    CHECK(find(PreparedTake(take).report(), "excitation", Quantity::voltage) == nullptr);  // they are found
    std::mt19937 random(7);
    std::normal_distribution<double> noise;
    for (auto& channel : take.channels)
        for (auto& x : channel.samples)
            x = noise(random);
    const auto report = PreparedTake(take).report();
    const auto* problem = find(report, "excitation", Quantity::voltage);
    REQUIRE(problem);
    CHECK(problem->fatal);
    CHECK(problem->value == take.excitation->period);
}

TEST_CASE("a take without channels that drive it, or without samples, is refused")
{
    Measurement take;
    take.sampleRate = 48000.0;
    CHECK_THROWS_AS(check(take), Error);
    take.channels.push_back({Quantity::voltage, "V", 1.0, {}});
    CHECK_THROWS_AS(check(take), Error);
}

TEST_CASE("no sound take is accused, from micro speaker to subwoofer", "[slow]")
{
    std::mt19937_64 random(2024);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    const auto between = [&](double low, double high) { return low + (high - low) * uniform(random); };
    const auto logBetween = [&](double low, double high) { return low * std::pow(high / low, uniform(random)); };

    for (int run = 0; run < 30; ++run) {
        synthetic::Loudspeaker driver;
        const double size = uniform(random);  // 0: micro speaker, 1: subwoofer
        driver.m = 1e-4 * std::pow(1500.0, size);
        const double w0 = 2.0 * std::numbers::pi * 800.0 * std::pow(25.0 / 800.0, size) * between(0.8, 1.2);
        driver.k = driver.m * w0 * w0;
        driver.r = driver.m * w0 / between(2.0, 8.0);
        driver.R = between(3.0, 8.0);
        driver.Bl = std::sqrt(driver.R * driver.m * w0 / between(0.3, 1.2));
        driver.L = driver.R * logBetween(2e-5, 4e-4);
        if (run % 2) {
            driver.semiExponent = between(0.4, 0.8);
            driver.semiK = between(0.3, 1.5) * driver.R
                           / std::pow(2.0 * std::numbers::pi * 3000.0, driver.semiExponent);
            driver.L *= between(0.0, 1.0);
        }
        if (run % 3 == 0)
            driver.creep = between(0.05, 0.2);
        driver.microphoneDelay = between(0.0, 3e-3);

        synthetic::Plan plan;
        plan.sampleRate = std::array {44100.0, 48000.0, 96000.0}[static_cast<std::size_t>(run % 3)];
        plan.period = run % 3 == 2 ? 16384 : 8192;
        plan.realizations = 1 + run % 4;
        plan.periods = 2 + run % 2;
        plan.bandHigh = between(4000.0, 15000.0);
        plan.pink = run % 5 != 0;
        plan.noiseDb = between(-90.0, -50.0);
        plan.force = run % 10 == 9;
        plan.outputs.clear();
        if (!plan.force && run % 6 != 5)
            plan.outputs.push_back(Quantity::current);
        if (run % 4 != 3 || plan.force || plan.outputs.empty())
            plan.outputs.push_back(run % 7 == 0 ? Quantity::velocity : Quantity::displacement);
        if (!plan.force && run % 3 == 1)
            plan.outputs.push_back(Quantity::pressure);

        // Distortion at about -20 dB, by the excursion at the loudest level.
        auto probe = plan;
        probe.noiseDb = -300.0;
        probe.outputs = {Quantity::displacement};
        driver.xReference = synthetic::rms(synthetic::record(driver, probe, random).channels.back().samples) * 1.4;
        // Picard iteration needs the damping of a coil to converge to as much.
        const double strength = plan.force ? 0.1 : 1.0;
        driver.evenStiffness = strength * between(-0.1, 0.1);
        driver.oddStiffness = strength * between(0.0, 0.06);
        driver.evenForce = between(-0.1, 0.1);
        driver.oddForce = between(0.0, 0.03);

        const auto take = synthetic::record(driver, plan, random);
        if (const auto* x = take.find(Quantity::displacement))
            REQUIRE(synthetic::rms(x->samples) < driver.xReference);  // it did converge
        const auto report = check(take);
        INFO("run " << run << ", m " << driver.m << ", noise " << plan.noiseDb << "\n" << fatalSentences(report));
        CHECK(report.fitForUse());
        auto music = take;  // the same samples, told nothing about them
        music.excitation.reset();
        const auto blind = check(music);
        INFO(fatalSentences(blind));
        CHECK(blind.fitForUse());
    }
}

TEST_CASE("what a sensor hisses above all that is compared makes no take unfit")
{
    std::mt19937_64 random(4);
    synthetic::Plan plan;
    plan.noiseDb = -70.0;
    auto take = synthetic::record(synthetic::Loudspeaker(), plan, random);
    auto& samples = samplesOf(take, Quantity::current);
    const double rms = synthetic::rms(samples);
    const double band = take.excitation->lines.back() * take.sampleRate / take.excitation->period;
    REQUIRE(band < 0.2 * take.sampleRate);
    std::normal_distribution<double> normal;
    double last = 0.0, before = 0.0;
    for (double& sample : samples) {  // second differences of white noise: 40 dB a decade
        const double now = normal(random);
        sample += 0.4 * rms * (now - 2.0 * last + before);
        before = last;
        last = now;
    }
    const auto report = check(take);
    INFO(fatalSentences(report));
    CHECK(std::none_of(report.problems.begin(), report.problems.end(),
                       [](const Problem& p) { return p.kind == "poor-repeatability" && p.fatal; }));
}

TEST_CASE("a voltage that was not recorded neither clips nor loses samples")
{
    auto take = soundTake();
    take.excitation.reset();
    auto& channel = *std::find_if(take.channels.begin(), take.channels.end(),
                                  [](const Channel& c) { return c.quantity == Quantity::voltage; });
    const double limit = 0.5 * *std::max_element(channel.samples.begin(), channel.samples.end());
    for (double& sample : channel.samples)  // limited, as mastered music is
        sample = std::clamp(sample, -limit, limit);
    std::fill_n(channel.samples.begin() + 20000, 3000, 0.0);  // a break
    CHECK(find(check(take), "clipping", Quantity::voltage));
    CHECK(find(check(take), "dropout", Quantity::voltage));
    channel.assumed = true;
    CHECK_FALSE(find(check(take), "clipping", Quantity::voltage));
    CHECK_FALSE(find(check(take), "dropout", Quantity::voltage));
}
