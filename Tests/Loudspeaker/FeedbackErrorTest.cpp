// SPDX-License-Identifier: GPL-3.0-or-later
// Laws that are fed the motion that a take shows: against simulations, against differences, and on takes of the virtual
// bench.
#include "Engine/Estimate/MakeRecord.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/FeedbackError.h"
#include "Engine/Loudspeaker/Fit.h"
#include "Engine/Loudspeaker/FitResponse.h"
#include "SeedDriver.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace excursion;

namespace {

struct Ready {
    Record record;
    Model model;  ///< linear, fitted
    std::vector<std::size_t> sections;
};

Ready ready(std::vector<bench::HiddenEffect> hidden)
{
    Ready result {
        makeRecord(seedTake(std::move(hidden), {Quantity::current, Quantity::displacement, Quantity::pressure})),
        {},
        {}};
    result.model = startModel(result.record);
    adapt(result.record, result.model);
    result.sections = estimationSections(result.record);
    FitOptions options;
    options.fed = true;
    fit(result.model, result.record, result.sections, options);
    return result;
}

NormalEquations sumOfFinite(const std::vector<SectionFit>& fits)
{
    const auto sum = sumOf(fits);
    REQUIRE(sum);
    return *sum;
}

/// All laws of the catalogue that a small cone has, and Doppler, at some strength, with the box that one acts within.
/// Slow ones and friction have their memories from before.
Model bent(Model model, const Record& record, const std::string& only = "")
{
    const auto operatingRange = visitedRange(model, record, 3);
    for (const auto* effect : catalogue()) {
        if (effect->linear() || (!only.empty() && effect->id() != only))
            continue;
        if (const auto* host = effect->host()) {
            model = withEffect(model, *host, operatingRange);
            for (auto& p : model.components.back().parameters)
                if (p.strength)
                    p.value = p.heard ? 0.5 : 0.5 * model.baseParameter("K").value;
        }
        model = withEffect(model, *effect, operatingRange);
        double sign = 1.0;
        auto& component = model.components.back();
        for (auto& p : component.parameters)
            if (p.strength)
                p.value = std::isfinite(p.prior) ? 0.05 * p.prior * (p.lower < 0.0 ? (sign *= -1.0) : 1.0)
                                                 : 1.0 / 343.0;
            else if (std::isfinite(p.prior) && (p.lower == 0.0 || p.name == "bend" || p.name == "stick"))
                p.value = 0.3;
    }
    return model;
}

}  // namespace

TEST_CASE("Without laws to feed the error is that of the simulation", "[fed]")
{
    const auto [record, model, sections] = ready({{"stiffness", 0.3}});
    const auto active = freeParameters(model);
    const auto simulated = sumOfFinite(outputError(model, record, sections, active, {}));
    const auto fed = sumOfFinite(
        feedbackError(model, record, sections, settledMotions(model, record, sections), active, {}));
    CHECK(fed.rows == simulated.rows);
    CHECK(fed.cost == Approx(simulated.cost).epsilon(1e-4));
    // Of the columns the simulation tells less than of the error, as its derivatives may be coarse.
    CHECK((fed.N - simulated.N).norm() < 1e-3 * simulated.N.norm());
}

TEST_CASE("A model is true to the motion that it makes itself", "[fed]")
{
    auto [record, linear, sections] = ready({{"stiffness", 0.3}});
    record.leadIn = record.sections.front().window;
    OutputErrorOptions run;
    run.gradient = false;
    run.spectra = true;
    run.substeps = 4;
    for (const auto* law : catalogue()) {
        if (law->linear())
            continue;
        const auto model = bent(linear, record, law->id());
        std::vector<std::size_t> every;
        for (std::size_t s = 0; s < record.sections.size(); ++s)
            every.push_back(s);
        // the history of a slow memory is that of the current that was measured
        for (int pass = 0; pass < 2; ++pass) {
            const auto made = outputError(model, record, every, {}, run);
            for (const auto s : every)
                record.sections[s].measured = made[s].predicted;
        }
        const auto motions = shownMotions(model, record, every, settledMotions(model, record, every));
        const auto own = sumOfFinite(feedbackError(model, record, every, motions, {}, run));
        const auto without = withoutEffect(model, law->id());
        const auto others =
            sumOfFinite(feedbackError(without, record, every, settledMotions(without, record, every), {}, run)).cost;
        INFO(law->id() << " leaves " << own.cost / own.rows << " of the noise, without it " << others / own.rows);
        CHECK(others > (law->slow() ? 5e3 : 1e5) * own.cost);  // the history of a slow one is a mean
    }
}

TEST_CASE("The columns of fed laws are the derivatives of what they leave", "[fed]")
{
    const auto [record, linear, sections] = ready({{"stiffness", 0.3}});
    auto model = bent(linear, record);
    const auto active = freeParameters(model);
    const std::vector<std::size_t> one {sections.back()};
    const auto motions = settledMotions(model, record, one);
    const auto whole = sumOfFinite(feedbackError(model, record, one, motions, active, {}));
    const auto all = parametersOf(model);
    for (std::size_t k = 0; k < active.size(); ++k) {
        auto& p = *all[static_cast<std::size_t>(active[k])];
        CAPTURE(p.name, p.value);
        const auto j = static_cast<Eigen::Index>(k);
        const double value = p.value, step = 1e-4 * (value != 0.0 ? std::abs(value) : 1.0);
        OutputErrorOptions plain;
        plain.gradient = false;
        p.value = value + step;
        tellHosts(model);
        const double above = sumOfFinite(feedbackError(model, record, one, motions, {}, plain)).cost;
        p.value = value - step;
        tellHosts(model);
        const double below = sumOfFinite(feedbackError(model, record, one, motions, {}, plain)).cost;
        p.value = value;
        tellHosts(model);
        // As much of the gradient as could be explained by the column at all.
        const double most = std::sqrt(whole.N(j, j) * whole.cost);
        CHECK(std::abs((above - below) / (4.0 * step) - whole.g[j]) < 1e-3 * most);
    }
}

TEST_CASE("Several laws are found at once from nothing", "[fed][slow]")
{
    const std::vector<std::string> hidden {"force-factor", "stiffness", "damping-velocity", "inductance-position"};
    auto [record, model, sections] = ready({{hidden[0], 0.3}, {hidden[1], 0.3}, {hidden[2], 0.2}, {hidden[3], 0.2}});
    const auto operatingRange = visitedRange(model, record, 10);
    for (const auto& id : hidden)
        model = withEffect(model, effectNamed(id), operatingRange);
    FitOptions options;
    options.fed = true;
    const auto linear = sumOfFinite(outputError(model, record, sections, {}, {}));
    const auto summary = fit(model, record, sections, options);
    INFO(summary.message << ", " << summary.chiSquaredPerValue);
    const auto simulated = sumOfFinite(outputError(model, record, sections, {}, {}));
    CHECK(linear.cost > 1e4 * linear.rows);
    CHECK(simulated.cost < 2.0 * simulated.rows);
}

TEST_CASE("Less what the laws add, a take shows the responses of its linear part", "[fed]")
{
    auto [record, model, sections] = ready({{"force-factor", 0.3}, {"stiffness", 0.3}});
    CHECK(withoutLaws(model, record).sections.front().measured == record.sections.front().measured);  // no law yet
    const auto operatingRange = visitedRange(model, record, 10);
    for (const auto* id : {"force-factor", "stiffness"})
        model = withEffect(model, effectNamed(id), operatingRange);
    FitOptions options;
    options.fed = true;
    fit(model, record, sections, options);
    const auto before = responsesOf(record, -1), after = responsesOf(withoutLaws(model, record), -1);
    REQUIRE(before.size() == after.size());
    for (std::size_t c = 0; c < before.size(); ++c) {
        INFO(name(before[c].quantity));
        CHECK(responseErrorDb(model, after[c]) < responseErrorDb(model, before[c]) - 15.0);
    }
}

TEST_CASE("Played, a model leaves what its simulation leaves, with the columns of fed laws", "[fed]")
{
    const auto start = ready({{"stiffness", 0.3}});
    auto model = bent(start.model, start.record, "stiffness");
    model.components.back() = scaled(model.components.back(), 3.0);  // its own motion is another than the take's
    const auto active = freeParameters(model);
    const auto motions = settledMotions(model, start.record, start.sections, 2);
    OutputErrorOptions run;
    run.substeps = 2;
    const auto played = sumOfFinite(playedError(model, start.record, start.sections, motions, active, run));
    const auto fed = sumOfFinite(feedbackError(model, start.record, start.sections, motions, active, run));
    run.gradient = false;
    const auto simulated = sumOfFinite(outputError(model, start.record, start.sections, {}, run));
    CHECK(played.cost == Approx(simulated.cost).epsilon(1e-12));
    CHECK(played.cost != Approx(fed.cost).epsilon(0.01));
    CHECK((played.N - fed.N).norm() < 1e-12 * fed.N.norm());
    run.played = true;
    CHECK(sumOfFinite(quickError(model, start.record, start.sections, active, run)).cost
          == Approx(simulated.cost).epsilon(1e-12));
}

TEST_CASE("Near the noise a simulation tells more than laws that are fed noise", "[fed]")
{
    const auto start = ready({{"friction", 0.4}});
    auto found = withEffect(start.model, effectNamed("friction"), visitedRange(start.model, start.record));
    for (auto& p : found.components.back().parameters)
        if (p.strength)
            p.value = 0.3;
    REQUIRE(fit(found, start.record, start.sections).usable());
    OutputErrorOptions run;
    run.substeps = 2;
    CHECK(isBetterPlayed(found, start.record, start.sections, run));
    CHECK(!isBetterPlayed(start.model, start.record, start.sections, run));  // without laws both are the same
}
