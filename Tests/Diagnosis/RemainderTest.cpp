// SPDX-License-Identifier: GPL-3.0-or-later
#include "DuffingTake.h"
#include "SyntheticLadder.h"

#include "Engine/Diagnosis/Improve.h"
#include "Engine/Diagnosis/Remainder.h"
#include "Engine/Diagnosis/RemainderFile.h"
#include "Engine/Estimate/Wander.h"

#include <catch2/catch.hpp>

using namespace excursion;
using namespace excursion::test;

namespace {

/// A channel that leaves 20 dB over its noise from 40 to 80 Hz, on excited lines.
Comparison oneChannel()
{
    ChannelComparison channel;
    channel.quantity = Quantity::current;
    channel.unit = "A";
    channel.total = {-40.0, -60.0, 100.0};
    channel.byLevel = {{-46.0, -60.0, 25.0}, {-40.0, -60.0, 100.0}};
    ErrorKinds kinds;
    kinds.linear = -40.5;
    kinds.odd = -52.0;
    kinds.even = -58.0;
    kinds.noise = -60.0;
    channel.kindsByLevel = {kinds, kinds};
    ErrorSpectrum spectrum;
    for (double f = 10.0; f < 1000.0; f *= 1.1) {
        spectrum.frequency.push_back(f);
        spectrum.error.push_back(f > 40.0 && f < 80.0 ? 1.0 : 1e-3);
        spectrum.measured.push_back(100.0);
        spectrum.model.push_back(100.0);
        spectrum.noise.push_back(0.1);
    }
    channel.spectrumByLevel = {spectrum, spectrum};
    Comparison comparison;
    comparison.levels = {1.0, 4.0};
    comparison.noiseKnown = true;
    comparison.chiSquaredPerValue = 100.0;
    comparison.channels = {channel};
    return comparison;
}

/// A residual whose mean is given by place and whose scatter is the same everywhere.
template <class Law>
ResidualCurve curveOf(const char* residual, const char* against, double db, const Law& law, double scatter)
{
    ResidualCurve curve {residual, "N", against, "m", {}, {}, {}, db};
    for (int k = -20; k <= 20; ++k) {
        curve.argument.push_back(1e-4 * k);
        curve.mean.push_back(law(k / 20.0));
        curve.scatter.push_back(scatter);
    }
    return curve;
}

}  // namespace

TEST_CASE("What is left is told by channel, band, kind and growth", "[remainder]")
{
    const auto remainder = remainderOf(oneChannel());
    REQUIRE(remainder.channels.size() == 1);
    const auto& part = remainder.channels.front();
    CHECK(part.db == -40.0);
    CHECK(part.aboveNoiseDb.value() == Approx(20.0));
    CHECK(part.repeats.value() == Approx(0.99));  // all but the hundredth that is noise
    CHECK((part.low > 40.0 && part.low < 50.0));
    CHECK((part.high > 65.0 && part.high < 80.0));
    CHECK(part.growth.value() == Approx(6.0 / (20.0 * std::log10(4.0))));
    REQUIRE(remainder.looksLike.size() == 1);  // a narrow band of the excited lines
    CHECK_THAT(remainder.looksLike.front(), Catch::StartsWith("another resonance near"));
    CHECK_THAT(inWords(remainder),
               Catch::StartsWith("current error at -40.0 dB") && Catch::EndsWith(remainder.looksLike.front()));
    CHECK(inFewWords(remainder)
          == "current error at -40.0 dB over noise at -60.0 dB; it looks like " + remainder.looksLike.front());
    CHECK_THAT(inWords(remainder), Catch::Contains("current error at -40.0 dB over noise at -60.0 dB"));
}

TEST_CASE("What stands out at one level alone is told of that level", "[remainder]")
{
    auto comparison = oneChannel();
    auto& channel = comparison.channels.front();
    channel.total = {-68.6, -63.7, 1.0};  // noise, as the loudest level drifts
    channel.byLevel = {{-67.9, -71.4, 30.0}, {-66.5, -62.8, 0.9}};
    channel.kindsByLevel[0].linear = -68.0;
    const auto remainder = remainderOf(comparison);
    const auto& part = remainder.channels.front();
    CHECK(part.level == "the lowest level");
    CHECK(part.db == -67.9);
    CHECK(part.noiseFloorDb.value() == -71.4);
    CHECK(part.aboveNoiseDb.value() == Approx(10.0 * std::log10(30.0)));
    CHECK(part.kinds.linear.value() == -68.0);
    CHECK_THAT(unexplained(remainder),
               Catch::Contains("current error at -67.9 dB over noise at -71.4 dB at the lowest level"));
    const nlohmann::json document = toJson(remainder);
    const auto back = remainderFromJson(JsonField(document, "", "test"));
    CHECK(back.channels.front().level == part.level);

    channel.byLevel = {{-75.0, -71.4, 0.5}, {-59.0, -62.8, 4.0}};
    CHECK(remainderOf(comparison).channels.front().level == "the highest level");
    channel.byLevel = {{-71.0, -71.4, 1.0}, {-62.8, -62.8, 1.0}};
    CHECK(remainderOf(comparison).channels.front().level.empty());
    CHECK(remainderOf(comparison).channels.front().db == -68.6);
}

TEST_CASE("The shape of the missing force says what it looks like", "[remainder]")
{
    auto comparison = oneChannel();
    comparison.channels[0].kindsByLevel.back().linear = -50.0;
    const auto likeness = [&](std::vector<ResidualCurve> curves) {
        comparison.residuals = std::move(curves);
        return remainderOf(comparison).looksLike;
    };
    const auto touches = [](double x) { return x > 0.7 ? -(x - 0.7) : 0.0; };
    auto words = likeness(
        {curveOf("force", "x", -20.0, touches, 0.02), curveOf(
                                                          "force", "v", -20.0, [](double) { return 0.0; }, 0.1)});
    REQUIRE(words.size() == 1);
    CHECK_THAT(words.front(), Catch::Contains("contact on one side") && Catch::Contains("+2 mm"));

    words = likeness({curveOf(
        "force", "v", -20.0, [](double v) { return v * std::abs(v); }, 0.05)});
    REQUIRE(words.size() == 1);
    CHECK_THAT(words.front(), Catch::Contains("a force that depends on v"));

    words = likeness({curveOf(
        "force", "x", -20.0, [](double) { return 0.01; }, 0.5)});
    REQUIRE(words.size() == 1);
    CHECK_THAT(words.front(), Catch::Contains("a force with a memory"));

    // A clear curve of a voltage that is far smaller is a symptom.
    words = likeness({curveOf(
                          "force", "x", -20.0, [](double) { return 0.01; }, 0.5),
                      curveOf(
                          "voltage", "i", -50.0, [](double i) { return i; }, 0.0)});
    REQUIRE(words.size() == 1);
    CHECK_THAT(words.front(), Catch::Contains("a force with a memory"));
}

TEST_CASE("Noise looks like nothing", "[remainder]")
{
    auto comparison = oneChannel();
    comparison.residuals = {curveOf(
        "force", "x", -20.0, [](double) { return 0.01; }, 0.5)};
    auto& channel = comparison.channels.front();
    channel.total = {-60.0, -60.0, 1.0};
    channel.byLevel = {{-60.0, -60.0, 1.0}, {-60.0, -60.0, 1.0}};
    CHECK(remainderOf(comparison).looksLike.empty());
    channel.total = {-40.0, -60.0, 100.0};
    CHECK_FALSE(remainderOf(comparison).looksLike.empty());
}

TEST_CASE("What is left survives its document, and older files have none", "[remainder]")
{
    auto comparison = oneChannel();
    comparison.residuals = {curveOf(
        "force", "x", -20.0, [](double x) { return x * x * x; }, 0.05)};
    comparison.channels.front().wanderDb = -55.0;
    const auto document = toJson(remainderOf(comparison));
    const nlohmann::json parsed = nlohmann::json::parse(document.dump());
    CHECK(toJson(remainderFromJson(JsonField(parsed, "", "test"))) == document);
    CHECK(toJson(Remainder {}).is_null());
    auto wrong = parsed;
    wrong["channels"][0]["band"] = {1.0};
    CHECK_THROWS_WITH(remainderFromJson(JsonField(wrong, "", "test")), Catch::Contains("two frequencies"));
}

TEST_CASE("A stiffness that wanders is never called complete, and noise never wanders", "[remainder]")
{
    for (const double noiseDb : {-50.0, -70.0}) {
        CAPTURE(noiseDb);
        const auto still = duffingTake(0.0, noiseDb, 5);
        CHECK_FALSE(wanderDb(AveragedPeriods(still), *still.find(Quantity::displacement)));
        const auto ladder = improve(still);
        CHECK(name(ladder.verdict) == "complete");
        CHECK(ladder.rungs.size() == 1);
    }
    const auto wandering = duffingTake(0.0, -70.0, 5, 0.02);
    const auto amount = wanderDb(AveragedPeriods(wandering), *wandering.find(Quantity::displacement));
    REQUIRE(amount);
    CHECK((*amount > -45.0 && *amount < -25.0));
    const auto ladder = improve(wandering);
    CHECK(name(ladder.verdict) == "unknown-effect");
    REQUIRE_FALSE(ladder.rungs.empty());
    const auto& words = ladder.rungs.back().diagnosis.remainder.looksLike;
    REQUIRE(words.size() == 1);
    CHECK_THAT(words.front(), Catch::Contains("a parameter that wanders"));
    CHECK_THAT(ladder.sentence, Catch::Contains("a parameter that wanders"));
}

TEST_CASE("Noise that is as large as each level is no wandering", "[remainder]")
{
    auto take = duffingTake(0.0, -140.0, 6);
    std::mt19937_64 random(6);
    const auto& e = *take.excitation;
    const auto perLevel = static_cast<std::size_t>(e.totalSamples()) / e.levels.size();
    for (auto& channel : take.channels)
        for (std::size_t n = 0; n < channel.samples.size(); ++n) {
            const double level = e.levels[std::min(n / perLevel, e.levels.size() - 1)];
            channel.samples[n] += level
                                  * std::normal_distribution<double>(
                                      0.0, channel.quantity == Quantity::force ? 1e-4 : 1e-3)(random);
        }
    CHECK_FALSE(wanderDb(AveragedPeriods(take), *take.find(Quantity::displacement)));
}

TEST_CASE("A ladder says what is known and how surely", "[remainder]")
{
    const auto file = syntheticLadder();
    const auto known = knownEffects(file.ladder);
    CHECK(known.size() + 1 == file.ladder.rungs.size());
    const auto words = foundInWords(file.ladder);
    CHECK_THAT(words, Catch::StartsWith("Found: "));
    for (const auto& one : known) {
        CHECK(one.confidence);
        CHECK_THAT(words, Catch::Contains(effectNamed(one.effect).title()));
    }
}
