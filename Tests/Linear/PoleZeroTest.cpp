// SPDX-License-Identifier: GPL-3.0-or-later
// Poles, zeros and gain, and models made smaller by taking some of them out within a bound.
#include "Engine/Linear/PoleZero.h"
#include "Engine/Linear/PoleZeroReduction.h"
#include "Engine/Linear/Response.h"
#include "Engine/Linear/RootDistance.h"
#include "Linear/Problem.h"

#include <cmath>
#include <numbers>

using namespace excursion;
using namespace excursion::test;
using Complex = std::complex<double>;

namespace {

using std::numbers::pi;

double uniform(Normal& normal, double least, double most)
{
    return least + (most - least) * 0.5 * std::erfc(-normal() / std::numbers::sqrt2);
}

void addRoot(std::vector<Complex>& roots, Complex root)
{
    roots.push_back(root);
    if (root.imag() != 0.0)
        roots.push_back(std::conj(root));
}

/// A random root as lambda: near the axis, remote on either side, real or one of a pair.
Complex randomRoot(double rate, Normal& normal, bool real)
{
    const double kind = uniform(normal, 0.0, 3.0);
    if (rate == 0.0) {
        const double size = std::exp(uniform(normal, std::log(10.0), std::log(kind < 1.0 ? 1e5 : 3000.0)));
        return real ? Complex(-size, 0.0) : std::polar(size, uniform(normal, 0.51, 0.95) * pi);
    }
    const double radius = kind < 1.0   ? uniform(normal, 0.02, 0.4)
                          : kind < 2.0 ? uniform(normal, 0.6, 0.98)
                                       : uniform(normal, 2.0, 20.0);
    return real ? Complex(uniform(normal, 0.0, 1.0) < 0.5 ? -radius - 1.0 : radius - 1.0, 0.0)
                : std::polar(radius, uniform(normal, 0.05, 0.95) * pi) - 1.0;
}

/// Poles, and zeros: some of them close to a pole, no more than poles.
PoleZeroGain randomSystem(double rate, Normal& normal)
{
    PoleZeroGain g;
    g.sampleRate = rate;
    g.gain = 2.5;
    for (int k = 0; k < 4; ++k) {
        const bool real = k == 0 || uniform(normal, 0.0, 1.0) < 0.3;
        const auto pole = randomRoot(rate, normal, real);
        addRoot(g.poles, pole);
        const double what = uniform(normal, 0.0, 3.0);
        if (what < 1.0)
            continue;
        const double near = (rate == 0.0 ? std::abs(pole.real()) : std::abs(1.0 - std::abs(1.0 + pole)))
                            * uniform(normal, 0.001, 0.1);
        addRoot(g.zeros, what < 2.0 ? randomRoot(rate, normal, real)
                         : real     ? pole + near
                                    : pole + std::polar(near, 1.0));
    }
    return g;
}

}  // namespace

TEST_CASE("A chain of sections answers as its poles and zeros say, and they are found again")
{
    Normal normal(11);
    for (const double rate : {0.0, 48000.0})
        for (int trial = 0; trial < 30; ++trial) {
            const auto g = randomSystem(rate, normal);
            const auto model = realize(g);
            REQUIRE(model.isValid());
            REQUIRE(model.order() == static_cast<Eigen::Index>(g.poles.size()));
            const auto found = poleZeroGainOf(model);
            CHECK(found.poles.size() == g.poles.size());
            double largest = 0.0;
            for (int k = 0; k < 1000; ++k)
                largest = std::max(largest, std::abs(respond(g, 24.0 * k)));
            for (const double f : {0.0, 3.0, 50.0, 700.0, 9000.0, 24000.0}) {
                Complex expected = g.gain;  // not by the code under test
                const Complex lambda = rate == 0.0 ? Complex(0.0, 2.0 * pi * f)
                                                   : std::polar(1.0, 2.0 * pi * f / rate) - 1.0;
                for (const auto& zero : g.zeros)
                    expected *= lambda - zero;
                for (const auto& pole : g.poles)
                    expected /= lambda - pole;
                CHECK(std::abs(respond(g, f) - expected) <= 1e-12 * std::abs(expected));
                CHECK(std::abs(respond(model, {f})[0](0, 0) - expected) <= 1e-9 * largest);
                CHECK(std::abs(respond(found, f) - expected) <= 2e-6 * largest);
            }
        }
    PoleZeroGain improper;
    improper.poles = {-1.0};
    improper.zeros = {-2.0, -3.0};
    refused(Error::Kind::usage, "more zeros than poles", [&] { realize(improper); });
    auto two = realize(randomSystem(0.0, normal));
    two.C.conservativeResize(2, Eigen::NoChange);
    two.C.row(1) = two.C.row(0);
    two.D = Eigen::MatrixXd::Zero(2, 1);
    refused(Error::Kind::usage, "one input and one output", [&] { poleZeroGainOf(two); });
    auto silent = realize(randomSystem(0.0, normal));
    silent.C.setZero();
    silent.D.setZero();
    refused(Error::Kind::data, "zero", [&] { poleZeroGainOf(silent); });
}

TEST_CASE("A model without zeros has none that matter")
{
    PoleZeroGain g;
    g.gain = 2.5;
    for (const Complex pole :
         {Complex(-15.0481, 0), Complex(-14.7453, 23.0581), Complex(-33.424, 30.1889), Complex(-976.946, 896.799)})
        addRoot(g.poles, pole);
    for (const auto& zero : zeros(realize(g)))
        CHECK(std::abs(zero) > 1e4);  // from infinity, by rounding
    for (const auto& zero : poleZeroGainOf(realize(g)).zeros)
        CHECK(std::abs(zero) > 1e4);
}

TEST_CASE("Ripples are those of the seed: 6 dB for a root of size 1/3 or 3, and within a band no more")
{
    for (const double radius : {1.0 / 3.0, 3.0}) {
        const auto whole = distanceToBand(std::polar(radius, 1.1) - 1.0, 1.0, 0.0, 0.5);
        CHECK(whole.least == Approx(std::abs(1.0 - radius)));
        CHECK(whole.most == Approx(1.0 + radius));
        CHECK(20.0 * std::log10(whole.most / whole.least) == Approx(20.0 * std::log10(2.0)));  // 6.02 dB
    }
    // Against a search over the band.
    Normal normal(12);
    for (const double rate : {0.0, 100.0})
        for (int trial = 0; trial < 100; ++trial) {
            const auto root = randomRoot(rate, normal, trial % 2 == 0) * (rate == 0.0 ? 0.01 : 1.0);
            const double low = uniform(normal, 0.0, 20.0), high = low + uniform(normal, 1.0, 30.0);
            const auto found = distanceToBand(root, rate, low, high);
            double least = 1e300, most = 0.0;
            for (int k = -4000; k <= 4000; ++k) {
                const double f = (low + (high - low) * std::abs(k) / 4000.0) * (k < 0 ? -1.0 : 1.0);
                const double d = std::abs(evaluationPoint(f, rate) - root);
                least = std::min(least, d);
                most = std::max(most, d);
            }
            CHECK(found.least <= least * (1.0 + 1e-12));
            CHECK(found.most >= most * (1.0 - 1e-12));
            CHECK(found.least > least - 0.03 * (rate == 0.0 ? 2.0 * pi : 1.0));
            CHECK(found.most < most * (1.0 + 1e-3));
        }
}

TEST_CASE("What a reduction by poles and zeros changes never exceeds its bound")
{
    Normal normal(13);
    int refusals = 0, removed = 0, cancelled = 0, complex = 0, delays = 0;
    double tightest = 0.0;
    for (const double rate : {0.0, 48000.0})
        for (int trial = 0; trial < 150; ++trial) {
            const auto g = randomSystem(rate, normal);
            const auto model = realize(g);
            PoleZeroReductionOptions options;
            options.rippleDb = uniform(normal, 0.5, 12.0);
            if (rate == 0.0) {
                options.low = trial % 2 ? 0.0 : 10.0;
                options.high = 2000.0;
            } else if (trial % 3 == 0) {
                options.low = 100.0;
                options.high = 12000.0;
            }
            PoleZeroReduction found;
            try {
                found = reduceByPolesAndZeros(model, options);
            } catch (const Error& e) {  // the band lies so far below the peak that the roots do not tell it
                CHECK(e.kind() == Error::Kind::numerical);
                ++refusals;
                continue;
            }
            auto order = model.order();
            for (const auto& step : found.steps) {
                CHECK(step.boundDb <= options.rippleDb);
                CHECK(step.rippleDb <= step.boundDb * (1.0 + 1e-9) + 1e-8);
                CHECK(step.error <= step.errorBound + 1e-6);
                CHECK(step.order == order - static_cast<Eigen::Index>(step.poles.size()));
                order = step.order;
                removed += !step.cancelled;
                cancelled += step.cancelled;
                complex += step.poles.front().imag() != 0.0;
                tightest = std::max(tightest, step.rippleDb / std::max(step.boundDb, 1e-3));
            }
            CHECK(found.model.order() == order);
            if (found.steps.empty())
                continue;
            delays += found.delay != 0.0;
            // Measured again, elsewhere than on the reduction's own grid, and against the system as it was drawn.
            double least = 1e300, most = 0.0;
            const double high = options.high == 0.0 ? 0.5 * rate : options.high;
            for (int k = 0; k <= 700; ++k) {
                const double f = options.low + (high - options.low) * k / 700.0;
                const double ratio = std::abs(respond(found.model, {f})[0](0, 0) / respond(g, f));
                least = std::min(least, ratio);
                most = std::max(most, ratio);
            }
            CHECK(20.0 * std::log10(most / least) <= found.steps.back().boundDb + 1e-6);
        }
    INFO(removed << " remote, " << cancelled << " cancelled, " << complex << " of them pairs, " << delays
                 << " with a delay, " << refusals << " refused; tightest " << tightest);
    CHECK(refusals <= 6);  // of 300
    CHECK(removed > 30);
    CHECK(cancelled > 30);
    CHECK(complex > 30);
    CHECK(delays > 5);
    CHECK(tightest > 0.7);  // the bound is no idle one
}

TEST_CASE("The seed's pair of 0.8 and 0.79 is bounded by 0.87 dB and ripples by less")
{
    PoleZeroGain g;
    g.sampleRate = 1.0;
    g.gain = 1.0;
    g.poles = {Complex(0.5, 0.7) - 1.0, Complex(0.5, -0.7) - 1.0, 0.8 - 1.0};
    g.zeros = {0.79 - 1.0};
    PoleZeroReductionOptions options;
    options.remote = false;
    const auto found = reduceByPolesAndZeros(realize(g), options);
    REQUIRE(found.steps.size() == 1);
    CHECK(found.steps[0].cancelled);
    CHECK(found.steps[0].boundDb == Approx(20.0 * std::log10(1.05 / 0.95)));  // 0.869 dB
    // (z - 0.79)/(z - 0.8) is 0.21/0.2 at z = 1 and 1.79/1.8 at z = -1
    CHECK(found.steps[0].rippleDb == Approx(20.0 * std::log10(1.05 / (1.79 / 1.8))));
    CHECK(found.steps[0].errorBound == Approx(1.0 / 0.95 - 1.0));
    CHECK(found.model.order() == 2);
    CHECK(found.reason == "no pole is left that could go");
    CHECK(found.delay == 0.0);

    PoleZeroReductionOptions none;
    none.rippleDb = 0.5;
    CHECK(reduceByPolesAndZeros(realize(g), none).steps.empty());
    CHECK(reduceByPolesAndZeros(realize(g), none).reason == "the next step would pass the bound of the ripple");
}

TEST_CASE("A remote pole leaves a sample of delay behind, and bad options are refused")
{
    PoleZeroGain g;
    g.sampleRate = 100.0;
    g.gain = 1.0;
    g.poles = {0.9 - 1.0, 0.05 - 1.0};
    const auto found = reduceByPolesAndZeros(realize(g), {});
    REQUIRE(found.steps.size() == 1);
    CHECK(found.delay == Approx(-0.01));
    CHECK(found.steps[0].boundDb == Approx(20.0 * std::log10(1.05 / 0.95)));
    CHECK(found.steps[0].rippleDb == Approx(20.0 * std::log10(1.05 / 0.95)));
    CHECK(found.steps[0].error == Approx(0.05));
    CHECK(found.model.order() == 1);
    PoleZeroReductionOptions options;
    refused(Error::Kind::usage, "within a band", [&] {
        reduceByPolesAndZeros(realize(PoleZeroGain {{-1.0}, {}, 1.0, 0.0}), options);
    });
    options.high = 60.0;
    refused(Error::Kind::usage, "half the sample rate", [&] { reduceByPolesAndZeros(realize(g), options); });
    options.low = 70.0;
    refused(Error::Kind::usage, "band must begin", [&] { reduceByPolesAndZeros(realize(g), options); });
    options = {};
    options.rippleDb = -1.0;
    refused(Error::Kind::usage, "ripple", [&] { reduceByPolesAndZeros(realize(g), options); });
}
