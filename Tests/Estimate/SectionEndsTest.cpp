// SPDX-License-Identifier: GPL-3.0-or-later
// Takes through converters of linear phase, which ring before a section ends.
#include "Engine/Estimate/AveragedPeriods.h"
#include "Engine/Estimate/SectionEnds.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

using namespace excursion;

namespace {

constexpr int period = 2048, half = 40;

/// A low-pass of linear phase whose passband ends at 0.9 of half the sample rate, as converters have it.
std::vector<double> converter()
{
    std::vector<double> h;
    for (int n = -half; n <= half; ++n) {
        const double x = 0.9 * std::numbers::pi * n, window = 0.5 + 0.5 * std::cos(std::numbers::pi * n / (half + 1.0));
        h.push_back(0.9 * window * (n == 0 ? 1.0 : std::sin(x) / x));
    }
    return h;
}

std::vector<double> through(const std::vector<double>& h, const std::vector<double>& x)
{
    std::vector<double> y(x.size(), 0.0);
    for (std::size_t n = 0; n < x.size(); ++n)
        for (int k = -half; k <= half; ++k)
            if (const auto from = static_cast<long>(n) - k; from >= 0 && from < static_cast<long>(x.size()))
                y[n] += h[static_cast<std::size_t>(k + half)] * x[static_cast<std::size_t>(from)];
    return y;
}

/// Voltage and current of two levels and two realizations, with noise of that rms.
Measurement takeOf(int periods, int settling, double noise, bool converted, int N = period)
{
    Measurement take;
    take.sampleRate = 48000.0;
    Excitation e;
    e.period = N;
    e.settlePeriods = settling;
    e.periods = periods;
    e.realizations = 2;
    e.levels = {1.0, 3.0};
    for (int k = 3; k < 200; k += 2)
        e.lines.push_back(k);
    take.excitation = e;
    std::mt19937_64 random(11);
    std::uniform_real_distribution<double> phase(0.0, 2.0 * std::numbers::pi);
    std::normal_distribution<double> normal;
    Channel voltage, current;
    voltage.quantity = Quantity::voltage;
    current.quantity = Quantity::current;
    for (const double level : e.levels)
        for (int m = 0; m < e.realizations; ++m) {
            std::vector<double> once(static_cast<std::size_t>(N), 0.0);
            for (const int k : e.lines) {
                const double at = phase(random);
                for (int n = 0; n < N; ++n)
                    once[static_cast<std::size_t>(n)] += level / 10.0
                                                         * std::cos(2.0 * std::numbers::pi * k * n / N + at);
            }
            for (int p = 0; p < settling + periods; ++p)
                voltage.samples.insert(voltage.samples.end(), once.begin(), once.end());
        }
    if (converted)
        voltage.samples = through(converter(), voltage.samples);
    current.samples = voltage.samples;
    for (auto* channel : {&voltage, &current})
        for (double& sample : channel->samples)
            sample = (channel == &current ? 0.2 : 1.0) * sample + noise * normal(random);
    take.channels = {voltage, current};
    return take;
}

/// The worst error of an averaged period, over the rms of the signal.
double worstError(const Measurement& take, const Measurement& truth)
{
    double worst = 0.0;
    for (std::size_t c = 0; c < take.channels.size(); ++c)
        for (int level = 0; level < 2; ++level)
            for (int m = 0; m < 2; ++m) {
                const auto mean = averagePeriod(take, take.channels[c], level, m);
                // amid a section nothing rings
                const auto steady = onePeriod(truth, truth.channels[c], level, m, 0);
                double power = 0.0, most = 0.0;
                for (std::size_t n = 0; n < mean.size(); ++n) {
                    power += steady[n] * steady[n] / static_cast<double>(mean.size());
                    most = std::max(most, std::abs(mean[n] - steady[n]));
                }
                worst = std::max(worst, most / std::sqrt(power));
            }
    return worst;
}

}  // namespace

TEST_CASE("What converters ring before a section ends is not taken for the steady state", "[estimate]")
{
    for (const auto& [periods, settling] : {std::pair {2, 1}, {3, 0}, {5, 2}}) {
        auto take = takeOf(periods, settling, 0.0, true);
        const auto raw = take;
        CHECK(worstError(take, raw) > 1e-3);
        CHECK(settleEnds(take) == 8);
        CHECK(worstError(take, raw) < (settling > 0 ? 1e-9 : 0.5));  // without settling the first period rings, too
        for (std::size_t n = 0; n + 128 < static_cast<std::size_t>(period); ++n)
            REQUIRE(onePeriod(take, take.channels[0], 0, 0, periods - 1)[n]
                    == onePeriod(raw, raw.channels[0], 0, 0, periods - 1)[n]);
    }
}

TEST_CASE("The end of a short period is mended as that of a long one, and no more of it than rings", "[estimate]")
{
    for (const int N : {512, 1024, 4096}) {
        auto take = takeOf(3, 1, 1e-5, true, N);
        const auto raw = take, truth = takeOf(3, 1, 0.0, true, N);
        INFO(N);
        CHECK(worstError(take, truth) > 1e-3);
        CHECK(settleEnds(take) == 8);
        CHECK(worstError(take, truth) < 4e-4);  // of the noise alone: 1e-5 beside 0.14 and less
        // The converter rings for 40 samples.
        for (std::size_t n = 0; n + 64 < static_cast<std::size_t>(N); ++n)
            REQUIRE(onePeriod(take, take.channels[0], 0, 0, 2)[n] == onePeriod(raw, raw.channels[0], 0, 0, 2)[n]);
    }
}

TEST_CASE("With one period the settling period before it tells how a section ends", "[estimate]")
{
    auto take = takeOf(1, 2, 0.0, true);
    const auto with = onePeriod(take, take.channels[0], 1, 0, -1);
    const std::vector<double> steady(with.begin(), with.end());
    CHECK(settleEnds(take) == 8);
    const auto last = onePeriod(take, take.channels[0], 1, 0, 0);
    for (std::size_t n = 0; n < last.size(); ++n)
        REQUIRE(std::abs(last[n] - steady[n]) < 1e-9);
    auto alone = takeOf(1, 0, 0.0, true);
    CHECK(settleEnds(alone) == 0);
}

TEST_CASE("The noise of a take through converters is that of its channels", "[estimate]")
{
    constexpr double noise = 1e-4;
    const auto noiseOf = [](const Measurement& take) {
        const auto averaged = averagedPeriod(take, take.channels[0], 1, 0);
        double sum = 0.0;
        for (const double v : averaged.variance)
            sum += v;
        return std::sqrt(sum / static_cast<double>(averaged.variance.size()) * 3.0 / period);
    };
    auto take = takeOf(3, 1, noise, true);
    CHECK(noiseOf(take) > 3.0 * noise);
    settleEnds(take);
    CHECK(noiseOf(take) == Approx(noise).epsilon(0.05));
}

TEST_CASE("A take whose sections end as they go on stays as it is, and so does one without long periods", "[estimate]")
{
    auto take = takeOf(3, 1, 1e-4, false);
    const auto raw = take;
    CHECK(settleEnds(take) == 0);
    CHECK(take.channels[0].samples == raw.channels[0].samples);
    auto aperiodic = take;
    aperiodic.excitation.reset();
    CHECK(settleEnds(aperiodic) == 0);
    auto cut = takeOf(3, 1, 1e-4, true);
    cut.channels[1].samples.resize(cut.channels[1].samples.size() - 9);
    CHECK(settleEnds(cut) == 0);
    auto quick = takeOf(3, 1, 1e-4, true);
    quick.excitation->period = 128;
    CHECK(settleEnds(quick) == 0);
}

TEST_CASE("What is no ringing is left to the check", "[estimate]")
{
    const auto clean = takeOf(3, 1, 1e-4, false);
    const auto end = static_cast<std::size_t>(clean.excitation->samplesPerRealization());
    const auto untouched = [&](const char* what, const std::function<void(std::vector<double>&)>& spoil) {
        auto take = clean;
        spoil(take.channels[1].samples);
        const auto spoilt = take.channels[1].samples;
        INFO(what);
        CHECK(settleEnds(take) == 0);
        CHECK((take.channels[1].samples == spoilt));
    };
    untouched("a block that was lost",
              [end](auto& x) { std::fill_n(x.begin() + static_cast<long>(end) - 128, 128, 0.0); });
    untouched("a block that stands still",
              [end](auto& x) { std::fill_n(x.begin() + static_cast<long>(end) - 120, 120, x[end - 121]); });
    untouched("samples of the next section", [end](auto& x) {
        x.erase(x.begin() + 100, x.begin() + 200);
        x.resize(x.size() + 100);
        (void)end;
    });
    untouched("a knock", [end](auto& x) {
        for (std::size_t n = end - 60; n < end; ++n)
            x[n] += 2.0 * std::exp(-0.1 * static_cast<double>(n + 60 - end));
    });
}

TEST_CASE("A channel that drifts is mended where it is, and only where it rings", "[estimate]")
{
    auto take = takeOf(3, 1, 1e-5, true);
    auto& current = take.channels[1].samples;
    for (std::size_t n = 0; n < current.size(); ++n)
        current[n] += 1e-6 * static_cast<double>(n);  // as a rest that wanders
    const auto raw = current;
    CHECK(settleEnds(take) > 4);
    const auto end = static_cast<std::size_t>(take.excitation->samplesPerRealization());
    CHECK(std::abs(current[end - 100] - raw[end - 100]) < 2e-4);
}
