// SPDX-License-Identifier: GPL-3.0-or-later
// The sound of a measurement, block by block, without a device: what is played and kept, and what ends it.
#include "Audio/Measure.h"
#include "Audio/Procedure.h"
#include "Scratch.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <deque>
#include <functional>
#include <limits>
#include <random>

using namespace excursion;
using namespace excursion::audio;
using excursion::test::refused;

namespace {

constexpr double rate = 8000.0;
constexpr std::size_t period = 800, delay = 320;  // a block is shorter than the delay

std::vector<float> someSound()
{
    std::mt19937_64 random(3);
    std::uniform_real_distribution<float> uniform(-0.4f, 0.4f);
    std::vector<float> sound(5 * period);
    for (auto& s : sound)
        s = uniform(random);
    sound[3 * period + 11] = 0.8f;
    return sound;
}

ProcedureOptions someOptions()
{
    ProcedureOptions options;
    options.sampleRate = rate;
    options.sound = someSound();
    options.loudest.assign(options.sound.begin() + 3 * period, options.sound.begin() + 4 * period);
    options.inputs.resize(1);
    options.inputs[0].quantity = Quantity::voltage;
    options.inputs[0].factor = 16.0;
    options.rise = 2.0;
    options.ringSeconds = 20.0;
    return options;
}

/// A procedure and what is connected to it: the output comes back as input 1, half as large and `delay` samples late.
struct Bench {
    explicit Bench(const ProcedureOptions& options, std::uint64_t seed = 1)
        : procedure(options), random(seed), back(delay, 0.0f), recorded(static_cast<std::size_t>(options.recorded))
    {
    }

    /// Blocks of random sizes until the procedure has ended, and some more.
    void run(std::size_t most = 1000000)
    {
        int after = 3;
        while (played.size() < most && after > 0) {
            block(std::uniform_int_distribution<std::size_t>(1, 300)(random));
            if (procedure.ended())
                --after;
        }
        procedure.readRecorded(recorded);
    }

    void block(std::size_t frames)
    {
        std::vector<std::vector<float>> in(recorded.size(), std::vector<float>(frames)), out(2);
        for (auto& channel : out)
            channel.assign(frames, 0.7f);
        for (std::size_t n = 0; n < frames; ++n) {
            const float x = gain * back.front();
            back.pop_front();
            for (auto& channel : in)
                channel[n] = shape(x, played.size() + n);
            if (second)
                in[1][n] = second(x);
            back.push_back(0.0f);  // for what is to be played now
        }
        std::vector<const float*> inPlaces;
        for (auto& channel : in)
            inPlaces.push_back(channel.data());
        std::vector<float*> outPlaces {out[0].data(), out[1].data()};
        Block now;
        const bool given = nothingAt == 0 || played.size() < nothingAt;
        now.in = given ? inPlaces.data() : nullptr;
        now.out = outPlaces.data();
        now.inputs = in.size();
        now.outputs = 2;
        now.frames = frames;
        now.broken = !given || (brokenAt > 0 && played.size() < brokenAt && played.size() + frames >= brokenAt);
        procedure.process(now);
        played.insert(played.end(), out[0].begin(), out[0].end());
        std::copy(out[0].begin(), out[0].end(), back.end() - static_cast<std::ptrdiff_t>(frames));
        for (const float s : out[1])
            otherOutput = std::max(otherOutput, std::abs(s));
        if (askAt > 0 && played.size() >= askAt)
            procedure.stop();
    }

    Procedure procedure;
    std::mt19937_64 random;
    std::deque<float> back;
    std::vector<std::vector<float>> recorded;
    std::vector<float> played;
    float gain = 0.5f, otherOutput = 0.0f;
    std::size_t brokenAt = 0, askAt = 0, nothingAt = 0;
    std::function<float(float)> second;
    std::function<float(float, std::size_t)> shape = [this](float x, std::size_t) {
        return x + 1e-4f * static_cast<float>(normal(random));
    };
    std::normal_distribution<double> normal;
};

constexpr std::size_t listening = 4000, rising = 16000 + 1600 + period + 240, pausing = 4000;

float peakIn(const std::vector<float>& x, std::size_t from, std::size_t to)
{
    float peak = 0.0f;
    for (auto n = from; n < to; ++n)
        peak = std::max(peak, std::abs(x[n]));
    return peak;
}

}  // namespace

TEST_CASE("A procedure listens, rises to its loudest period and plays the sound once", "[audio]")
{
    const auto options = someOptions();
    Bench bench(options);
    bench.run();
    REQUIRE(bench.procedure.ending().kind == Ending::Kind::complete);
    const auto& played = bench.played;
    CHECK(bench.otherOutput == 0.0f);
    CHECK(peakIn(played, 0, listening) == 0.0f);
    // 0.8 at full level; by 20 dB a second
    CHECK(peakIn(played, listening, listening + period) < 0.8f * 0.0130f);
    for (std::size_t n = listening + period; n + period < listening + 16000; n += period) {
        const double t = static_cast<double>(n + period - listening) / rate;
        CHECK(peakIn(played, n, n + period) <= 0.8001 * std::pow(10.0, t - 2.0));
        CHECK(peakIn(played, n, n + period) > peakIn(played, n - period, n));
    }
    CHECK(peakIn(played, listening + 16000, listening + rising) == 0.8f);
    const auto begin = listening + rising + pausing;
    CHECK(peakIn(played, listening + rising, begin) == 0.0f);
    CHECK(std::equal(options.sound.begin(), options.sound.end(), played.begin() + static_cast<std::ptrdiff_t>(begin)));
    CHECK(peakIn(played, begin + options.sound.size(), played.size()) == 0.0f);

    // What is kept begins with the pause.
    REQUIRE(bench.recorded[0].size() == pausing + options.sound.size() + 8000);
    for (std::size_t n = 0; n < options.sound.size(); ++n)
        REQUIRE(std::abs(bench.recorded[0][pausing + delay + n] - 0.5f * options.sound[n]) < 1e-3f);
    CHECK(bench.procedure.heard().at(0) > 500.0);
    CHECK(bench.procedure.fraction() == 1.0);
}

TEST_CASE("What is played does not depend on the blocks", "[audio]")
{
    Bench one(someOptions(), 1), other(someOptions(), 2);
    one.run();
    other.run();
    const auto length = std::min(one.played.size(), other.played.size());
    CHECK(
        std::equal(one.played.begin(), one.played.begin() + static_cast<std::ptrdiff_t>(length), other.played.begin()));
}

TEST_CASE("Told to stop, a procedure fades within 30 ms and is silent ever after", "[audio]")
{
    Bench whole(someOptions());
    whole.run();
    std::mt19937_64 random(7);
    for (int draw = 0; draw < 40; ++draw) {
        Bench bench(someOptions(), static_cast<std::uint64_t>(draw));
        const auto begin = listening + rising + pausing;
        const auto within = [&random](std::size_t from, std::size_t to) {
            return std::uniform_int_distribution<std::size_t>(from, to)(random);
        };
        bench.askAt = draw % 2 ? within(begin + 1, begin + 5 * period - 900)
                               : within(listening + 300, listening + rising - 1200);
        bench.run();
        CHECK(bench.procedure.ending().kind == Ending::Kind::stopped);
        std::size_t same = 0;
        while (same < bench.played.size() && bench.played[same] == whole.played[same])
            ++same;
        const std::size_t fade = 240;
        REQUIRE(same + fade < bench.played.size());
        CHECK(same >= bench.askAt);
        CHECK(same <= bench.askAt + 2 * 300);
        for (std::size_t n = same; n < bench.played.size(); ++n)
            if (n < same + fade)
                REQUIRE(std::abs(bench.played[n]) <= std::abs(whole.played[n]) + 1e-7f);
            else
                REQUIRE(bench.played[n] == 0.0f);
        // half way down it is half as loud
        const auto middle = same + fade / 2;
        for (auto n = middle - 3; n < middle + 3; ++n)
            CHECK(std::abs(bench.played[n] - 0.5f * whole.played[n]) <= 0.06f * std::abs(whole.played[n]) + 1e-6f);
    }
}

TEST_CASE("A limit ends the rise before it is left far behind", "[audio]")
{
    auto options = someOptions();
    for (const double limit : {0.2, 1.0, 5.0}) {
        options.inputs[0].limit = limit;
        Bench bench(options);
        bench.run();
        const auto& ending = bench.procedure.ending();
        REQUIRE(ending.kind == Ending::Kind::limit);
        CHECK(ending.stage == Stage::rising);
        CHECK(ending.value >= limit);
        CHECK(ending.value < 1.5 * limit);
        CHECK(ending.gain == Approx(limit / (16.0 * 0.5 * 0.8)).epsilon(0.4));
        CHECK(16.0 * 0.5 * peakIn(bench.played, 0, bench.played.size()) < 1.5 * limit);
        CHECK_THAT(sentenceOf(ending, options), Catch::Contains("The voltage reached ")
                                                    && Catch::Contains("beyond its limit of")
                                                    && Catch::Contains("dB below full level"));
    }
    options.inputs[0].limit = 16.0 * 0.5 * 0.8 * 1.01;
    Bench within(options);
    within.run();
    CHECK(within.procedure.ending().kind == Ending::Kind::complete);
}

TEST_CASE("A displacement is limited from where it rests, and where it rests is learnt in silence", "[audio]")
{
    auto options = someOptions();
    options.inputs[0] = {0, Quantity::displacement, 0.008, 0.0025};
    Bench bench(options);
    bench.shape = [](float x, std::size_t) { return 0.45f - x; };  // 3.6 mm off, moving by 3.2 mm at most
    bench.run();
    const auto& ending = bench.procedure.ending();
    REQUIRE(ending.kind == Ending::Kind::limit);
    CHECK(ending.value == Approx(0.0025).epsilon(0.2));
    CHECK_THAT(sentenceOf(ending, options), Catch::Contains("displacement") && Catch::Contains("0.0025 m"));
    options.inputs[0].limit = 0.0033;
    Bench within(options);
    within.shape = bench.shape;
    within.run();
    CHECK(within.procedure.ending().kind == Ending::Kind::complete);
}

TEST_CASE("An input that clips ends the measurement, in silence, in the rise and later", "[audio]")
{
    Bench loud(someOptions());
    loud.gain = 2.0f;
    loud.run();
    CHECK(loud.procedure.ending().kind == Ending::Kind::clipping);
    CHECK(loud.procedure.ending().stage == Stage::rising);
    CHECK(loud.procedure.meter(0).clipped);
    CHECK_THAT(sentenceOf(loud.procedure.ending(), someOptions()), Catch::Contains("input 1 (voltage) clips"));

    for (const float bad : {1.0f, -1.0f, 3.0f, std::numeric_limits<float>::quiet_NaN()})
        for (const std::size_t at : {std::size_t {9}, listening + rising + pausing + 2 * period}) {
            Bench one(someOptions());
            one.shape = [bad, at](float x, std::size_t n) { return n == at ? bad : x + (n % 2 ? 1e-4f : 0.0f); };
            one.run();
            CHECK(one.procedure.ending().kind == Ending::Kind::clipping);
            CHECK(one.procedure.ending().stage == (at == 9 ? Stage::listening : Stage::playing));
            if (at == 9)
                CHECK(peakIn(one.played, 0, one.played.size()) == 0.0f);
        }
}

TEST_CASE("A rise of which nothing arrives ends well below full level", "[audio]")
{
    for (const float noise : {0.0f, 1e-4f, 0.05f}) {
        Bench deaf(someOptions());
        deaf.shape = [&deaf, noise](float, std::size_t) {
            return noise * static_cast<float>(deaf.normal(deaf.random));
        };
        deaf.run();
        CHECK(deaf.procedure.ending().kind == Ending::Kind::unheard);
        CHECK(peakIn(deaf.played, 0, deaf.played.size()) < 0.8f * 0.4f);
        CHECK_THAT(sentenceOf(deaf.procedure.ending(), someOptions()), Catch::Contains("Nothing of what is played"));
    }
}

TEST_CASE("Inputs that stand still while the plan is played have lost their device", "[audio]")
{
    auto options = someOptions();
    options.sound.resize(20 * period, 0.1f);
    Bench bench(options);
    const auto at = listening + rising + pausing + 100;
    bench.shape = [at](float x, std::size_t n) { return n < at ? x + (n % 2 ? 1e-4f : 0.0f) : 0.0f; };
    bench.run();
    REQUIRE(bench.procedure.ending().kind == Ending::Kind::frozen);
    CHECK(bench.procedure.ending().seconds == Approx(0.51).margin(0.01));
    CHECK_THAT(sentenceOf(bench.procedure.ending(), options), Catch::Contains("No input has moved"));
}

TEST_CASE("Lost samples count in the recording only", "[audio]")
{
    Bench before(someOptions());
    before.brokenAt = listening + 900;
    before.run();
    CHECK(before.procedure.ending().kind == Ending::Kind::complete);
    CHECK(before.procedure.breaks() == 1);
    for (const auto at : {listening + rising + 500, listening + rising + pausing + 2000,
                          listening + rising + pausing + 5 * period + 2000}) {
        Bench within(someOptions());
        within.brokenAt = at;
        within.run();
        CHECK(within.procedure.ending().kind == Ending::Kind::broken);
    }
}

TEST_CASE("Where inputs give nothing, what is played fades out, as no limit can be kept", "[audio]")
{
    for (const auto at : {listening / 2, listening + rising / 2, listening + rising + pausing + 2000}) {
        Bench bench(someOptions());
        bench.nothingAt = at;
        bench.run();
        CHECK(bench.procedure.ending().kind == Ending::Kind::noInput);
        CHECK_THAT(sentenceOf(bench.procedure.ending(), bench.procedure.options()), Catch::Contains("gave nothing"));
        const auto end = at + static_cast<std::size_t>(0.03 * rate) + 600;  // with two blocks
        for (auto n = end; n < bench.played.size(); ++n)
            REQUIRE(bench.played[n] == 0.0f);
    }
}

TEST_CASE("An input that has a limit must answer what is played", "[audio]")
{
    auto options = someOptions();
    options.inputs.push_back({1, Quantity::displacement, 1e-3, 0.9e-3});
    options.recorded = 2;
    Bench bench(options);
    // a laser that looks past the cone and drifts
    bench.second = [n = 0](float) mutable { return 0.01f + 1e-6f * static_cast<float>(++n); };
    bench.run();
    const auto& ending = bench.procedure.ending();
    CHECK(ending.kind == Ending::Kind::unseen);
    CHECK(ending.watched == 1);
    CHECK(ending.stage == Stage::rising);
    CHECK_THAT(sentenceOf(ending, options), Catch::Contains("input 2 (displacement)"));
    options.inputs[1].limit.reset();  // without a limit that is for the person who looks at the remarks
    Bench free(options);
    free.second = [](float) { return 0.01f; };
    free.run();
    CHECK(free.procedure.ending().kind == Ending::Kind::complete);
}

TEST_CASE("An input that has a limit must not fall silent while the plan is played", "[audio]")
{
    auto options = someOptions();
    for (int n = 0; n < 20; ++n)  // of two levels; the quiet one drowns
        for (const float s : options.loudest)
            options.sound.push_back(n / 4 % 2 == 0 ? s : 1e-4f * s);
    options.inputs.push_back({1, Quantity::displacement, 1e-3, 0.9e-3});
    options.recorded = 2;
    options.repeats = true;
    options.latency = 0.1;
    const auto play = [&](std::size_t dies) {
        Bench bench(options);
        bench.second = [&bench, dies](float x) {
            const float noise = 1e-4f * static_cast<float>(bench.normal(bench.random));
            return noise + (bench.played.size() < dies ? 0.05f * x : 0.0f);
        };
        bench.run();
        return bench.procedure.ending();
    };
    CHECK(play(1000000).kind == Ending::Kind::complete);
    const auto at = listening + rising + pausing;
    for (const auto dies : {at + 100, at + 6 * period, at + 13 * period + 300}) {
        const auto ending = play(dies);
        CAPTURE(dies, ending.seconds);
        REQUIRE(ending.kind == Ending::Kind::unseen);
        CHECK(ending.watched == 1);
        CHECK(ending.stage == Stage::playing);
        CHECK(ending.seconds * rate < static_cast<double>(dies - at + 4 * period));
        CHECK_THAT(sentenceOf(ending, options), Catch::Contains("fell silent") && Catch::Contains("displacement"));
    }
    auto other = options;
    other.repeats = false;  // a sweep leaves the band that a sensor shows
    std::swap(options, other);
    CHECK(play(at + 100).kind == Ending::Kind::complete);
    std::swap(options, other);
    options.latency = 1.5;  // what is played may still be on its way
    CHECK(play(at + 100).kind == Ending::Kind::complete);
    options.latency = 0.1;
    options.inputs[1].limit.reset();
    CHECK(play(at + 100).kind == Ending::Kind::complete);
}

TEST_CASE("A procedure without a rise knows from the one before what must be heard", "[audio]")
{
    auto options = someOptions();
    for (int n = 0; n < 20; ++n)
        options.sound.insert(options.sound.end(), options.loudest.begin(), options.loudest.end());
    options.inputs[0].limit = 15.0;
    options.repeats = true;
    options.latency = 0.1;
    options.rise = 0.0;
    for (const bool known : {true, false}) {
        if (known)
            options.heard = {500.0};
        else
            options.heard.clear();
        Bench bench(options);
        bench.shape = [&bench](float, std::size_t) { return 1e-4f * static_cast<float>(bench.normal(bench.random)); };
        bench.run();
        CHECK(bench.procedure.ending().kind == (known ? Ending::Kind::unseen : Ending::Kind::complete));
    }
    options.heard = {500.0, 500.0};
    std::string reason;
    CHECK_FALSE(options.isValid(&reason));
    CHECK_THAT(reason, Catch::Contains("rise before"));
}

TEST_CASE("A recording that nobody takes away ends the measurement", "[audio]")
{
    auto options = someOptions();
    options.ringSeconds = 0.6;
    Bench bench(options);
    bench.run();
    CHECK(bench.procedure.ending().kind == Ending::Kind::overrun);
    CHECK(bench.recorded[0].size() == 4800);
}

TEST_CASE("A procedure without a rise begins with the pause", "[audio]")
{
    auto options = someOptions();
    options.rise = 0.0;
    Bench bench(options);
    bench.run();
    CHECK(bench.procedure.ending().kind == Ending::Kind::complete);
    CHECK(peakIn(bench.played, 0, listening + pausing) == 0.0f);
    CHECK(bench.played[listening + pausing] == options.sound[0]);
    CHECK(bench.procedure.heard().empty());
}

TEST_CASE("Options of a procedure that make no sense are refused in a sentence", "[audio]")
{
    const auto refusedAs = [](const std::string& text, const std::function<void(ProcedureOptions&)>& change) {
        auto options = someOptions();
        change(options);
        refused(Error::Kind::usage, text, [&] { Procedure procedure(options); });
    };
    refusedAs("sample rate", [](auto& o) { o.sampleRate = 0.0; });
    refusedAs("within -1 and 1", [](auto& o) { o.sound[3] = 1.1f; });
    refusedAs("within -1 and 1", [](auto& o) { o.sound.clear(); });
    refusedAs("loudest period", [](auto& o) { o.loudest.clear(); });
    refusedAs("cannot reach", [](auto& o) { o.inputs[0].limit = 16.0; });
    refusedAs("one of a quantity", [](auto& o) {
        o.inputs[0].quantity.reset();
        o.inputs[0].limit = 1.0;
    });
    refusedAs("an input and an output", [](auto& o) { o.inputs.clear(); });
    refusedAs("not recorded", [](auto& o) { o.inputs[0].input = 1; });
    refusedAs("limit", [](auto& o) { o.inputs[0].limit = -1.0; });
    refusedAs("3600 s", [](auto& o) { o.rise = std::numeric_limits<double>::quiet_NaN(); });
}
