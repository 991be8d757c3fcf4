// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/Compare.h"
#include "Engine/Diagnosis/ComparisonFile.h"
#include "Engine/Diagnosis/Diagnose.h"
#include "Engine/Diagnosis/FitEffects.h"
#include "Engine/Estimate/MakeRecord.h"
#include "SmallSetup.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <functional>

using namespace excursion;

namespace {

/// A driver that goes further to one side, its take, and its model.
struct Setup {
    Measurement take;
    Model model;

    Setup()
    {
        auto setup = smallSetup();
        setup.excitation.settlePeriods = 2;
        setup.excitation.realizations = 1;
        setup.excitation.levels = {1.0, 2.0, 4.0, 6.0};
        bench::Loudspeaker speaker;
        speaker.stiffness = bench::Curve {bench::Curve::Shape::coshSpring, 0.6e-3, 4e-3, 0.0, 0.0};
        take = bench::measure(speaker, setup);
        auto record = makeRecord(take);
        model = fitEffects(record, {"stiffness"}, {});
    }

    /// The comparison after what `more`, in m, has been added at a time in s.
    Comparison with(const std::function<double(double)>& more) const
    {
        auto changed = take;
        for (auto& channel : changed.channels)
            if (channel.quantity == Quantity::displacement)
                for (std::size_t n = 0; n < channel.samples.size(); ++n)
                    channel.samples[n] += more(static_cast<double>(n) / take.sampleRate);
        return compare(model, makeRecord(changed));
    }
    double seconds() const { return static_cast<double>(take.length()) / take.sampleRate; }
};

}  // namespace

TEST_CASE("A rest position that moves between two sections is told, and that is not complete", "[compare]")
{
    const Setup setup;
    constexpr double moved = 3e-4;
    CHECK_FALSE(setup.with([](double) { return 0.0; }).restShift);
    CHECK_FALSE(setup.with([](double) { return 2e-3; }).restShift);                            // the sensor's zero
    CHECK_FALSE(setup.with([&](double t) { return moved * t / setup.seconds(); }).restShift);  // which drifts
    for (const double share : {0.1, 0.2, 0.4})                                                 // as it warms
        CHECK_FALSE(setup.with([&](double t) { return moved * std::exp(-t / (share * setup.seconds())); }).restShift);
    const double when = (2.0 / 4.0 + 0.02) * setup.seconds();  // while it settles
    const auto comparison = setup.with([&](double t) { return t < when ? 0.0 : -moved; });
    REQUIRE(comparison.restShift);
    CHECK(comparison.restShift->moved == Approx(moved).epsilon(0.1));
    CHECK(comparison.restShift->after < when);
    CHECK(comparison.restShift->before > when);
    const auto diagnosis = diagnose(setup.model, makeRecord(setup.take), comparison);
    CHECK(diagnosis.verdict == Verdict::unknownEffect);
    CHECK_THAT(diagnosis.sentence, Catch::Contains("rest position"));
    const auto read = comparisonFromJson(JsonField(toJson(comparison), "", "some.json"));
    REQUIRE(read.restShift);
    CHECK(read.restShift->moved == comparison.restShift->moved);
}

TEST_CASE("A suspension that is softer at 0 Hz than the model has not moved", "[compare]")
{
    const Setup setup;
    auto record = makeRecord(setup.take);
    const auto channel = *record.channelIndex(Quantity::displacement);
    OutputErrorOptions options;
    options.gradient = false;
    options.spectra = true;
    for (std::size_t n = 0; n < record.sections.size(); ++n) {
        const auto fit = outputError(setup.model, record, {n}, {}, options).front();
        record.sections[n].measured[channel].front() = 4.0 * fit.predicted[channel].front();
    }
    CHECK_FALSE(compare(setup.model, record).restShift);
}

TEST_CASE("A sensor that holds back what is constant tells of no shift", "[compare]")
{
    const Setup setup;
    auto record = makeRecord(setup.take);
    const auto channel = *record.channelIndex(Quantity::displacement);
    for (auto& section : record.sections)
        section.measured[channel].front() = 0.0;
    CHECK_FALSE(compare(setup.model, record).restShift);
}
