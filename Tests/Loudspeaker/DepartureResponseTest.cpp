// SPDX-License-Identifier: GPL-3.0-or-later
// An amplifier that passes no constant voltage has not forgotten the last signal when the periods begin that count.
#include "Bench/Bench.h"
#include "Engine/Estimate/MakeRecord.h"
#include "Engine/Loudspeaker/Fit.h"
#include "Engine/Loudspeaker/FitResponse.h"
#include "Engine/Loudspeaker/OutputError.h"
#include "Engine/Signal/Level.h"
#include "SmallSetup.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

using namespace excursion;

namespace {

/// A take behind a high-pass of first order. @param corner  Hz; 0: none
Measurement behindHighPass(double corner)
{
    auto setup = smallSetup();
    setup.excitation.levels = {0.5, 2.0};
    setup.noiseDb = -std::numeric_limits<double>::infinity();
    const auto direct = bench::measure(bench::Loudspeaker {}, setup);
    auto voltage = direct.input().samples;
    const double k = std::tan(std::numbers::pi * corner / direct.sampleRate), pole = (1.0 - k) / (1.0 + k);
    double before = 0.0, passed = 0.0;
    for (auto& u : voltage) {
        passed = pole * passed + (u - before) / (1.0 + k);
        before = u;
        u = passed;
    }
    auto take = bench::play(bench::Loudspeaker {}, voltage, direct.sampleRate,
                            {Quantity::voltage, Quantity::current, Quantity::displacement});
    take.excitation = direct.excitation;
    std::mt19937_64 random(3);
    for (auto& channel : take.channels) {
        std::normal_distribution<double> noise(0.0, 1e-4 * rmsOf(channel.samples));
        for (auto& y : channel.samples)
            y += noise(random);
    }
    return take;
}

/// Mean squared error over the noise on the lines between the played ones.
double leftBetween(const Model& model, const Record& record, double highest)
{
    const auto sections = estimationSections(record);
    OutputErrorOptions run;
    run.gradient = false;
    run.spectra = true;
    run.substeps = substepsFor(model, record);
    const auto fits = outputError(model, record, sections, {}, run);
    double sum = 0.0, count = 0.0;
    for (std::size_t n = 0; n < sections.size(); ++n) {
        const auto& section = record.sections[sections[n]];
        for (std::size_t k = 1; record.frequency(section, k) < highest; ++k)
            if (std::find(section.excited.begin(), section.excited.end(), static_cast<int>(k)) == section.excited.end())
                for (std::size_t c = 0; c < record.channels.size(); ++c, ++count)
                    sum += std::norm(fits[n].predicted[c][k] - section.measured[c][k])
                           / std::pow(section.deviation[c][k], 2);
    }
    return sum / count;
}

}  // namespace

TEST_CASE("What rings from one period into the next behind a high-pass is predicted", "[departure]")
{
    auto record = makeRecord(behindHighPass(1.5));
    REQUIRE(!record.sections.front().departure.spectrum.empty());
    auto model = startModel(record);
    for (int stage = 0; stage < 3; ++stage)
        REQUIRE(fit(model, record, estimationSections(record)).usable());
    for (const double highest : {100.0, 400.0, 800.0}) {
        INFO("up to " << highest << " Hz");
        CHECK(leftBetween(model, record, highest) < 1.2);
    }
    for (auto& section : record.sections)
        section.departure.spectrum.clear();
    CHECK(leftBetween(model, record, 400.0) > 4.0);
}

TEST_CASE("An input that is periodic departs from nothing", "[departure]")
{
    const auto record = makeRecord(behindHighPass(0.0));
    for (std::size_t s = 0; s < record.sections.size(); ++s) {
        INFO("section " << s);
        CHECK(record.sections[s].departure.spectrum.empty());
    }
}
