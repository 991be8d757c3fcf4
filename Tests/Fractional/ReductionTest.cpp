// SPDX-License-Identifier: GPL-3.0-or-later
// Smaller models of fractional order, against responses that are written out here by poles and zeros.
#include "Engine/Fractional/FractionalIdentify.h"
#include "Engine/Fractional/FractionalReduction.h"
#include "Engine/Fractional/FractionalStabilization.h"
#include "Engine/Linear/Identify.h"
#include "Engine/Linear/PoleZero.h"
#include "Engine/Linear/RootDistance.h"
#include "Fractional/RandomRoots.h"
#include "Linear/Problem.h"

#include <numbers>

using namespace excursion;
using namespace excursion::test;
using Complex = std::complex<double>;
using std::numbers::pi;

namespace {

Complex byRoots(const PoleZeroGain& g, Complex lambda)
{
    Complex value = g.gain;
    for (const auto& zero : g.zeros)
        value *= lambda - zero;
    for (const auto& pole : g.poles)
        value /= lambda - pole;
    return value;
}

/// Stable poles within the band of 10 Hz to 1 kHz, on the imaginary axis and on either side of it as alpha allows; some
/// remote, some with a zero close by.
PoleZeroGain randomFractional(double alpha, Normal& normal)
{
    PoleZeroGain g;
    g.gain = 3.0;
    const double least = std::pow(2.0 * pi * 10.0, alpha), most = std::pow(2.0 * pi * 1000.0, alpha),
                 border = 0.5 * pi * alpha;
    for (int k = 0; k < 5; ++k) {
        const bool far = k == 4;
        const double size = far ? most * drawn(normal, 30.0, 80.0)
                                : least * std::pow(most / least, drawn(normal, 0.0, 1.0));
        const double angle = k == 0 && alpha < 0.9 ? 0.5 * pi : drawn(normal, border + 0.1 * (pi - border), 0.95 * pi);
        const auto pole = k == 1 ? Complex(-size, 0.0) : std::polar(size, angle);
        addBoth(g.poles, pole);
        const double near = drawn(normal, 0.002, 0.02) * size * std::sin(angle - border);
        if (k == 0 || k == 2)
            addBoth(g.zeros, pole + std::polar(near, 2.0));
    }
    return g;
}

}  // namespace

TEST_CASE("The distance of a root to the rays of a band is that to their points")
{
    Normal normal(3);
    for (int trial = 0; trial < 200; ++trial) {
        const double alpha = drawn(normal, 0.2, 1.8), low = drawn(normal, 0.0, 100.0),
                     high = low + drawn(normal, 10.0, 1000.0);
        const auto root = std::polar(std::pow(2.0 * pi * drawn(normal, 1.0, 1500.0), alpha), drawn(normal, -pi, pi));
        double least = 1e300, most = 0.0;
        const int count = 20000;
        for (int k = 0; k <= count; ++k) {
            const auto point = onRay(low + (high - low) * k / count, alpha);
            for (const auto& p : {point, std::conj(point)}) {
                least = std::min(least, std::abs(p - root));
                most = std::max(most, std::abs(p - root));
            }
        }
        const auto found = distanceToBand(root, 0.0, low, high, alpha);
        INFO("alpha " << alpha << ", band " << low << " to " << high << ", root " << root);
        CHECK(found.most == Approx(most));
        CHECK(found.least <= least * (1.0 + 1e-9));
        CHECK(found.least
              >= least - 2.0 * std::abs(onRay(high, alpha) - onRay(high - (high - low) / count, alpha)) - 1e-3 * most);
    }
}

TEST_CASE(
    "Remote roots and pairs that cancel are taken out of fractional models within the bound, measured along the rays")
{
    Normal normal(7);
    int taken = 0;
    for (const double alpha : {0.4, 0.5, 0.7, 1.0, 1.3})
        for (int trial = 0; trial < 6; ++trial) {
            const auto g = randomFractional(alpha, normal);
            const FractionalStateSpace model {alpha, realize(g)};
            REQUIRE(isStable(model));
            PoleZeroReductionOptions options;
            options.rippleDb = 1.5;
            options.low = 10.0;
            options.high = 1000.0;
            const auto found = reduceByPolesAndZeros(model, options);
            INFO("alpha " << alpha << ", trial " << trial);
            REQUIRE_FALSE(found.steps.empty());
            taken += static_cast<int>(model.form.order() - found.model.form.order());
            double least = 1e300, most = 0.0, error = 0.0;
            for (int k = 0; k <= 1000; ++k) {
                const double f = 10.0 * std::pow(100.0, k / 1000.0);
                const auto ratio = respond(found.model, {f})[0](0, 0) / byRoots(g, onRay(f, alpha));
                least = std::min(least, std::abs(ratio));
                most = std::max(most, std::abs(ratio));
                error = std::max(error, std::abs(ratio - 1.0));
            }
            const auto& last = found.steps.back();
            CHECK(20.0 * std::log10(most / least) <= last.boundDb + 1e-5);
            CHECK(20.0 * std::log10(most / least) == Approx(last.rippleDb).margin(0.01));
            CHECK(last.boundDb <= 1.5);
            CHECK(error <= last.errorBound + 1e-6);
            CHECK(isStable(found.model));
            CHECK(last.order == found.model.form.order());
        }
    CHECK(taken >= 120);  // of 30 models each has a pair, or two, and a remote pole
}

TEST_CASE("A pair on the imaginary axis hides nothing from a model of order one half, and is taken out; at order one "
          "it would resonate")
{
    PoleZeroGain g;
    g.gain = 1.0;
    for (const auto& pole : {Complex(-0.01, 40.0), Complex(-60.0, 10.0)})
        addBoth(g.poles, pole);
    addBoth(g.zeros, Complex(-0.01, 40.5));
    PoleZeroReductionOptions options;
    options.rippleDb = 0.65;
    options.low = 1.0;
    options.high = 2000.0;
    const auto half = reduceByPolesAndZeros(FractionalStateSpace {0.5, realize(g)}, options);
    REQUIRE(half.steps.size() == 1);
    CHECK(half.steps[0].cancelled);
    CHECK(half.model.form.order() == 2);
    // eps_sup = 0.5/distance, which is 40.01 sin 45 degrees
    const double eps = 0.5 / (40.01 * std::sqrt(0.5));
    CHECK(half.steps[0].boundDb == Approx(2.0 * 20.0 * std::log10((1.0 + eps) / (1.0 - eps))).epsilon(1e-4));
    CHECK(reduceByPolesAndZeros(FractionalStateSpace {1.0, realize(g)}, options).steps.empty());
}

TEST_CASE("A fractional model that was pruned by a response keeps what the response shows")
{
    const double alpha = 0.5;
    Normal normal(5);
    const auto truth = [&](double f) {
        const auto l = onRay(f, alpha) / 30.0;
        return 2.0 + 1.0 / (l * l + 0.4 * l + 1.0) + 1.5 * l / (l * l + 2.0 * l + 25.0);
    };
    FrequencyData data;
    data.value.resize(150, 1);
    for (int k = 0; k < 150; ++k) {
        data.frequency.push_back(10.0 * std::pow(2000.0, k / 149.0));
        data.value(k, 0) = truth(data.frequency.back());
    }
    data.deviation = 1e-3 * data.value.cwiseAbs();
    for (Eigen::Index k = 0; k < 150; ++k)
        data.value(k, 0) += data.deviation(k, 0) * std::sqrt(0.5) * Complex(normal(), normal());
    FractionalOptions fitting;
    fitting.order = 8;
    fitting.alpha = alpha;
    const auto large = identifyFractional(data, fitting);
    REQUIRE(large.stable);
    PruningOptions pruning;
    pruning.order = 4;
    const auto small = prune(large.model, data, pruning);
    REQUIRE(small.model.form.order() == 4);
    CHECK(small.steps.back().errorDb < -59.0);  // the noise is at -60 dB
    CHECK(isStable(small.model));
    for (const double f : {12.0, 170.0, 3000.0})
        CHECK(std::abs(respond(small.model, {f})[0](0, 0) - truth(f)) < 2e-3 * std::abs(truth(f)));
}

TEST_CASE("What cannot be reduced is refused in a sentence")
{
    PoleZeroGain g;
    g.gain = 1.0;
    g.poles = {-1.0};
    const FractionalStateSpace model {0.5, realize(g)};
    refused(Error::Kind::usage, "within a band", [&] { reduceByPolesAndZeros(model, {}); });
    refused(Error::Kind::usage, "between 0 and 2", [&] {
        reduceByPolesAndZeros(FractionalStateSpace {2.5, model.form}, {});
    });
    PoleZeroReductionOptions options;
    options.alpha = 0.5;
    auto discrete = model.form;
    discrete.sampleRate = 1000.0;
    refused(Error::Kind::usage, "discrete", [&] { reduceByPolesAndZeros(discrete, options); });
    auto unstable = model;
    unstable.form.A(0, 0) = 1.0;
    refused(Error::Kind::data, "stabilize", [&] { prune(unstable, sampled(model), {}); });
}
