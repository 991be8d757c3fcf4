// SPDX-License-Identifier: GPL-3.0-or-later
// Distortion of a weakly bent spring under a tone has a closed form; what is said of several effects must add up to it.
#include "Engine/Design/DistortionByEffect.h"

#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/Model.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <complex>
#include <numbers>
#include <random>

using namespace excursion;

namespace {

constexpr std::size_t N = 4096;
constexpr double sampleRate = 4096.0;  // lines are Hz
constexpr double range = 2e-3;

/// A cone on a spring K + c1 (x/X) + 2 c2 (x/X)^2, driven by a force.
Model spring(double c1, double c2)
{
    OperatingRange operatingRange;
    operatingRange.displacement = range;
    operatingRange.degree = 2;
    operatingRange.lowFrequency = 10.0;
    auto model = withEffect(makeModel("mechanical"), effectNamed("stiffness"), operatingRange);
    model.baseParameter("m").value = 0.01;
    model.baseParameter("Rms").value = 1.0;
    model.baseParameter("K").value = 1000.0;
    auto& p = model.components.back().parameters;
    p[0].value = c1;
    p[1].value = c2;
    return model;
}

std::complex<double> compliance(double hertz)
{
    const std::complex<double> s(0.0, 2.0 * std::numbers::pi * hertz);
    return 1.0 / (0.01 * s * s + 1.0 * s + 1000.0);
}

/// A period with those forces on those lines, at sections of level 0 and of level 1, which is twice as loud.
Record forces(const std::vector<int>& lines, double amplitude)
{
    Record record;
    record.sampleRate = sampleRate;
    record.electrical = false;
    record.channels = {Quantity::displacement};
    record.units = {"m"};
    record.levels = {amplitude / std::numbers::sqrt2, 2.0 * amplitude / std::numbers::sqrt2};
    record.lowFrequency = 1.0;
    record.highFrequency = 400.0;
    record.bandLow = lines.front();
    record.bandHigh = lines.back();
    std::mt19937 random(3);
    std::uniform_real_distribution<double> phase(0.0, 2.0 * std::numbers::pi);
    for (int level = 0; level < 2; ++level) {
        Section section;
        section.level = level;
        section.realization = 0;
        section.periodic = true;
        section.window = N;
        section.excited = lines;
        section.input.assign(N, 0.0);
        for (const int k : lines) {
            const double at = phase(random);
            for (std::size_t n = 0; n < N; ++n)
                section.input[n] += (level + 1.0) * amplitude
                                    * std::cos(2.0 * std::numbers::pi * k * static_cast<double>(n) / N + at);
        }
        section.measured.assign(1, std::vector<std::complex<double>>(N / 2 + 1));
        section.deviation.assign(1, std::vector<double>(N / 2 + 1, 1.0));
        record.sections.push_back(section);
    }
    return record;
}

const ChannelDistortion& displacement(const std::vector<ChannelDistortion>& channels) { return channels.front(); }

}  // namespace

TEST_CASE("A tone on a bent spring has the harmonics that perturbation tells", "[design]")
{
    const double f = 30.0, force = 0.05;
    const double x = force * std::abs(compliance(f));
    const auto record = forces({30}, 0.5 * force);  // the louder section has the force
    REQUIRE(loudestSections(record) == std::vector<std::size_t> {1});

    SECTION("on one side: the second harmonic, k1 X^2/2 |H(2w)|")
    {
        const double c1 = 10.0;
        const auto told = distortionByEffect(spring(c1, 0.0), record, {1});
        const double second = c1 / range * x * x / 2.0 * std::abs(compliance(2.0 * f));
        CHECK(displacement(told.whole).evenDb == Approx(20.0 * std::log10(second / x)).margin(0.02));
        CHECK(displacement(told.whole).oddDb < displacement(told.whole).evenDb - 30.0);
        CHECK(displacement(told.whole).rms == Approx(x / std::numbers::sqrt2).epsilon(1e-3));
        CHECK(told.level == Approx(force / std::numbers::sqrt2).epsilon(1e-9));
    }
    SECTION("on both: the third, k2 X^3/4 |H(3w)|, and a stiffer spring")
    {
        const double c2 = 10.0, k2 = 2.0 * c2 / (range * range);
        const auto told = distortionByEffect(spring(0.0, c2), record, {1});
        const double third = k2 * x * x * x / 4.0 * std::abs(compliance(3.0 * f));
        CHECK(displacement(told.whole).oddDb == Approx(20.0 * std::log10(third / x)).margin(0.05));
        CHECK(displacement(told.whole).evenDb == Approx(-120.0));
        const double stiffer = 0.75 * k2 * x * x;  // describing function of k2 x^3
        CHECK(displacement(told.whole).gainDb
              == Approx(-20.0 * std::log10(std::abs(1.0 + stiffer * compliance(f)))).margin(0.003));
    }
}

TEST_CASE("Without its only effect a driver has no distortion, and alone that effect has all of it", "[design]")
{
    const auto record = forces({21, 25, 27, 33, 35, 39, 45, 47, 53, 55}, 0.02);
    const auto told = distortionByEffect(spring(30.0, 20.0), record, loudestSections(record));
    REQUIRE(told.effects.size() == 1);
    CHECK(displacement(told.effects[0].without).evenDb == Approx(-120.0));
    CHECK(displacement(told.effects[0].without).oddDb == Approx(-120.0));
    CHECK(displacement(told.effects[0].without).gainDb == Approx(0.0).margin(1e-9));
    CHECK(displacement(told.effects[0].alone).evenDb == displacement(told.whole).evenDb);
    CHECK(displacement(told.effects[0].alone).oddDb == displacement(told.whole).oddDb);
}

TEST_CASE("Distortion is told alike from lines left out and, where none are, beside a gain a band", "[design]")
{
    // The same density of power: one line in two carries what all of them do. Little damping would bend g within a
    // band.
    auto model = spring(0.0, 25.0);
    model.baseParameter("Rms").value = 6.0;
    std::vector<int> some, all;
    for (int k = 15; k < 160; ++k) {
        all.push_back(k);
        if (k % 2 == 1 && k % 8 != 7)
            some.push_back(k);
    }
    const auto share = static_cast<double>(all.size()) / static_cast<double>(some.size());
    const auto left = distortionByEffect(model, forces(some, 0.012), {1}),
               none = distortionByEffect(model, forces(all, 0.012 / std::sqrt(share)), {1});
    CHECK(displacement(left.whole).rms == Approx(displacement(none.whole).rms).epsilon(0.2));
    // of one draw of phases each
    CHECK(displacement(left.whole).oddDb == Approx(displacement(none.whole).oddDb).margin(3.0));
}

TEST_CASE("What runs away without an effect says nothing", "[design]")
{
    // A spring that is pulled off its seat on one side, and held there by nothing else.
    auto model = spring(-3000.0, 0.0);
    CHECK_THROWS_AS(distortionByEffect(model, forces({30}, 50.0), {1}), Error);
}
