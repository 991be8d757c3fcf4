// SPDX-License-Identifier: GPL-3.0-or-later
#include "Check/SoundTake.h"
#include "Engine/Check/TakeCheck.h"
#include "Estimate/SyntheticTake.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

using namespace excursion;

TEST_CASE("hum is named with its strength")
{
    for (const double mains : {50.03, 59.95}) {
        auto take = soundTake();
        auto& samples = samplesOf(take, Quantity::current);
        const auto& e = *take.excitation;
        const auto last = static_cast<std::ptrdiff_t>(e.samplesPerRealization()) * e.realizations;
        const double loud = synthetic::rms({samples.end() - last, samples.end()});
        for (std::size_t n = 0; n < samples.size(); ++n)
            for (const int h : {1, 2, 3})
                samples[n] += loud * 0.03 / h
                              * std::sin(2.0 * std::numbers::pi * h * mains * static_cast<double>(n) / take.sampleRate
                                         + h);
        const auto report = check(take);
        INFO(fatalSentences(report));
        const auto* problem = find(report, "hum", Quantity::current);
        REQUIRE(problem);
        CHECK(problem->fatal);
        const double truth = 10.0 * std::log10(0.5 * 0.03 * 0.03 * (1.0 + 1.0 / 4 + 1.0 / 9));
        CHECK(problem->value == Approx(truth).margin(3.0));
        CHECK(othersThan(report, "hum") == 0);
    }
}

TEST_CASE("hum beside a line of the period is as strong as it is")
{
    // What the average of the periods takes away of it is known: with 32768 samples at 96 kHz 50 Hz is line 17.07.
    std::mt19937_64 random(3);
    synthetic::Plan plan;
    plan.sampleRate = 96000.0;
    plan.period = 32768;
    plan.periods = 3;
    plan.realizations = 2;
    plan.noiseDb = -75.0;
    auto take = synthetic::record(synthetic::Loudspeaker(), plan, random);
    auto& samples = samplesOf(take, Quantity::current);
    const auto& e = *take.excitation;
    const auto last = static_cast<std::ptrdiff_t>(e.samplesPerRealization()) * e.realizations;
    const double loud = synthetic::rms({samples.end() - last, samples.end()});
    for (std::size_t n = 0; n < samples.size(); ++n)
        samples[n] += loud * 0.03 * std::sin(2.0 * std::numbers::pi * 50.0 * static_cast<double>(n) / take.sampleRate);
    const auto report = check(take);
    INFO(fatalSentences(report));
    const auto* problem = find(report, "hum", Quantity::current);
    REQUIRE(problem);
    CHECK(problem->value == Approx(10.0 * std::log10(0.5 * 0.03 * 0.03)).margin(2.0));
    CHECK(problem->fatal);
}

TEST_CASE("a coil that warms does not hum where lines are played at multiples of the mains")
{
    Measurement take;
    take.sampleRate = 12000.0;
    Excitation e;
    e.period = 12000;
    e.settlePeriods = 1;
    e.periods = 4;
    e.realizations = 2;
    e.levels = {1.0};
    e.lines = {20, 25, 32, 40, 50, 63, 80, 100, 125, 160, 200, 250, 315, 400, 500, 630, 800, 1000, 1250, 1600, 2000};
    take.excitation = e;
    std::mt19937 random(5);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> phase(0.0, 2.0 * std::numbers::pi);
    Channel voltage {Quantity::voltage, "V", 16.0, {}}, current {Quantity::current, "A", 4.0, {}};
    for (int m = 0; m < e.realizations; ++m) {
        std::vector<double> once(static_cast<std::size_t>(e.period), 0.0);
        for (const int line : e.lines) {
            const double at = phase(random);
            for (std::size_t n = 0; n < once.size(); ++n)
                once[n] += std::sin(2.0 * std::numbers::pi * line * static_cast<double>(n) / e.period + at);
        }
        for (int p = 0; p < e.settlePeriods + e.periods; ++p)
            for (const double value : once) {
                const double warm = static_cast<double>(current.samples.size()) / (2.0 * 5.0 * 12000.0);
                voltage.samples.push_back(value + 1e-4 * normal(random));
                current.samples.push_back(0.25 * (1.0 - 0.2 * warm) * value + 1e-4 * normal(random));
            }
    }
    take.channels = {voltage, current};
    CHECK_FALSE(find(check(take), "hum", Quantity::current));

    for (std::size_t n = 0; n < current.samples.size(); ++n)  // beside the lines it is hum all the same
        for (const int h : {1, 3})
            take.channels[1].samples[n] += 0.1 / h
                                           * std::sin(2.0 * std::numbers::pi * h * 50.07 * static_cast<double>(n)
                                                      / 12000.0);
    CHECK(find(check(take), "hum", Quantity::current));
}

TEST_CASE("clock drift is named in ppm, of one channel or of all")
{
    for (const double ppm : {50.0, -20.0, 5.0}) {
        const auto sound = soundTake();
        auto one = sound;
        const auto drifting = ppm == 5.0 ? Quantity::current : Quantity::displacement;
        samplesOf(one, drifting) = synthetic::delayed(samplesOf(one, drifting), 0.0, ppm * 1e-6);
        const auto reportOfOne = check(one);
        INFO(ppm << " ppm: " << fatalSentences(reportOfOne));
        const auto* problem = find(reportOfOne, "clock-drift", drifting);
        REQUIRE(problem);
        CHECK(problem->fatal);
        CHECK(problem->value == Approx(ppm).epsilon(0.1));
        CHECK(othersThan(reportOfOne, "clock-drift") == 0);

        auto all = sound;
        for (auto& channel : all.channels)
            channel.samples = synthetic::delayed(channel.samples, 0.0, ppm * 1e-6);
        const auto reportOfAll = check(all);
        INFO(fatalSentences(reportOfAll));
        problem = find(reportOfAll, "clock-drift", std::nullopt);
        REQUIRE(problem);
        CHECK(problem->value == Approx(ppm).epsilon(0.05));
        CHECK(othersThan(reportOfAll, "clock-drift") == 0);
    }
}

TEST_CASE("lost samples are a dropout")
{
    const auto sound = soundTake();
    const auto& e = *sound.excitation;
    const auto inside = static_cast<std::ptrdiff_t>(e.samplesPerRealization() * 4 + e.period * 2 + e.period / 2);

    auto lost = sound;  // 64 samples never arrive, on all channels; the record is padded at its end
    for (auto& channel : lost.channels) {
        channel.samples.erase(channel.samples.begin() + inside, channel.samples.begin() + inside + 64);
        channel.samples.resize(sound.length(), 0.0);
    }
    CHECK(find(check(lost), "dropout", std::nullopt));

    auto filled = sound;  // one channel holds its last value for 200 samples
    auto& samples = samplesOf(filled, Quantity::current);
    std::fill(samples.begin() + inside, samples.begin() + inside + 200, samples[static_cast<std::size_t>(inside)]);
    CHECK(find(check(filled), "dropout", Quantity::current));

    auto cut = sound;
    for (auto& channel : cut.channels)
        channel.samples.resize(static_cast<std::size_t>(e.totalSamples() - 1000));
    const auto report = check(cut);
    REQUIRE(find(report, "dropout", std::nullopt));
    CHECK(find(report, "dropout", std::nullopt)->value == 1000.0);
}

TEST_CASE("a rest position that jumps is no dropout: what repeats is fit for use")
{
    const auto sound = soundTake();
    const auto& e = *sound.excitation;
    const double rms = synthetic::rms(sound.find(Quantity::displacement)->samples);
    const auto swingsIn = [](double since) { return 1.0 - std::exp(-60.0 * since) * std::cos(300.0 * since); };
    const auto takesItsTime = [](double since) {  // a quarter of the period
        return 0.5 - 0.5 * std::cos(std::numbers::pi * std::min(1.0, 4.0 * since));
    };
    for (const auto& [share, slowly] : {std::pair {0.5, false}, {-2.0, false}, {0.4, true}, {-1.5, true}})
        for (const int period : {1, 2}) {  // the first used one, and the next
            auto take = sound;
            auto& samples = samplesOf(take, Quantity::displacement);
            const auto from = static_cast<std::size_t>(e.samplesPerRealization() * 4 + e.period * period
                                                       + e.period / 3),
                       until = from + static_cast<std::size_t>(e.samplesPerRealization() + (slowly ? 0 : e.period / 4));
            for (auto n = from; n < until; ++n) {
                const double since = static_cast<double>(n - from) / e.period;
                samples[n] += share * rms * (slowly ? takesItsTime(since) : swingsIn(since));
            }
            for (auto n = until; n < samples.size() && slowly; ++n)  // and as slowly back
                samples[n] += share * rms * (1.0 - takesItsTime(static_cast<double>(n - until) / e.period));
            const auto report = check(take);
            INFO(fatalSentences(report));
            CHECK(report.fitForUse());
            const auto* problem = find(report, "rest-jump", Quantity::displacement);
            REQUIRE(problem);
            CHECK(problem->value == Approx(std::abs(share) * rms).epsilon(0.15));
            CHECK(!find(report, "dropout", Quantity::displacement));
        }
    CHECK(!find(check(sound), "rest-jump", Quantity::displacement));
}

TEST_CASE("sound that comes later once is on no other clock")
{
    // as where the cone rests elsewhere from then on, in one realization of the loudest level
    const auto sound = soundTake();
    const auto& e = *sound.excitation;
    REQUIRE(e.realizations * (e.periods - 1) > 1);
    int told = 0;
    for (const double late : {0.1, 0.5, -0.3}) {
        auto take = sound;
        auto& samples = samplesOf(take, Quantity::pressure);
        const auto moved = synthetic::delayed(samples, late, 0.0);
        const auto from = static_cast<std::ptrdiff_t>(samples.size()) - e.period * (e.periods - 1);
        std::copy(moved.begin() + from, moved.end(), samples.begin() + from);
        const auto report = check(take);
        INFO(late << " samples: " << fatalSentences(report));
        CHECK(!find(report, "clock-drift", Quantity::pressure));
        CHECK(!find(report, "clock-drift", std::nullopt));
        if (const auto* jump = find(report, "gain-jump", Quantity::pressure)) {
            ++told;
            CHECK(jump->value < -3.0);  // of what has changed
            CHECK(jump->sentence.find("its gain stays") != std::string::npos);
        }
    }
    CHECK(told > 0);
}

TEST_CASE("a gain that dips for a while is a gain that jumps")
{
    const auto sound = soundTake();
    const auto& e = *sound.excitation;
    auto take = sound;
    auto& samples = samplesOf(take, Quantity::current);
    const auto from = samples.end() - e.period * 3 / 2 - e.period / 4;
    for (auto sample = from; sample != from + e.period; ++sample)
        *sample *= 0.5;
    const auto report = check(take);
    INFO(fatalSentences(report));
    const auto* problem = find(report, "gain-jump", Quantity::current);
    REQUIRE(problem);
    CHECK(problem->value == Approx(-6.02).margin(0.1));
    CHECK(problem->sentence.find("its gain stays") == std::string::npos);
    CHECK_FALSE(report.fitForUse());
}

TEST_CASE("a rest position that drifts does not jump, whatever the noise")
{
    const auto sound = soundTake();
    const double rms = synthetic::rms(sound.find(Quantity::displacement)->samples);
    std::mt19937 random(3);
    std::normal_distribution<double> normal;
    for (const double noise : {3e-4, 3e-3, 1e-2})
        for (const double drift : {1.0, 3.0})
            for (const double power : {1.0, 2.0}) {
                auto take = sound;
                auto& samples = samplesOf(take, Quantity::displacement);
                for (std::size_t n = 0; n < samples.size(); ++n)
                    samples[n] +=
                        rms
                        * (noise * normal(random)
                           + drift * std::pow(static_cast<double>(n) / static_cast<double>(samples.size()), power));
                INFO(noise << " " << drift << " " << power);
                CHECK(!find(check(take), "rest-jump", Quantity::displacement));
            }
}

TEST_CASE("a gain that jumps is told from samples that are lost and from a loudspeaker that changes")
{
    const auto sound = soundTake();
    const auto& e = *sound.excitation;
    const auto from = static_cast<std::size_t>(e.samplesPerRealization() * 4 + (e.settlePeriods + 1) * e.period);
    const auto until = static_cast<std::size_t>(e.samplesPerRealization() * 5);
    const auto jump = [&](Measurement& take, Quantity quantity, double factor) {
        auto& samples = samplesOf(take, quantity);
        for (auto n = from; n < until; ++n)
            samples[n] *= factor;
    };

    auto one = sound;
    jump(one, Quantity::current, 0.9);
    const auto report = check(one);
    const auto* problem = find(report, "gain-jump", Quantity::current);
    REQUIRE(problem);
    CHECK(problem->value == Approx(20.0 * std::log10(0.9)).epsilon(0.02));
    CHECK(problem->fatal);
    INFO(fatalSentences(report));
    CHECK(othersThan(report, "gain-jump") == 0);

    auto all = sound;  // what a coil does that has grown warm
    for (const auto quantity : {Quantity::current, Quantity::displacement, Quantity::pressure})
        jump(all, quantity, 0.9);
    const auto changed = check(all);
    INFO(fatalSentences(changed));
    CHECK(changed.fitForUse());
}

TEST_CASE("a transient in the first used period is not settled")
{
    auto take = soundTake();
    const auto& e = *take.excitation;
    auto& samples = samplesOf(take, Quantity::displacement);
    const double rms = synthetic::rms(samples);
    for (long r = 0; r < e.realizations * 2; ++r)
        for (long n = 0; n < e.period; ++n)
            samples[static_cast<std::size_t>(r * e.samplesPerRealization() + e.settlePeriods * e.period + n)] +=
                rms * std::exp(-static_cast<double>(n) / 2000.0);
    const auto report = check(take);
    const auto* problem = find(report, "not-settled", Quantity::displacement);
    REQUIRE(problem);
    CHECK(problem->fatal);
    CHECK_FALSE(find(report, "not-settled", Quantity::current));
}

TEST_CASE("a motion that settles from section to section, more here and less there, has lost nothing")
{
    // What a resonance keeps ringing with after each jump depends on how the two multisines meet.
    for (unsigned seed = 1; seed <= 12; ++seed) {
        auto take = soundTake();
        const auto& e = *take.excitation;
        auto& samples = samplesOf(take, Quantity::displacement);
        const auto section = static_cast<std::size_t>(e.samplesPerRealization());
        std::mt19937 random(seed);
        std::normal_distribution<double> normal;
        for (std::size_t from = 0; from + section <= samples.size(); from += section) {
            const double rms = synthetic::rms(
                {samples.begin() + static_cast<long>(from), samples.begin() + static_cast<long>(from + section)});
            const double sine = rms * normal(random), cosine = rms * normal(random);
            for (std::size_t n = 0; n < section; ++n) {
                const double t = static_cast<double>(n) / e.period, angle = 2.0 * std::numbers::pi * 20.3 * t;
                samples[from + n] += std::exp(-3.5 * t) * (sine * std::sin(angle) + cosine * std::cos(angle));
            }
        }
        const auto report = check(take);
        INFO("seed " << seed << ": " << fatalSentences(report));
        CHECK_FALSE(find(report, "gain-jump", Quantity::displacement));
        CHECK_FALSE(find(report, "dropout", Quantity::displacement));
        CHECK(find(report, "not-settled", Quantity::displacement));
    }
}

TEST_CASE("noise alone is settled, however strong")
{
    std::mt19937_64 random(5);
    synthetic::Plan plan;
    plan.periods = 4;
    plan.noiseDb = -30.0;
    const auto report = check(synthetic::record(synthetic::Loudspeaker(), plan, random));
    INFO(fatalSentences(report));
    for (const auto& channel : report.channels) {
        REQUIRE(channel.settlingDb);
        CHECK(*channel.settlingDb < -60.0);
    }
}
