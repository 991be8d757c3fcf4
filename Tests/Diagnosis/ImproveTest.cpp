// SPDX-License-Identifier: GPL-3.0-or-later
// The whole way from a take to a verdict, on takes of a simulator that shares no code with the model.
#include "Engine/Diagnosis/Improve.h"
#include "Engine/Error.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/Laws.h"
#include "SeedDriver.h"
#include "SmallSetup.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <stop_token>

using namespace excursion;

namespace {

std::vector<std::string> added(const Ladder& ladder)
{
    std::vector<std::string> result;
    for (const auto& rung : ladder.rungs)
        if (!rung.added.empty())
            result.push_back(rung.added);
    return result;
}

/// The weighted error of every channel within 3 dB of the noise, on the realization that was held out.
void requireAtTheNoise(const Comparison& comparison)
{
    REQUIRE(comparison.validated);
    for (const auto& channel : comparison.channels) {
        INFO(name(channel.quantity));
        REQUIRE(channel.total.noiseFloorDb);
        CHECK(channel.total.chiSquaredPerValue < 2.0);
    }
}

}  // namespace

TEST_CASE("Nothing is added to a driver without effects, and its parameters are found", "[improve]")
{
    const auto ladder = improve(seedTake({}));
    CHECK(ladder.verdict == Verdict::complete);
    REQUIRE(ladder.rungs.size() == 1);
    requireAtTheNoise(ladder.rungs.front().comparison);
    const auto& model = ladder.model();
    for (const auto& [parameter, value] : std::map<std::string, double> {
             {"Re", 3.3}, {"Le", 266e-6}, {"Bl", 4.95}, {"m", 14.35e-3}, {"Rms", 0.786}, {"K", 1852.0}}) {
        const auto& p = model.baseParameter(parameter);
        INFO(parameter << " = " << p.value << " +- " << p.standardError);
        CHECK(p.standardError < 1e-3 * value);
        CHECK(std::abs(p.value - value) < 5.0 * p.standardError);
    }
}

TEST_CASE("A ladder grows by hand, is cut back, and is as it was when work is cancelled", "[improve][slow]")
{
    Improvement work(seedTake({{"stiffness", 0.3}}));
    REQUIRE(work.take().report().fitForUse());
    CHECK(work.ladder().rungs.empty());
    work.begin();
    REQUIRE(work.ladder().rungs.size() == 1);
    const double before = work.ladder().rungs[0].comparison.chiSquaredPerValue;
    std::stop_source stop;
    Progress progress;
    progress.stop = stop.get_token();
    progress.report = [&](double fraction, std::string_view) {
        if (fraction > 0.3)
            stop.request_stop();
    };
    CHECK_THROWS_AS(work.add("stiffness", progress), Error);
    CHECK(work.ladder().rungs.size() == 1);
    CHECK_THROWS_WITH(work.add("no such thing"), Catch::Contains("no such thing"));
    work.add("stiffness");
    REQUIRE(work.ladder().rungs.size() == 2);
    CHECK(work.ladder().verdict == Verdict::complete);
    CHECK_THROWS_WITH(work.add("stiffness"), Catch::Contains("already"));
    const auto waves = work.waveforms(2);
    REQUIRE(waves.size() == 2);
    double error = 0.0, power = 0.0;
    for (std::size_t n = 0; n < waves[1].measured.size(); ++n) {
        error += std::pow(waves[1].measured[n] - waves[1].model[n], 2);
        power += std::pow(waves[1].measured[n], 2);
    }
    CHECK(10.0 * std::log10(error / power)
          == Approx(work.ladder().rungs[1].comparison.channels[1].byLevel[2].db).margin(0.5));
    work.undo();
    work.undo();
    REQUIRE(work.ladder().rungs.size() == 1);
    CHECK(work.ladder().verdict == Verdict::missingEffect);
    CHECK(work.ladder().rungs[0].comparison.chiSquaredPerValue == before);
}

TEST_CASE("Effects that are added in another order end in models that agree within their errors", "[improve][slow]")
{
    const PreparedTake take(seedTake({{"stiffness", 0.3}, {"force-factor", 0.3}}));
    const auto climbed = [&take](const std::vector<std::string>& order) {
        Improvement work(take);
        work.begin();
        for (const auto& effect : order)
            work.add(effect);
        return work.ladder();
    };
    const auto one = climbed({"stiffness", "force-factor"}), other = climbed({"force-factor", "stiffness"});
    CHECK(one.verdict == other.verdict);
    CHECK(one.rungs.back().comparison.chiSquaredPerValue
          == Approx(other.rungs.back().comparison.chiSquaredPerValue).margin(0.06));
    for (const auto& p : one.model().base().parameters) {
        const double q = other.model().baseParameter(p.name).value;
        INFO(p.name << ": " << p.value << " and " << q << " +- " << p.standardError);
        CHECK(std::abs(p.value - q) <= p.standardError);
    }
    // The degrees of the laws may differ; their curves do not.
    const auto laws1 = laws(one.model()), laws2 = laws(other.model());
    REQUIRE(laws1.size() == 2);
    for (const auto& law : laws1) {
        const auto same = std::find_if(laws2.begin(), laws2.end(),
                                       [&](const LawCurve& l) { return l.effectId == law.effectId; });
        REQUIRE(same != laws2.end());
        for (std::size_t n = 0; n < law.argument.size(); ++n) {
            INFO(law.info.name << " at " << law.argument[n]);
            CHECK(law.argument[n] == Approx(same->argument[n]).epsilon(1e-3).margin(1e-9));
            CHECK(std::abs(law.value[n] - same->value[n]) <= law.halfWidth[n] + same->halfWidth[n]);
        }
    }
}

TEST_CASE("One hidden effect is named, added, and the error falls to the noise", "[improve][slow]")
{
    const auto id = GENERATE(as<std::string> {}, "force-factor", "stiffness", "inductance-position",
                             "inductance-current", "eddy-currents", "creep", "damping-velocity", "friction",
                             "coil-heating", "vented-box");
    INFO(id);
    const auto ladder = improve(seedTake({{id, 0.25, false}}));
    CHECK(added(ladder) == std::vector {id});
    CHECK(ladder.verdict == Verdict::complete);
    CHECK(ladder.withdrawn.empty());
    const auto& first = ladder.rungs.front().diagnosis;
    CHECK(first.verdict == Verdict::missingEffect);
    CHECK(first.ranking.front().effect == id);
    CHECK(first.ranking.front().confidence > 0.5);
    CHECK_FALSE(first.ranking.front().reason.empty());
    CHECK(ladder.rungs.front().comparison.chiSquaredPerValue
          > 10.0 * ladder.rungs.back().comparison.chiSquaredPerValue);
    requireAtTheNoise(ladder.rungs.back().comparison);
}

TEST_CASE("Eddy currents and creep that follow no law are found, and nothing beside them", "[improve][slow]")
{
    const auto id = GENERATE(as<std::string> {}, "eddy-currents", "creep");
    INFO(id);
    const auto ladder = improve(seedTake({{id, 0.25, true}}));
    CHECK(added(ladder) == std::vector {id});
    CHECK(ladder.verdict == Verdict::complete);
    requireAtTheNoise(ladder.rungs.back().comparison);
}

TEST_CASE("Random chains of cells are explained at the noise in nineteen of twenty takes", "[.study]")
{
    const auto id = GENERATE(as<std::string> {}, "eddy-currents", "creep");
    int alone = 0, atNoise = 0;
    constexpr int takes = 20;
    for (int seed = 1000; seed < 1000 + takes; ++seed) {
        bench::DrawOptions options;
        options.seconds = 3.0;
        options.hidden = {{id, 0.0, true}};
        const auto drawn = bench::draw(static_cast<std::uint64_t>(seed), options);
        const auto ladder = improve(bench::measure(drawn.speaker, drawn.setup));
        alone += added(ladder) == std::vector {id};
        const auto& channels = ladder.rungs.back().comparison.channels;
        atNoise += std::all_of(channels.begin(), channels.end(),
                               [](const auto& c) { return c.total.chiSquaredPerValue < 2.0; });
    }
    WARN(id << ": alone " << alone << ", within 3 dB of the noise " << atNoise << " of " << takes);
    CHECK(alone >= 19);
    CHECK(atNoise >= 19);
}

TEST_CASE("At the noise no effect is missing that explains a little of it", "[improve][bench]")
{
    bench::DrawOptions options;  // a coil that warms a micro speaker by a half
    options.seconds = 5.0;
    options.channels = {Quantity::voltage, Quantity::current, Quantity::displacement, Quantity::pressure};
    options.hidden = {{"coil-heating", 0.0}};
    const auto drawn = bench::draw(99003, options);
    const auto ladder = improve(bench::measure(drawn.speaker, drawn.setup));
    CHECK(ladder.verdict == Verdict::complete);
    CHECK(added(ladder) == std::vector<std::string> {"coil-heating"});
}

TEST_CASE("Two hidden effects are added one after the other", "[improve][slow]")
{
    const auto ladder = improve(seedTake({{"stiffness", 0.3}, {"force-factor", 0.3}}));
    auto found = added(ladder);
    std::sort(found.begin(), found.end());
    CHECK(found == std::vector<std::string> {"force-factor", "stiffness"});
    CHECK(ladder.verdict == Verdict::complete);
    requireAtTheNoise(ladder.rungs.back().comparison);
}

TEST_CASE("Friction that slips at once is found, and no damping stands for it", "[improve][slow]")
{
    bench::Loudspeaker truth;
    constexpr double limit = 0.3, reach = 1e-5;  // N; m, less than a hundredth of the way
    truth.friction = bench::Friction {{{limit / reach, limit}}};
    auto setup = smallSetup();
    setup.excitation.levels = {0.5, 2.0};
    setup.noiseDb = -55.0;
    const auto ladder = improve(PreparedTake(bench::measure(truth, setup)));
    CHECK(added(ladder) == std::vector<std::string> {"friction"});
    CHECK(ladder.verdict == Verdict::complete);
    requireAtTheNoise(ladder.rungs.back().comparison);
}

TEST_CASE("The motion alone tells a force factor from a suspension", "[improve][slow]")
{
    const auto id = GENERATE(as<std::string> {}, "force-factor", "stiffness");
    INFO(id);
    const auto ladder = improve(seedTake({{id, 0.25}}, {Quantity::displacement}));
    const auto& base = ladder.rungs.front().model;
    CHECK_FALSE(base.baseParameter("Re").free);
    CHECK_FALSE(base.baseParameter("Rms").free);  // a linear motion does not tell it from the coil's damping
    const double Bl = base.baseParameter("Bl").value, coil = Bl * Bl / base.baseParameter("Re").value;
    CHECK(coil / (coil + base.baseParameter("Rms").value) == Approx(0.8).margin(0.1));
    CHECK_THAT(ladder.sentence, Catch::Contains("Re is held at"));
    CHECK(ladder.rungs.front().diagnosis.ranking.front().effect == id);
    CHECK(ladder.model().baseParameter("Rms").free);
    CHECK(added(ladder) == std::vector {id});
    CHECK(ladder.verdict == Verdict::complete);
    requireAtTheNoise(ladder.rungs.back().comparison);
}

TEST_CASE("The current alone tells a stiffening suspension", "[improve][slow]")
{
    const auto ladder = improve(seedTake({{"stiffness", 0.3}}, {Quantity::current}));
    CHECK(added(ladder) == std::vector<std::string> {"stiffness"});
    CHECK(ladder.verdict == Verdict::complete);
}

/// A laser that is bent, which no loudspeaker is: by a power of the displacement.
Measurement withBentLaser(Measurement take, int power)
{
    for (auto& channel : take.channels)
        if (channel.quantity == Quantity::displacement) {
            double peak = 0.0;
            for (const double x : channel.samples)
                peak = std::max(peak, std::abs(x));
            for (auto& x : channel.samples)
                x += 0.05 * peak * std::pow(x / peak, power);
        }
    return take;
}

TEST_CASE("What the catalogue does not hold is not given another name", "[.thorough][improve][slow]")
{
    const int power = GENERATE(2, 3);
    INFO(power);
    const auto ladder = improve(withBentLaser(seedTake({}, {Quantity::current, Quantity::displacement}), power));
    CHECK(ladder.verdict == Verdict::unknownEffect);
    CHECK(added(ladder).empty());
    CHECK_THAT(ladder.sentence, Catch::Contains("no effect of the catalogue explains"));
}

TEST_CASE("A suspension that is bent and creeps is both, in series", "[.thorough][improve][slow]")
{
    // Laws that only add up leave 15 dB more of it.
    const auto ladder = improve(seedTake({{"stiffness", 0.3}, {"creep", 0.2}}));
    CHECK(added(ladder) == std::vector<std::string> {"stiffness", "creep"});
    CHECK(ladder.rungs.back().comparison.chiSquaredPerValue < 6.0);
}

TEST_CASE("What is known is named beside what is not", "[.thorough][improve][slow]")
{
    const auto ladder = improve(
        withBentLaser(seedTake({{"force-factor", 0.4}}, {Quantity::current, Quantity::displacement}), 2));
    CHECK(ladder.verdict == Verdict::unknownEffect);
    CHECK(added(ladder) == std::vector<std::string> {"force-factor"});
}

TEST_CASE("Four effects at once are all named", "[improve][slow]")
{
    const auto ladder = improve(
        seedTake({{"force-factor", 0.3}, {"stiffness", 0.3}, {"inductance-position", 0.25}, {"friction", 0.2}}));
    CHECK_THAT(added(ladder), Catch::UnorderedEquals(std::vector<std::string> {"force-factor", "stiffness",
                                                                               "inductance-position", "friction"}));
    for (const auto& rung : ladder.rungs)
        for (const auto& channel : rung.comparison.channels)
            UNSCOPED_INFO(rung.added << " " << name(channel.quantity) << " " << channel.total.db << " dB");
    for (const auto& channel : ladder.rungs.back().comparison.channels)
        CHECK(channel.total.db < -55.0);
    // Laws are held while the lower rungs are made, but not known better there.
    const auto known = laws(ladder.model());
    for (const auto& rung : ladder.rungs)
        for (const auto& law : laws(rung.model)) {
            const auto same = std::find_if(known.begin(), known.end(),
                                           [&](const LawCurve& l) { return l.effectId == law.effectId; });
            REQUIRE(same != known.end());
            INFO(law.effectId << " beside " << rung.model.effectIds().size() - 1);
            const auto n = law.argument.size() / 4;
            CHECK(law.halfWidth[n] > 0.5 * same->halfWidth[n]);
        }
}

TEST_CASE("A faulty take is not improved", "[improve]")
{
    auto drawn = drawSeedDriver({{"stiffness", 0.3}}, {Quantity::current, Quantity::displacement});
    const auto fault = GENERATE(bench::Fault {bench::Fault::Kind::polarity, Quantity::current, 0.0},
                                bench::Fault {bench::Fault::Kind::clipping, Quantity::current, 0.6},
                                bench::Fault {bench::Fault::Kind::dead, Quantity::displacement, 0.0});
    drawn.setup.faults = {fault};
    const auto ladder = improve(bench::measure(drawn.speaker, drawn.setup));
    CHECK(ladder.verdict == Verdict::badMeasurement);
    CHECK(ladder.rungs.empty());
    REQUIRE_FALSE(ladder.problems.empty());
    CHECK(ladder.problems.front().channel == fault.channel);
}

TEST_CASE("Effects that are given are in the first model and are not added again", "[improve][slow]")
{
    ImproveOptions options;
    options.with = {"stiffness"};
    const auto ladder = improve(seedTake({{"stiffness", 0.3}}), options);
    CHECK(ladder.rungs.front().model.has("stiffness"));
    CHECK(added(ladder).empty());
    CHECK(ladder.verdict == Verdict::complete);
}

TEST_CASE("What cannot be asked for is refused before any work, and work stops when it is told to", "[improve]")
{
    const auto record = seedTake({});
    const auto kindOf = [&](const ImproveOptions& options, const Progress& progress = {}) {
        try {
            improve(record, options, progress);
        } catch (const Error& e) {
            return e.kind();
        }
        return Error::Kind::input;
    };
    ImproveOptions unknown;
    unknown.with = {"ghosts"};
    CHECK(kindOf(unknown) == Error::Kind::usage);
    ImproveOptions none;
    none.diagnose.trials = 0;
    CHECK(kindOf(none) == Error::Kind::usage);

    std::stop_source stop;
    Progress progress;
    progress.stop = stop.get_token();
    progress.report = [&stop](double, std::string_view) { stop.request_stop(); };
    CHECK(kindOf({}, progress) == Error::Kind::cancelled);
}
