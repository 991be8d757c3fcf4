// SPDX-License-Identifier: GPL-3.0-or-later
// Models without physics in the plugin, measured by what leaves it: against each class' own simulation.
#include "BlackBox/EveryClass.h"

#include "Engine/BlackBox/ModelDocument.h"
#include "Engine/Error.h"
#include "Engine/Linear/StateSpaceFile.h"
#include "Engine/Signal/Fft.h"
#include "Engine/Signal/Level.h"
#include "Plugin/PlayedBoxes.h"
#include "Plugin/Processor.h"
#include "Plugin/Walk.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <thread>

using namespace excursion;
using namespace excursion::test;
using plugin::Processor;

namespace {

/// What the class itself makes of it, in the output's unit, and its linear part of that.
Eigen::VectorXd simulated(const plugin::LoadedBox& box, const std::vector<double>& volts)
{
    const nlohmann::json document(box.document);
    const auto model = modelDocumentFrom(JsonField(document, "", "a test"));
    return simulate(model, Eigen::Map<const Eigen::VectorXd>(volts.data(), static_cast<Eigen::Index>(volts.size())),
                    model.sampleRate)
        .col(0);
}

}  // namespace

TEST_CASE("Every class of models is played by the plugin as its own simulation has it", "[plugin][blackbox]")
{
    for (const auto& box : boxes()) {
        Processor processor;
        roomy(processor);
        setMode(processor, Mode::speaker);
        processor.prepareToPlay(rate, 512);
        processor.setModel(box);
        processor.prepareToPlay(rate, 512);  // as a host does when the latency is another
        const auto volts = noise(box->played.box.stimulus, 0.7, rate);
        const auto out = vectorOf(through(processor, volts));
        const Eigen::VectorXd truth = box->played.perOutput * simulated(*box, volts);
        const double error = errorDb(out.tail(16384), truth.tail(16384));
        INFO(box->played.box.kind << ": " << error << " dB");
        CHECK(error < (box->played.box.kind == "powers of the input through filters" ? -55.0 : -95.0));
        // As loud as the signal
        CHECK(decibelsOf(variance(out.tail(16384)) / variance(vectorOf(volts).tail(16384))) == Approx(0.0).margin(3.0));
    }
}

TEST_CASE("A model without physics is inverted by the plugin, with the gain that was told before", "[plugin][blackbox]")
{
    int turned = 0;
    for (const auto& box : boxes()) {
        INFO(box->played.box.kind << ": " << wordsOf(box->played));
        REQUIRE((box->played.rehearsal || !box->played.refusal.empty()));
        if (!box->played.rehearsal)
            continue;
        ++turned;
        Processor processor;
        roomy(processor);
        setMode(processor, Mode::linearize);
        processor.setModel(box);
        processor.prepareToPlay(rate, 512);
        const auto volts = noise(box->played.box.stimulus, 0.6, rate, 105, 8);
        for (const int channel : {0, 1}) {
            processor.reset();
            const auto bent = through(processor, volts, 512, channel);
            auto plain = box->played.box;
            plain.R.setZero();
            const Eigen::VectorXd straight = simulate(plain, vectorOf(volts));
            const double before = distortionDb(simulated(*box, volts), straight, 16384),
                         after = distortionDb(simulated(*box, bent), straight, 16384);
            const auto meters = processor.collectMeters();
            INFO("from " << before << " to " << after << " dB, turned down by " << meters.displacementReduction << ", "
                         << meters.region);
            CHECK(meters.displacementReduction == 0.0);
            // A quieter signal is bent less, and then there is less to gain.
            CHECK(before - after > box->played.rehearsal->gainDb() - 3.0);
        }
    }
    CHECK(turned == 5);
}

TEST_CASE("The plugin's audition has less distortion than its speaker, at rates that are not the model's",
          "[plugin][blackbox]")
{
    const auto& box = boxes().front();
    for (const double sampleRate : {44100.0, 48000.0, 96000.0}) {
        double left[2] {};
        Processor processor;
        roomy(processor);
        processor.setModel(box);
        processor.prepareToPlay(sampleRate, 512);
        const int period = sampleRate > 90000.0 ? 32768 : 16384;
        std::vector<int> lines;
        auto one = playedAs(box->played.box.stimulus, sampleRate, period, 9, &lines);
        std::vector<double> volts;
        for (int k = 0; k < 6; ++k)
            for (const double sample : one)
                volts.push_back(0.8 * sample);
        for (const auto mode : {Mode::speaker, Mode::audition}) {
            setMode(processor, mode);
            processor.reset();
            const auto out = through(processor, volts);
            const std::vector<double> last(out.end() - period, out.end());
            const auto spectrum = fft(last);
            double all = 0.0, silent = 0.0;
            const auto end = static_cast<std::size_t>(3000.0 * period / sampleRate);
            for (std::size_t k = 5; k < end; ++k) {
                const double power = std::norm(spectrum[k]);
                all += power;
                if (!std::binary_search(lines.begin(), lines.end(), static_cast<int>(k)))
                    silent += power;
            }
            left[mode == Mode::audition ? 1 : 0] = decibelsOf(silent / all);
        }
        INFO(sampleRate << " Hz: " << left[0] << " to " << left[1] << " dB");
        CHECK(left[0] > -45.0);
        CHECK(left[1] < left[0] - 20.0);
    }
}

TEST_CASE("A model of the excursion keeps excursion, voltage and heat within their limits, played by its own class",
          "[plugin][blackbox][protection]")
{
    for (const auto& box : boxes()) {
        const auto& played = box->played;
        if (!played.rehearsal)
            continue;
        const double range = measuredDisplacement(played), ohms = 6.0;
        Processor processor;
        auto recipe = processor.parameters().recipe();
        recipe.mode = Mode::linearize;
        recipe.fullScale = 4.0 * played.box.stimulus.peak;
        recipe.displacementLimit = 0.5;
        recipe.voltageLimit = 0.8 * played.box.stimulus.peak;
        recipe.powerLimit = 0.2 * played.box.stimulus.rms * played.box.stimulus.rms / ohms;
        recipe.coilResistance = ohms;
        processor.parameters().set(recipe);
        processor.setModel(box);
        processor.prepareToPlay(rate, 512);
        auto volts = noise(played.box.stimulus, 1.0, rate, 8, 6);
        for (std::size_t n = 0; n < volts.size(); ++n)
            volts[n] = std::clamp(3.0 * volts[n] * (n % 20000 < 10000 ? 0.2 : 1.0), -recipe.fullScale,
                                  recipe.fullScale);
        const auto out = through(processor, volts);
        const auto y = simulated(*box, out);
        double heat = 0.0, warmest = 0.0;
        for (const double u : out) {
            heat += (1.0 - std::exp(-1.0 / rate)) * (u * u / ohms - heat);
            warmest = std::max(warmest, heat);
        }
        INFO(played.box.kind << " of the " << played.box.output << ": " << y.cwiseAbs().maxCoeff() / range
                             << " of what was measured, " << peakOf(out) << " V of " << recipe.voltageLimit << ", "
                             << warmest << " W of " << recipe.powerLimit);
        if (std::isfinite(range))
            CHECK((y.array() - y[0]).cwiseAbs().maxCoeff() < 0.505 * range);
        CHECK(peakOf(out) <= 1.0001 * recipe.voltageLimit);
        CHECK(warmest < 1.01 * recipe.powerLimit);
        CHECK(warmest > 0.2 * recipe.powerLimit);  // half of the time it is quiet
        const auto meters = processor.collectMeters();
        CHECK((meters.displacement > 0.0) == std::isfinite(range));
        CHECK(meters.powerReduction > 0.0);
    }
}

TEST_CASE("Bypass is bit by bit the signal with every class of models, as late as the host is told",
          "[plugin][blackbox]")
{
    for (const auto& box : boxes())
        for (const double sampleRate : {48000.0, 44100.0, 96000.0}) {
            Processor processor;
            auto recipe = processor.parameters().recipe();
            recipe.fullScale = 1.0;
            processor.parameters().set(recipe);
            processor.setModel(box);
            processor.prepareToPlay(sampleRate, 512);
            INFO(box->played.box.kind << " at " << sampleRate << " Hz, latency " << processor.getLatencySamples());
            const auto u = noise(box->played.box.stimulus, 3.0, sampleRate, 6, 1);
            for (const auto mode : {Mode::bypass, Mode::audition}) {
                setMode(processor, mode);
                processor.reset();
                auto out = through(processor, u, 512, 1, mode != Mode::bypass);
                const auto faded = mode == Mode::bypass ? 0 : static_cast<std::ptrdiff_t>(0.06 * sampleRate);
                CHECK(std::equal(out.begin() + faded, out.end(), u.begin() + faded));
            }
        }
}
