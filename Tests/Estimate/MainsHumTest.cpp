// SPDX-License-Identifier: GPL-3.0-or-later
#include "Bench/Bench.h"
#include "Engine/Estimate/MainsHum.h"
#include "Engine/Signal/Level.h"
#include "SmallSetup.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

using namespace excursion;

namespace {

Measurement quietTake()
{
    auto setup = smallSetup();
    setup.excitation.period = 8192;
    setup.excitation.realizations = 3;
    setup.excitation.levels = {0.5, 2.0};
    setup.noiseDb = -75.0;
    return bench::measure(bench::Loudspeaker {}, setup);
}

double apartDb(const Channel& a, const Channel& b)
{
    double apart = 0.0;
    for (std::size_t n = 0; n < a.samples.size(); ++n)
        apart += std::pow(a.samples[n] - b.samples[n], 2);
    return 10.0 * std::log10(apart / static_cast<double>(a.samples.size())) - 20.0 * std::log10(rmsOf(a.samples));
}

}  // namespace

TEST_CASE("Hum of the mains is taken off, also where it nearly repeats in every period", "[hum]")
{
    const auto quiet = quietTake();
    for (const double mains : {49.9, 50.03, 52.8 * 1.136, 60.1}) {
        INFO(mains << " Hz");
        auto take = quiet;
        for (auto& channel : take.channels) {
            const double size = rmsOf(channel.samples) * std::sqrt(2.0) * 1e-4;  // -80 dB
            for (std::size_t n = 0; n < channel.samples.size(); ++n) {
                const double phase = 2.0 * std::numbers::pi * mains * static_cast<double>(n) / take.sampleRate;
                channel.samples[n] += size * (std::sin(phase + 0.4) + 0.4 * std::sin(3.0 * phase));
            }
        }
        CHECK(takeOffHum(take) >= 6);
        for (std::size_t c = 0; c < take.channels.size(); ++c) {
            INFO(name(take.channels[c].quantity));
            CHECK(apartDb(quiet.channels[c], take.channels[c]) < -95.0);
        }
    }
}

TEST_CASE("A take without hum, or without two periods to tell it by, stays as it is", "[hum]")
{
    const auto quiet = quietTake();
    auto take = quiet;
    CHECK(takeOffHum(take) == 0);
    for (std::size_t c = 0; c < take.channels.size(); ++c)
        CHECK(take.channels[c].samples == quiet.channels[c].samples);
    take.excitation->settlePeriods += 1;
    take.excitation->periods -= 1;
    CHECK(takeOffHum(take) == 0);
    take.excitation.reset();
    CHECK(takeOffHum(take) == 0);
}
