// SPDX-License-Identifier: GPL-3.0-or-later
// A suspension that has been worked is softer, and a coil that has been played is warmer: a little of both between the
// levels of a take is no effect that a model lacks.
#include "Bench/Bench.h"
#include "Engine/Diagnosis/Compare.h"
#include "Engine/Diagnosis/FollowSections.h"
#include "Engine/Estimate/MakeRecord.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/FeedbackError.h"
#include "Engine/Loudspeaker/Fit.h"
#include "SmallSetup.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

using namespace excursion;

namespace {

/// By level, shares of K and Re.
using Moves = std::array<SectionDrift::Amount, 3>;

struct Drifted {
    Model truth;
    Record record;
};

/// A record of a linear driver whose stiffness and resistance are others at each level, simulated as such, and noise.
Drifted drifted(const Moves& moves)
{
    auto setup = smallSetup();
    setup.excitation.levels = {0.5, 1.5, 4.0};
    setup.excitation.realizations = 3;
    setup.noiseDb = -75.0;
    Drifted result {{}, makeRecord(bench::measure(bench::Loudspeaker {}, setup))};
    auto& record = result.record;
    result.truth = startModel(record);
    adapt(record, result.truth);
    fit(result.truth, record, estimationSections(record));
    OutputErrorOptions run;
    run.gradient = false;
    run.spectra = true;
    run.substeps = substepsFor(result.truth, record);
    std::mt19937_64 random(5);
    std::normal_distribution<double> normal(0.0, std::sqrt(0.5));
    for (std::size_t s = 0; s < record.sections.size(); ++s) {
        auto& section = record.sections[s];
        auto there = result.truth;
        const auto& by = moves[static_cast<std::size_t>(section.level)];
        there.baseParameter("K").value *= 1.0 + by.stiffness;
        there.baseParameter("Re").value *= 1.0 + by.resistance;
        section.measured = outputError(there, record, {s}, {}, run).front().predicted;
        for (std::size_t c = 0; c < section.measured.size(); ++c)
            for (std::size_t k = 0; k < section.measured[c].size(); ++k)
                section.measured[c][k] += section.deviation[c][k]
                                          * std::complex<double>(normal(random), normal(random));
    }
    return result;
}

constexpr Moves little {{{0.0, 0.0}, {-0.004, 0.0008}, {-0.009, 0.002}}};

}  // namespace

TEST_CASE("Small moves between the levels of a take are told section by section", "[sections]")
{
    auto [model, record] = drifted(little);
    std::vector<std::size_t> sections(record.sections.size());
    for (std::size_t s = 0; s < sections.size(); ++s)
        sections[s] = s;
    OutputErrorOptions run;
    run.gradient = false;
    run.substeps = substepsFor(model, record);
    const auto chiOf = [](const std::vector<SectionFit>& fits) {
        const auto sum = sumOf(fits);
        return sum->cost / sum->rows;
    };
    CHECK(chiOf(outputError(model, record, sections, {}, run)) > 5.0);
    record.sectionsDrift = true;
    const auto fits = outputError(model, record, sections, {}, run);
    CHECK(chiOf(fits) < 1.1);
    for (std::size_t s = 0; s < sections.size(); ++s) {
        INFO("section " << s);
        const auto& truth = little[static_cast<std::size_t>(record.sections[s].level)];
        CHECK(std::abs(fits[s].drift.stiffness - truth.stiffness) < 0.001);
        CHECK(std::abs(fits[s].drift.resistance - truth.resistance) < 0.0003);
    }
    const auto moves = movesOf(fits);
    CHECK(moves.stiffness == Approx(0.009).margin(0.001));
    CHECK(moves.resistance == Approx(0.002).margin(0.0003));
}

TEST_CASE("A fit that follows the sections finds the driver as it is at the quietest level", "[sections]")
{
    auto [truth, record] = drifted(little);
    record.sectionsDrift = true;
    auto model = truth;
    model.baseParameter("K").value *= 1.01;
    model.baseParameter("Re").value *= 0.995;
    const auto summary = fit(model, record, estimationSections(record));
    REQUIRE(summary.usable());
    CHECK(summary.chiSquaredPerValue < 1.1);
    for (const char* name : {"Re", "Bl", "m", "Rms", "K"}) {
        INFO(name);
        const auto& p = model.baseParameter(name);
        // Moves of a per cent are followed to first order.
        CHECK(std::abs(p.value - truth.baseParameter(name).value) < std::max(4.0 * p.standardError, 5e-4 * p.value));
        CHECK(p.standardError < 0.002 * p.value);
    }
}

TEST_CASE("Sections explain what small moves leave, and neither large ones nor another driver", "[sections]")
{
    {
        const auto [model, record] = drifted(little);
        CHECK(followingSections(model, record).has_value());
        CHECK(movesExplain(model, record));
        auto followed = record;
        followed.sectionsDrift = true;
        CHECK(!followingSections(model, followed));  // they are followed already
        const auto comparison = compare(model, followed);
        REQUIRE(comparison.sectionMoves);
        CHECK(told(*comparison.sectionMoves).find("stiffness moves by 0.9") != std::string::npos);
    }
    {
        const auto [model, record] = drifted({});
        CHECK(!followingSections(model, record));  // only noise is left
        CHECK(!movesExplain(model, record));
        CHECK(!compare(model, record).sectionMoves);
    }
    {
        const auto [model, record] = drifted({{{0.0, 0.0}, {-0.03, 0.0}, {-0.06, 0.0}}});
        CHECK(!followingSections(model, record));
    }
    {
        const auto [model, record] = drifted({{{0.0, 0.0}, {0.0, 0.01}, {0.0, 0.02}}});  // a coil that warms
        CHECK(!followingSections(model, record));
    }
}

TEST_CASE("What laws contribute to a record is the same where sections are followed", "[sections]")
{
    auto [model, record] = drifted(little);
    model = withEffect(std::move(model), effectNamed("stiffness"), visitedRange(model, record));
    model.components.back().parameters[1].value = 0.2 * model.baseParameter("K").value;
    const auto plain = withoutLaws(model, record);
    record.sectionsDrift = true;
    const auto followed = withoutLaws(model, record);
    CHECK(followed.sectionsDrift);
    double apart = 0.0, moved = 0.0;
    for (std::size_t s = 0; s < record.sections.size(); ++s)
        for (std::size_t c = 0; c < record.channels.size(); ++c)
            for (std::size_t k = 0; k < plain.sections[s].measured[c].size(); ++k) {
                apart += std::norm(plain.sections[s].measured[c][k] - followed.sections[s].measured[c][k]);
                moved += std::norm(plain.sections[s].measured[c][k] - record.sections[s].measured[c][k]);
            }
    CHECK(moved > 0.0);
    CHECK(apart <= 1e-20 * moved);
}

TEST_CASE("What moves within a section is followed on the lines that were not played, too", "[sections]")
{
    auto setup = smallSetup();
    setup.excitation.levels = {0.5, 1.5, 4.0};
    setup.excitation.realizations = 3;
    setup.noiseDb = -80.0;
    bench::Loudspeaker driver;
    bench::Oddity worked;
    worked.kind = bench::Oddity::Kind::wander;
    worked.stiffness = driver.K;
    worked.depth = 0.003;
    driver.oddity = worked;
    auto record = makeRecord(bench::measure(driver, setup));
    auto model = startModel(record);
    adapt(record, model);
    for (int stage = 0; stage < 3; ++stage)
        fit(model, record, estimationSections(record));
    CHECK(compare(model, record).chiSquaredPerValue > 2.0);
    auto following = followingSections(model, record);
    REQUIRE(following.has_value());
    model = std::move(following->model);
    record.sectionsDrift = true;
    for (int stage = 0; stage < 2; ++stage)
        fit(model, record, estimationSections(record));
    OutputErrorOptions run;
    run.gradient = false;
    run.spectra = true;
    run.substeps = substepsFor(model, record);
    const auto sections = estimationSections(record);
    const auto fits = outputError(model, record, sections, {}, run);
    const auto displacement = *record.channelIndex(Quantity::displacement);
    double excess = 0.0, count = 0.0;  // of lines that were not played, below a few resonances
    for (std::size_t n = 0; n < sections.size(); ++n) {
        const auto& section = record.sections[sections[n]];
        const auto& played = section.excited;
        for (std::size_t k = 1; record.frequency(section, k) < 400.0; ++k)
            if (std::find(played.begin(), played.end(), static_cast<int>(k)) == played.end()) {
                excess += std::norm(fits[n].predicted[displacement][k] - section.measured[displacement][k])
                          / std::pow(section.deviation[displacement][k], 2);
                ++count;
            }
    }
    CHECK(excess / count < 1.3);
}
