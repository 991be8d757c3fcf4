// SPDX-License-Identifier: GPL-3.0-or-later
// Turning around models without physics: against simulations of the models that share nothing with what plays them.
#include "BlackBox/RandomModels.h"

#include "Engine/BlackBox/BlackBoxSpeaker.h"
#include "Engine/Error.h"
#include "Engine/Signal/Resample.h"

#include <catch2/catch.hpp>

using namespace excursion;

namespace {

constexpr double modelRate = 48000.0;

/// Long enough for the mean of what bends the model to settle, which the linearizer leaves alone, and for the last one
/// to be periodic.
std::vector<double> fourTimes(const std::vector<double>& period)
{
    std::vector<double> signal;
    for (int k = 0; k < 4; ++k)
        signal.insert(signal.end(), period.begin(), period.end());
    return signal;
}

/// Through the predistorter, its delay taken out.
template <class AnyEngine>
std::vector<double> through(AnyEngine& engine, std::vector<double> signal)
{
    const auto latency = static_cast<std::size_t>(engine.latency()), length = signal.size();
    signal.resize(length + latency, 0.0);
    engine.process(signal.data(), signal.data(), signal.size());
    signal.erase(signal.begin(), signal.begin() + static_cast<std::ptrdiff_t>(latency));
    return signal;
}

Eigen::VectorXd vectorOf(const std::vector<double>& v)
{
    return Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size()));
}

const RehearsedBox& oneBox()
{
    static const RehearsedBox box(boxOf(randomPnlss(11, modelRate, pinkStimulus(2.0)), pinkStimulus(2.0)));
    return box;
}

}  // namespace

TEST_CASE("The distortion of random PNLSS models goes down as the rehearsal says", "[predistorter]")
{
    for (const std::uint64_t seed : {21U, 22U, 23U, 24U, 25U, 26U}) {
        const auto stimulus = pinkStimulus(1.5);
        const auto model = randomPnlss(seed, modelRate, stimulus);
        const RehearsedBox box(boxOf(model, stimulus));
        BlackBoxPredistorter predistorter(box, modelRate);
        // A little below the level of the fit, as its peaks are drawn otherwise; the gain does not fall with the level.
        auto u = fourTimes(playedAs(stimulus, modelRate, 16384, 100 + seed));
        for (auto& sample : u)
            sample *= 0.8;
        const auto bent = through(predistorter, u);
        const Eigen::VectorXd straight = simulate(model.linear, vectorOf(u)).col(0);
        const double before = distortionDb(simulate(model, vectorOf(u)).col(0), straight, 16384),
                     after = distortionDb(simulate(model, vectorOf(bent)).col(0), straight, 16384);
        INFO("seed " << seed << ": " << before << " to " << after << " dB; rehearsed " << box.rehearsal.beforeDb
                     << " to " << box.rehearsal.afterDb << ", turned down by "
                     << predistorter.collectMeters().regionReduction);
        CHECK(box.rehearsal.gainDb() > 25.0);
        REQUIRE(box.rehearsal.frequency.size() > 15);
        REQUIRE(box.rehearsal.before.size() == box.rehearsal.frequency.size());
        REQUIRE(box.rehearsal.after.size() == box.rehearsal.frequency.size());
        for (std::size_t k = 0; k < 8; ++k)  // where most of the distortion is
            CHECK(box.rehearsal.after[k] < box.rehearsal.before[k] - 15.0);
        CHECK(before - after > 25.0);
        // As it was told; beyond 30 dB it is a matter of phases and of how far the mean has settled.
        CHECK(before - after > std::min(30.0, box.rehearsal.gainDb() - 5.0));
        CHECK(predistorter.latency() < 250);
    }
}

TEST_CASE("A signal at another rate than the model's is linearized as well", "[predistorter]")
{
    const auto stimulus = pinkStimulus(1.5);
    const auto model = randomPnlss(31, modelRate, stimulus);
    const RehearsedBox box(boxOf(model, stimulus));
    for (const double rate : {96000.0, 192000.0}) {
        const auto factor = static_cast<std::size_t>(rate / modelRate);
        const int period = static_cast<int>(factor) * 16384;
        BlackBoxPredistorter predistorter(box, rate);
        auto u = fourTimes(playedAs(stimulus, rate, period, 7));
        for (auto& sample : u)
            sample *= 0.8;
        const auto bent = through(predistorter, u);
        // All of it lies below half the model's rate, so every second or fourth sample says all.
        std::vector<double> input, driven;
        for (std::size_t k = 0; k < u.size(); k += factor) {
            input.push_back(u[k]);
            driven.push_back(bent[k]);
        }
        const Eigen::VectorXd straight = simulate(model.linear, vectorOf(input)).col(0);
        const double before = distortionDb(simulate(model, vectorOf(input)).col(0), straight, 16384),
                     after = distortionDb(simulate(model, vectorOf(driven)).col(0), straight, 16384);
        INFO(rate << " Hz: " << before << " to " << after << " dB");
        CHECK(before - after > 25.0);
    }
}

TEST_CASE("The output does not depend on how a signal is cut into blocks", "[predistorter]")
{
    std::mt19937_64 random(5);
    for (const double rate : {48000.0, 44100.0}) {
        const auto u = playedAs(pinkStimulus(2.5), rate, 16384, 3);
        BlackBoxPredistorter whole(oneBox(), rate), cut(oneBox(), rate);
        BlackBoxSpeaker speaker(oneBox().box, oneBox().region, oneBox().rest, rate),
            cutSpeaker(oneBox().box, oneBox().region, oneBox().rest, rate);
        std::vector<double> a(u.size()), b(u.size()), c(u.size()), d(u.size());
        whole.process(u.data(), a.data(), u.size());
        speaker.process(u.data(), c.data(), u.size());
        for (std::size_t n = 0; n < u.size();) {
            const std::size_t count = std::min<std::size_t>(1 + random() % 300, u.size() - n);
            cut.process(u.data() + n, b.data() + n, count);
            cutSpeaker.process(u.data() + n, d.data() + n, count);
            n += count;
        }
        CHECK(a == b);
        CHECK(c == d);
        // As if new after reset()
        whole.reset();
        whole.process(u.data(), b.data(), u.size());
        CHECK(a == b);
    }
}

TEST_CASE("Switched off, the samples come out as they are", "[predistorter]")
{
    for (const double rate : {48000.0, 44100.0, 96000.0}) {
        auto u = playedAs(pinkStimulus(20.0), rate, 16384, 4);  // far beyond the fit
        BlackBoxPredistorter predistorter(oneBox(), rate);
        predistorter.turn(false);
        predistorter.reset();
        CHECK(through(predistorter, u) == u);
    }
}

TEST_CASE("Switched off the model stands still; switched on again it corrects as if it never had, without a step",
          "[predistorter]")
{
    for (const double rate : {48000.0, 44100.0}) {
        const auto period = playedAs(pinkStimulus(2.0), rate, 16384, 4);
        const std::size_t block = 128, off = 200 * block, on = 600 * block, end = 1200 * block;
        BlackBoxPredistorter always(oneBox(), rate), switched(oneBox(), rate);
        std::vector<double> u(end), a(end), b(end);
        for (std::size_t n = 0; n < end; ++n)
            u[n] = 0.9 * period[n % period.size()];
        always.process(u.data(), a.data(), end);
        for (std::size_t n = 0; n < end; n += block) {
            if (n == off || n == on)
                switched.turn(n == on);
            switched.process(u.data() + n, b.data() + n, block);
        }
        const auto late = static_cast<std::size_t>(switched.latency());
        for (std::size_t n = off + 200 * block; n < on; ++n)
            REQUIRE(b[n] == u[n - late]);
        double before = 0.0, apart = 0.0, bends = 0.0, bent = 0.0;
        for (std::size_t n = off; n < end; ++n) {
            const auto correction = [&](const std::vector<double>& of, std::size_t k) { return of[k] - u[k - late]; };
            bends = std::max(bends, std::abs(correction(a, n) - correction(a, n - 1)));
            bent = std::max(bent, std::abs(correction(b, n) - correction(b, n - 1)));
            if (n >= on + static_cast<std::size_t>(rate)) {
                before += correction(a, n) * correction(a, n);
                apart += (b[n] - a[n]) * (b[n] - a[n]);
            }
        }
        INFO(rate << " Hz: " << decibelsOf(apart / before) << " dB, " << bends << " and " << bent << " a sample");
        CHECK(before > 0.0);
        CHECK(decibelsOf(apart / before) < -40.0);
        CHECK(bent < 1.5 * bends);
    }
}

TEST_CASE("Switched on after it was reset, the model hears the signal for 0.1 s before it corrects", "[predistorter]")
{
    for (const double rate : {48000.0, 44100.0}) {
        const auto period = playedAs(pinkStimulus(2.0), rate, 16384, 4);
        std::vector<double> u(static_cast<std::size_t>(0.4 * rate));
        for (std::size_t n = 0; n < u.size(); ++n)
            u[n] = 0.9 * period[(5000 + n) % period.size()];
        BlackBoxPredistorter predistorter(oneBox(), rate);
        predistorter.turn(false);
        predistorter.reset();
        predistorter.turn(true);
        std::vector<double> out(u.size());
        predistorter.process(u.data(), out.data(), u.size());
        const auto late = static_cast<std::size_t>(predistorter.latency()),
                   heard = static_cast<std::size_t>(0.1 * rate);
        for (std::size_t n = late; n < heard; ++n)
            REQUIRE(out[n] == u[n - late]);
        double correction = 0.0;
        for (std::size_t n = 3 * heard; n < u.size(); ++n)
            correction = std::max(correction, std::abs(out[n] - u[n - late]));
        CHECK(correction > 0.0);
    }
}

TEST_CASE("What is no number, and what no fit has seen, stays in bounds", "[predistorter]")
{
    const auto& stimulus = oneBox().box.stimulus;
    const double bound = stimulus.peak + std::max(1.5 * oneBox().rehearsal.correction, 0.5 * stimulus.peak);
    auto u = fourTimes(playedAs(stimulus, modelRate, 16384, 6));
    const auto plain = u;
    u[5000] = std::numeric_limits<double>::quiet_NaN();
    u[5001] = std::numeric_limits<double>::infinity();
    u[5100] = 1e300;
    BlackBoxPredistorter predistorter(oneBox(), modelRate), untouched(oneBox(), modelRate);
    const auto bent = through(predistorter, u), right = through(untouched, plain);
    double largest = 0.0, step = 0.0, usual = 0.0;
    for (std::size_t k = 1; k < bent.size(); ++k) {
        REQUIRE(std::isfinite(bent[k]));
        largest = std::max(largest, std::abs(bent[k]));
        step = std::max(step, std::abs(bent[k] - bent[k - 1]));
        usual = std::max(usual, std::abs(right[k] - right[k - 1]));
    }
    CHECK(largest <= bound);
    CHECK(step < 1.2 * usual);  // no click
    // Silence, before the fade begins at 7500, but for what the slow poles of the mean leave: -58 dB of the fit's
    // level.
    CHECK(std::abs(bent[7400]) < 2e-3 * stimulus.rms);
    CHECK(predistorter.collectMeters().faults == 3);
    double left = 0.0;
    for (std::size_t k = 40000; k < bent.size(); ++k)
        left = std::max(left, std::abs(bent[k] - right[k]));
    CHECK(left < 1e-3 * stimulus.rms);  // it has recovered

    // A low tone at twenty times the peak of the fit, which sets in at once, then noise of the same size
    std::mt19937_64 random(8);
    std::normal_distribution<double> normal;
    std::vector<double> loud(96000);
    for (std::size_t k = 0; k < loud.size(); ++k)
        loud[k] = 20.0 * stimulus.peak
                  * (k < 48000 ? std::sin(2.0 * std::numbers::pi * 25.0 * static_cast<double>(k) / modelRate)
                               : normal(random));
    predistorter.reset();
    predistorter.collectMeters();
    for (const double sample : through(predistorter, loud)) {
        REQUIRE(std::isfinite(sample));
        REQUIRE(std::abs(sample) <= bound);
    }
    const auto meters = predistorter.collectMeters();
    CHECK(meters.regionReduction > 20.0);
    CHECK(meters.region < 2.0);
}

TEST_CASE("The speaker plays as the model is simulated, and never runs away", "[speaker]")
{
    const auto stimulus = pinkStimulus(2.0);
    const auto model = randomPnlss(11, modelRate, stimulus);
    auto u = fourTimes(playedAs(stimulus, modelRate, 16384, 9));
    for (auto& sample : u)
        sample *= 0.7;
    BlackBoxSpeaker speaker(oneBox().box, oneBox().region, oneBox().rest, modelRate);
    const Eigen::VectorXd truth = simulate(model, vectorOf(u)).col(0), played = vectorOf(through(speaker, u));
    CHECK(decibelsOf((played - truth).squaredNorm() / truth.squaredNorm()) < -150.0);

    BlackBoxSpeaker late(oneBox().box, oneBox().region, oneBox().rest, 2.0 * modelRate);
    const auto fast = upsample(u, 2);
    const auto fastPlayed = through(late, fast);
    Eigen::VectorXd every(static_cast<Eigen::Index>(u.size()));
    for (Eigen::Index k = 0; k < every.size(); ++k)
        every[k] = fastPlayed[2 * static_cast<std::size_t>(k)];
    const Eigen::Index judged = 16000;
    CHECK(decibelsOf((every - truth).segment(8000, judged).squaredNorm() / truth.segment(8000, judged).squaredNorm())
          < -60.0);

    // The linear part alone is left of a loud signal, plus what is bounded.
    std::vector<double> loud(48000);
    for (std::size_t k = 0; k < loud.size(); ++k)
        loud[k] = 500.0 * stimulus.peak * std::sin(2.0 * std::numbers::pi * 40.0 * static_cast<double>(k) / modelRate);
    speaker.reset();
    const auto out = through(speaker, loud);
    const Eigen::VectorXd straight = simulate(model.linear, vectorOf(loud)).col(0);
    CHECK(vectorOf(out).allFinite());
    CHECK((vectorOf(out) - straight).cwiseAbs().maxCoeff() < 0.1 * straight.cwiseAbs().maxCoeff());
    speaker.setLinearShareRemoved(1.0);
    speaker.reset();
    CHECK(
        decibelsOf((vectorOf(through(speaker, u)) - (truth - simulate(model.linear, vectorOf(u)).col(0))).squaredNorm()
                   / truth.squaredNorm())
        < -150.0);
}

TEST_CASE("A model that cannot be inverted is refused in a sentence", "[predistorter]")
{
    const auto stimulus = pinkStimulus(2.0);
    CHECK_THROWS_AS(RehearsedBox(boxOf(oneWay(modelRate, stimulus), stimulus)), Error);

    auto unstable = randomPnlss(13, modelRate, stimulus);
    unstable.linear.A *= 1.2;
    std::string reason;
    CHECK_FALSE(boxOf(unstable, stimulus).isValid(&reason));
    CHECK(reason == "its linear part is not stable");
}
