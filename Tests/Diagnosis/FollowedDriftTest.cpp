// SPDX-License-Identifier: GPL-3.0-or-later
// A take whose periods drift far above its sensors' noise, while their average is that of a steady loudspeaker.
#include "Engine/Diagnosis/FitEffects.h"
#include "Engine/Diagnosis/Improve.h"
#include "Engine/Error.h"
#include "Engine/Estimate/MakeRecord.h"
#include "SmallSetup.h"

#include <catch2/catch.hpp>

#include <stop_token>

using namespace excursion;

namespace {

/// @param drift  of the current, a period; none on the average
Measurement take(const bench::Loudspeaker& truth, double drift)
{
    auto setup = smallSetup();
    setup.excitation.periods = 4;
    auto result = bench::measure(truth, setup);
    const auto& e = *result.excitation;
    const auto period = static_cast<std::size_t>(e.period),
               each = static_cast<std::size_t>(e.settlePeriods + e.periods);
    for (auto& channel : result.channels)
        if (channel.quantity == Quantity::current)
            for (std::size_t n = 0; n < channel.samples.size(); ++n) {
                const double p = static_cast<double>(n / period % each) - e.settlePeriods;
                channel.samples[n] *= 1.0 + drift * (p - 0.5 * (e.periods - 1));
            }
    return result;
}

const ErrorLevel& current(const Comparison& comparison)
{
    REQUIRE(comparison.channels.front().quantity == Quantity::current);
    return comparison.channels.front().total;
}

}  // namespace

TEST_CASE("What periods drift is no noise to a model that leaves less", "[diagnosis]")
{
    const bench::Loudspeaker linear;
    auto steady = PreparedTake(take(linear, 0.0)).record(), drifting = PreparedTake(take(linear, 0.02)).record();
    const auto model = fitEffects(steady, {}, {});
    CHECK(noiseHoldsDrift(steady));  // was not needed
    CHECK_FALSE(followsDrift(model, steady));
    adapt(drifting, model);
    CHECK(followsDrift(model, drifting));
    const auto before = current(compare(model, drifting));
    CHECK(*before.noiseFloorDb > -40.0);
    CHECK(before.db < -60.0);
    takeDriftOutOfNoise(drifting);
    CHECK_FALSE(followsDrift(model, drifting));
    const auto after = current(compare(model, drifting));
    CHECK(*after.noiseFloorDb == Approx(*current(compare(model, steady)).noiseFloorDb).margin(1.5));
    CHECK(after.chiSquaredPerValue == Approx(1.0).margin(0.3));
}

TEST_CASE("A drift does not hide what a model lacks, and all rungs are told by one noise", "[improve][slow]")
{
    bench::Loudspeaker truth;
    truth.stiffness = bench::Curve {bench::Curve::Shape::coshSpring, 0.0, 3e-3, 0.0, 0.0};
    Improvement work {PreparedTake(take(truth, 0.02))};
    work.begin();
    const auto before = current(work.ladder().rungs.front().comparison);
    CHECK(work.ladder().verdict != Verdict::complete);
    std::stop_source stop;
    Progress progress;
    progress.stop = stop.get_token();
    progress.report = [&](double fraction, std::string_view) {
        if (fraction > 0.4)
            stop.request_stop();
    };
    CHECK_THROWS_AS(work.add("stiffness", progress), Error);
    CHECK(current(work.ladder().rungs.front().comparison).noiseFloorDb == before.noiseFloorDb);
    work.add("stiffness");
    REQUIRE(work.ladder().rungs.size() == 2);
    const auto& rungs = work.ladder().rungs;
    CHECK(current(rungs[0].comparison).noiseFloorDb == current(rungs[1].comparison).noiseFloorDb);
    CHECK(*current(rungs[1].comparison).noiseFloorDb < -60.0);
    CHECK(work.ladder().verdict == Verdict::complete);
}

TEST_CASE("Two time constants of a coil are followed along their valley until a step tells no more than noise",
          "[diagnosis]")
{
    auto setup = smallSetup();
    setup.excitation.realizations = 3;
    setup.excitation.levels = {1.0, 3.0, 9.0};
    setup.noiseDb = -55.0;
    bench::Loudspeaker truth;
    const auto cold = bench::measure(truth, setup);
    const double seconds = static_cast<double>(cold.length()) / cold.sampleRate;
    bench::CoilHeating heating;
    heating.coilResistance = 40.0;
    heating.magnetResistance = 0.3 * heating.coilResistance;
    heating.coilCapacity = 0.2 * seconds / heating.coilResistance;
    heating.magnetCapacity = 100.0 * heating.coilCapacity;
    truth.coilHeating = heating;
    auto record = makeRecord(bench::measure(truth, setup));
    const auto model = fitEffects(record, {"coil-heating"}, {});
    // Each level's last section, which is held out, is farthest from what the fit has seen.
    CHECK(compare(model, record, {0, false}).chiSquaredPerValue < 1.15);
}
