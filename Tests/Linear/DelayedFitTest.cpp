// SPDX-License-Identifier: GPL-3.0-or-later
// A delay of part of a sample, found together with a stable model.
#include "Engine/Linear/DelayedFit.h"
#include "Engine/Linear/Identify.h"
#include "Engine/Linear/Stabilization.h"
#include "Linear/Problem.h"

#include <cmath>
#include <numbers>

using namespace excursion;
using namespace excursion::test;
using Complex = std::complex<double>;

namespace {

constexpr double rate = 8000.0;

/// Two resonances and a direct term: order 4.
Complex truthAt(double f)
{
    const Complex s(0.0, 2.0 * std::numbers::pi * f);
    const Complex a(-200.0, 1500.0), b(-500.0, 9000.0);
    return 0.3 + 300.0 / (s - a) + 300.0 / (s - std::conj(a)) + Complex(80.0, 400.0) / (s - b)
           + Complex(80.0, -400.0) / (s - std::conj(b));
}

/// Measured `lag` seconds late, with noise of a share of the response's rms.
FrequencyData late(double lag, double share, std::uint64_t seed)
{
    Normal normal(seed);
    FrequencyData data;
    data.value.resize(200, 1);
    for (int k = 0; k < 200; ++k) {
        const double f = 20.0 * (k + 1) - 5.0;
        data.frequency.push_back(f);
        data.value(k, 0) = truthAt(f) * std::polar(1.0, -2.0 * std::numbers::pi * f * lag);
    }
    const double deviation = share * data.value.norm() / std::sqrt(200.0);
    if (share > 0.0) {
        data.deviation = Eigen::MatrixXd::Constant(200, 1, deviation);
        for (auto& g : data.value.reshaped())
            g += deviation * Complex(normal(), normal()) / std::numbers::sqrt2;
    }
    return data;
}

}  // namespace

TEST_CASE("The delay of exact data is found to many digits, whichever way it goes")
{
    for (const double samples : {0.37, -0.6427, 2.5}) {
        const double lag = samples / rate;
        DelayedFitOptions options;
        const auto found = fitDelayed(late(lag, 0.0, 1), options);
        INFO(samples << " samples: " << -found.delay * rate << ", " << found.message << " after " << found.iterations
                     << ", cost " << found.fit.cost);
        CHECK(found.converged());
        CHECK_FALSE(found.atEdge);
        CHECK(std::abs(found.delay + lag) * rate < 1e-6);
        CHECK(isStable(found.fit.sections));
        CHECK(found.scanned.size() == 33);
    }
}

TEST_CASE("With noise the delay lies where its standard error says", "[slow]")
{
    const double lag = 0.37 / rate;
    double squares = 0.0, sum = 0.0, deviations = 0.0;
    const int trials = 40;
    for (int seed = 1; seed <= trials; ++seed) {
        DelayedFitOptions options;
        options.scan = 9;
        options.least = -2.0 / rate;
        options.most = 1.0 / rate;
        const auto found = fitDelayed(late(lag, 0.02, static_cast<std::uint64_t>(seed)), options);
        REQUIRE(found.converged());
        const double error = (found.delay + lag) / found.standardError;
        CHECK(std::abs(error) < 4.0);
        squares += error * error;
        sum += error;
        deviations += found.standardError * rate / trials;
    }
    INFO("rms " << std::sqrt(squares / trials) << ", mean " << sum / trials << ", standard error " << deviations
                << " samples");
    // Of 40 normal numbers the rms lies within 1 +- 0.33, the mean within +- 0.47, with 99.7 %.
    CHECK(std::abs(std::sqrt(squares / trials) - 1.0) < 0.33);
    CHECK(std::abs(sum / trials) < 0.47);
    CHECK(deviations < 0.002);
}

TEST_CASE("A lead that makes the free fit unstable is taken back by the delay, and the error falls to the noise",
          "[slow]")
{
    // The output was recorded 0.6427 samples early, as in [B 6.2.4].
    const auto data = late(-0.6427 / rate, 0.01, 3);
    IdentifyOptions free;
    free.order = 6;
    free.refinement.stable = false;
    const auto unstable = identify(data, free);
    IdentifyOptions bound = free;
    bound.order = 4;
    bound.refinement.stable = true;
    const auto stable = identify(data, bound);
    DelayedFitOptions options;
    const auto found = fitDelayed(data, options);
    INFO("free order 6 " << unstable.errorDb << " dB, stable " << unstable.stable << "; order 4 " << stable.errorDb
                         << " dB; with delay " << 10.0 * std::log10(found.fit.cost) << " dB at " << found.delay * rate
                         << " samples");
    CHECK(std::abs(found.delay * rate - 0.6427) < 4.0 * found.standardError * rate);
    CHECK(found.standardError * rate < 0.002);
    CHECK(10.0 * std::log10(found.fit.cost) < -39.5);
    CHECK(stable.errorDb > -35.0);

    // Stabilized by its delay the free model keeps its order.
    StabilizeOptions byDelay;
    byDelay.method = StabilizingMethod::delay;
    const auto stabilization = stabilized(unstable.model, data, byDelay);
    INFO("order 6: " << stabilization.steps[1].errorDb << " dB at " << stabilization.delay * rate << " +- "
                     << *stabilization.delayStandardError * rate << " samples, " << stabilization.reason);
    REQUIRE(stabilization.steps.size() == 2);
    CHECK_FALSE(stabilization.steps[0].stable);
    CHECK(stabilization.steps[1].stable);
    CHECK(stabilization.steps[1].errorDb < -39.5);
    CHECK(stabilization.model.order() == 6);
    CHECK(isStable(stabilization.model));
    CHECK(judged(stabilization.model, delayed(data, stabilization.delay)).errorDb
          == Approx(stabilization.steps[1].errorDb));
    byDelay.seconds = 0.6427 / rate;
    const auto given = stabilized(unstable.model, data, byDelay);
    CHECK(given.delay == 0.6427 / rate);
    CHECK(given.steps[1].errorDb < -39.5);
    CHECK_FALSE(given.delayStandardError);
}

TEST_CASE("fitAtDelay takes the delay it is given, and senseless options are refused")
{
    const auto data = late(0.5 / rate, 0.0, 1);
    DelayedFitOptions options;
    const auto found = fitAtDelay(data, -0.5 / rate, options);
    CHECK(found.delay == -0.5 / rate);
    CHECK(found.fit.cost < 1e-20);
    const auto back = delayed(delayed(data, 1e-4), -1e-4);
    CHECK((back.value - data.value).norm() < 1e-14 * data.value.norm());
    // A response late by 1 ms, looked for within 0.1 ms: the lowest cost is at the end.
    DelayedFitOptions narrow;
    narrow.scan = 5;
    for (const double reach : {1e-4, 7.3e-5, 9.1e-5}) {
        narrow.least = -reach;
        narrow.most = reach;
        const auto edge = fitDelayed(late(1e-3, 0.0, 1), narrow);
        INFO(reach);
        CHECK(edge.atEdge);
        CHECK(edge.termination == Termination::atBound);
        CHECK(edge.delay == -reach);
    }
    narrow.most = -1e-3;
    refused(Error::Kind::usage, "range", [&] { fitDelayed(data, narrow); });
    narrow = {};
    narrow.scan = 3;
    CHECK(narrow.isValid());
    narrow.scan = 1000;
    CHECK(narrow.isValid());
    narrow.scan = 2;
    refused(Error::Kind::usage, "first look", [&] { fitDelayed(data, narrow); });
    auto two = data;
    two.inputs = 2;
    two.value.conservativeResize(200, 2);
    two.value.col(1) = two.value.col(0);
    refused(Error::Kind::data, "one input", [&] { fitDelayed(two, options); });
}
