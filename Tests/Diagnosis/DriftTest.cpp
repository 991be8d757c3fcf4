// SPDX-License-Identifier: GPL-3.0-or-later
// What has drifted of a driver of the bench since its model was fitted, found in a short take.
#include "BenchModel.h"
#include "SeedDriver.h"

#include "Bench/Bench.h"
#include "Engine/Diagnosis/Compare.h"
#include "Engine/Diagnosis/FitEffects.h"
#include "Engine/Error.h"
#include "Engine/Estimate/MakeRecord.h"
#include "Engine/Loudspeaker/Drift.h"
#include "Engine/Loudspeaker/Laws.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace excursion;

namespace {

const bench::Draw& drawn()
{
    static const auto one = drawSeedDriver({{"force-factor", 0.3}, {"stiffness", 0.3}},
                                           {Quantity::current, Quantity::displacement});
    return one;
}

/// Fitted to two seconds of the driver as it was.
const Model& fitted()
{
    static const auto model = [] {
        auto record = makeRecord(bench::measure(drawn().speaker, drawn().setup));
        return fitEffects(record, {"force-factor", "stiffness"}, {});
    }();
    return model;
}

/// One level, two realizations of two periods each, other phases and other noise; softer than the loudest that the
/// model was fitted to, as a softer suspension would go beyond where its laws were measured.
Measurement shortTake(const bench::Loudspeaker& speaker)
{
    auto setup = drawn().setup;
    setup.excitation.levels = {0.6 * setup.excitation.levels.back()};
    setup.excitation.realizations = 2;
    setup.excitation.periods = 2;
    setup.seed += 100;
    return bench::measure(speaker, setup);
}

Record recordOf(const Measurement& take, const Model& model)
{
    auto record = makeRecord(take);
    adapt(record, model);
    return record;
}

const Drifted& named(const std::vector<Drifted>& all, const std::string& name)
{
    for (const auto& one : all)
        if (one.name == name)
            return one;
    FAIL("no " << name);
    throw std::logic_error("unreachable");
}

}  // namespace

TEST_CASE("A warm coil and a suspension that has become softer are found in a short take, and nothing else moves",
          "[drift][slow]")
{
    auto speaker = drawn().speaker;
    speaker.Re *= 1.12;
    speaker.K *= 0.8;  // all of K(x)
    speaker.Rms *= 1.1;
    const auto take = shortTake(speaker);
    CHECK(static_cast<double>(take.channels.front().samples.size()) / take.sampleRate < 3.0);
    const auto& before = fitted();
    const auto record = recordOf(take, before);
    const auto drift = followDrift(before, record, driftingParameters(before));
    REQUIRE(drift.parameters.size() == 3);
    for (const auto& [name, truth] : {std::pair {"Re", speaker.Re}, {"Rms", speaker.Rms}, {"K", speaker.K}}) {
        const auto& found = named(drift.parameters, name);
        INFO(name << " was " << found.before << " +- " << found.beforeError << ", is " << found.after << " +- "
                  << found.afterError << ", in truth " << truth);
        CHECK(found.before == before.baseParameter(name).value);
        // What was held is known no better than the first take told: 0.3 % is what that comes to.
        CHECK(std::abs(found.after / truth - 1.0) < std::max(3e-3, 4.0 * found.afterError / truth));
        CHECK(found.afterError > 0.0);
        CHECK(found.afterError < 0.01 * truth);
        CHECK(found.certainty() > 10.0);
    }
    CHECK(*drift.warmer == Approx(0.12 / 0.0039).epsilon(0.02));
    CHECK(*drift.warmerError < 2.0);
    const auto& f0 = named(drift.figures, "f0");
    CHECK(f0.after / f0.before == Approx(std::sqrt(0.8)).epsilon(3e-3));
    CHECK(f0.afterError < 0.01 * f0.after);
    for (const auto* name : {"Le", "Bl", "m"}) {
        CHECK(drift.model.baseParameter(name).value == before.baseParameter(name).value);
        CHECK(drift.model.baseParameter(name).standardError == before.baseParameter(name).standardError);
        CHECK(drift.model.baseParameter(name).free == before.baseParameter(name).free);
    }
    // The laws as they are now.
    for (const auto& law : laws(drift.model))
        for (std::size_t k = 0; k < law.argument.size(); k += 8) {
            const double x = law.argument[k],
                         truth = law.info.name == "K(x)" ? speaker.stiffnessAt(x) : speaker.forceFactorAt(x);
            INFO(law.info.name << " at " << x);
            CHECK(law.value[k] == Approx(truth).epsilon(0.02));
        }
    // The old model is far off, the new one at the noise.
    const auto was = compare(before, record), is = compare(drift.model, record);
    for (std::size_t c = 0; c < is.channels.size(); ++c) {
        INFO("error " << was.channels[c].total.db << " dB before, " << is.channels[c].total.db << " after, noise "
                      << is.channels[c].total.noiseFloorDb.value_or(0.0));
        CHECK(was.channels[c].total.db > -30.0);
        CHECK(is.channels[c].total.db < *is.channels[c].total.noiseFloorDb + 6.0);
    }
    CHECK(drift.model.covariance.rows() == before.covariance.rows());
    CHECK(drift.model.covariance.isApprox(drift.model.covariance.transpose()));
}

TEST_CASE("Where nothing has drifted nothing moves, and what does not drift is not bent to explain what has",
          "[drift][slow]")
{
    const auto& before = fitted();
    const auto same = followDrift(before, recordOf(shortTake(drawn().speaker), before), driftingParameters(before));
    for (const auto& one : same.parameters) {
        INFO(one.name << " by " << one.share());
        CHECK(std::abs(one.share()) < 5e-3);
    }
    CHECK(std::abs(*same.warmer) < 1.5);
    auto speaker = drawn().speaker;
    speaker.Bl *= 0.9;
    const auto record = recordOf(shortTake(speaker), before);
    const auto wrong = followDrift(before, record, driftingParameters(before)),
               right = followDrift(before, record, {"Bl"});
    CHECK(compare(wrong.model, record).chiSquaredPerValue > 20.0 * compare(right.model, record).chiSquaredPerValue);
    CHECK(right.model.baseParameter("Bl").value == Approx(speaker.Bl).epsilon(3e-3));
    CHECK_FALSE(right.warmer);
}

TEST_CASE("What is not to move stays, also where a take tells less than the model's own", "[drift]")
{
    const auto& before = fitted();
    auto take = shortTake(drawn().speaker);
    std::erase_if(take.channels, [](const Channel& c) { return c.quantity == Quantity::current; });
    const auto drift = followDrift(before, recordOf(take, before), {"K"});
    REQUIRE(drift.parameters.size() == 1);
    for (const auto& p : before.base().parameters) {
        CAPTURE(p.name);
        CHECK(drift.model.baseParameter(p.name).free == p.free);
        CHECK((drift.model.baseParameter(p.name).value == p.value) == (p.name != "K"));
    }
}

TEST_CASE("An impedance tells a drift as well", "[drift]")
{
    bench::Loudspeaker speaker;
    auto model = test::baseOf(speaker);
    speaker.Re *= 1.05;
    speaker.K *= 1.3;
    ResponseTarget impedance;
    impedance.impedance = true;
    for (double f = 10.0; f < 2000.0; f *= 1.03) {
        impedance.frequency.push_back(f);
        impedance.value.push_back(1.0 / speaker.small(f).current);
        impedance.deviation.push_back(1e-3 * std::abs(impedance.value.back()));
    }
    const auto drift = followDrift(model, {impedance}, driftingParameters(model));
    CHECK(named(drift.parameters, "Re").after == Approx(speaker.Re).epsilon(1e-6));
    CHECK(named(drift.parameters, "K").after == Approx(speaker.K).epsilon(1e-6));
    CHECK(named(drift.parameters, "Rms").share() == Approx(0.0).margin(1e-6));
    CHECK(*drift.warmer == Approx(0.05 / 0.0039).epsilon(1e-5));
    CHECK_THROWS_WITH(followDrift(model, {impedance}, {"Sd"}), Catch::Contains("no parameter \"Sd\""));
    CHECK_THROWS_AS(followDrift(model, {impedance}, {}), Error);
}
