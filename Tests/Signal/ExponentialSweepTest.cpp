// SPDX-License-Identifier: GPL-3.0-or-later
// The sweep against its definition, its spectrum against quadrature.
#include "Engine/Error.h"
#include "Engine/Signal/Convolution.h"
#include "Engine/Signal/ExponentialSweep.h"
#include "Engine/Signal/Level.h"
#include "Scratch.h"

#include <cmath>
#include <numbers>
#include <random>

using namespace excursion;
using excursion::test::refused;

TEST_CASE("Each harmonic of a synchronized sweep is the sweep itself, earlier")
{
    const auto rate = GENERATE(44100.0, 96000.0);
    const auto low = GENERATE(7.3, 20.0);
    const ExponentialSweep sweep({.sampleRate = rate, .bandLow = low, .bandHigh = 9000.0, .seconds = 3.0, .peak = 2.5});
    const double L = sweep.rate(), pi = std::numbers::pi;
    CHECK(low * L == Approx(std::round(low * L)).margin(1e-9));
    CHECK(std::abs(sweep.seconds() - 3.0) <= 0.5 / low * std::log(9000.0 / low) + 1e-9);
    const auto x = sweep.samples();
    CHECK(x.size() == static_cast<std::size_t>(std::ceil(sweep.seconds() * rate)));
    CHECK(peakOf(x) == Approx(2.5).epsilon(1e-3));
    CHECK(std::abs(x[0]) < 1e-9);
    const auto phase = [&](double t) { return 2 * pi * low * L * std::exp(t / L); };
    for (const int m : {2, 3, 7})
        for (const double t : {0.0, 0.5, 0.77}) {
            // Equal to the sweep's own phase at the earlier time but for whole turns, as f1 L is whole
            CHECK(std::remainder(m * phase(t) - phase(t + sweep.advance(m)), 2 * pi) == Approx(0.0).margin(1e-6));
            CHECK(std::sin(m * phase(t)) == Approx(std::sin(phase(t + sweep.advance(m)))).margin(1e-6));
        }
    // The instantaneous frequency at both ends, from zero crossings
    std::size_t turns = 0;
    for (std::size_t n = 1; n < x.size(); ++n)
        turns += x[n - 1] < 0.0 && x[n] >= 0.0;
    CHECK(static_cast<double>(turns) == Approx((phase(sweep.seconds()) - phase(0.0)) / (2 * pi)).margin(1.5));
}

TEST_CASE("The spectrum of a sweep is what quadrature of a sweep with far ends gives")
{
    // The window opens and closes over decades of frequency: its ripple is far below what is compared.
    const ExponentialSweep sweep(
        {.sampleRate = 48000.0, .bandLow = 10.0, .bandHigh = 4000.0, .seconds = 2.0, .peak = 1.7});
    const double L = sweep.rate(), pi = std::numbers::pi;
    for (const double f : {60.0, 231.7, 700.0}) {
        const double from = L * std::log(0.1), to = L * std::log(400.0), dt = 1e-6 * 20;  // 1 Hz .. 4 kHz
        std::complex<double> sum;
        for (double t = from; t < to; t += dt) {
            const double position = (t - from) / (to - from);
            const double window = position < 0.3    ? 0.5 - 0.5 * std::cos(pi * position / 0.3)
                                  : position > 0.85 ? 0.5 - 0.5 * std::cos(pi * (1 - position) / 0.15)
                                                    : 1.0;
            sum += window * 1.7 * std::sin(2 * pi * 10.0 * L * std::exp(t / L)) * std::polar(dt, -2 * pi * f * t);
        }
        CHECK(std::abs(sum - sweep.spectrum(f)) < 1e-5 * std::abs(sum));
    }
}

TEST_CASE("Fades begin and end at nothing and leave the rest alone")
{
    ExponentialSweepOptions options {.sampleRate = 48000.0, .bandLow = 20.0, .bandHigh = 9000.0, .seconds = 2.0};
    const auto plain = ExponentialSweep(options).samples();
    options.fadeIn = 0.2;
    options.fadeOut = 0.05;
    const auto faded = ExponentialSweep(options).samples();
    REQUIRE(faded.size() == plain.size());
    CHECK(peakOf(std::span(faded).first(200)) < 1e-3);
    CHECK(peakOf(std::span(faded).last(20)) < 1e-3);
    double worst = 0.0;
    for (std::size_t n = 9600; n < plain.size() - 2400; ++n)
        worst = std::max(worst, std::abs(plain[n] - faded[n]));
    CHECK(worst == 0.0);
}

TEST_CASE("Sweeps that make no sense are refused with a reason")
{
    const auto no = [](const char* what, auto change) {
        ExponentialSweepOptions o;
        change(o);
        refused(Error::Kind::usage, what, [&] { ExponentialSweep {o}; });
    };
    no("sample rate", [](auto& o) { o.sampleRate = 0; });
    no("higher one", [](auto& o) { o.bandLow = 0; });
    no("higher one", [](auto& o) { o.bandHigh = 10; });
    no("half the sample rate", [](auto& o) { o.bandHigh = 24000; });
    no("peak", [](auto& o) { o.peak = std::nan(""); });
    no("last at least", [](auto& o) { o.seconds = 0.1; });
    no("million", [](auto& o) { o.seconds = 1e6; });
    no("fades", [](auto& o) { o.fadeIn = 6; });
}

TEST_CASE("A convolution is the sum that it says")
{
    std::mt19937_64 draw(5);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    for (const auto& [taps, N] : {std::pair {1, 1}, {3, 10}, {40, 7}, {33, 257}, {0, 4}}) {
        std::vector<double> w(static_cast<std::size_t>(taps)), x(static_cast<std::size_t>(N));
        for (auto* v : {&w, &x})
            for (auto& value : *v)
                value = uniform(draw);
        const auto y = convolved(w, x);
        REQUIRE(y.size() == x.size());
        for (std::size_t n = 0; n < x.size(); ++n) {
            double sum = 0.0;
            for (std::size_t j = 0; j < w.size() && j <= n; ++j)
                sum += w[j] * x[n - j];
            CHECK(y[n] == Approx(sum).margin(1e-13));
        }
    }
    CHECK(convolved({}, {}).empty());
}
