// SPDX-License-Identifier: GPL-3.0-or-later
// Models without physics in the plugin, measured by what leaves it: against each class' own simulation.
#include "BlackBox/EveryClass.h"

#include "Engine/BlackBox/ModelDocument.h"
#include "Engine/Error.h"
#include "Engine/Linear/StateSpaceFile.h"
#include "Engine/Signal/Fft.h"
#include "Engine/Signal/Level.h"
#include "Plugin/Played.h"
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

// of the message loop, which this program does not run
namespace juce {
bool dispatchNextMessageOnSystemQueue(bool returnIfNoPendingMessages);
}

using namespace excursion;
using namespace excursion::test;
using plugin::Processor;

namespace {

constexpr double rate = 48000.0;

/// Each class once, as its rehearsal takes a while.
const std::vector<plugin::LoadedBoxPointer>& boxes()
{
    static const auto all = [] {
        std::vector<plugin::LoadedBoxPointer> made;
        for (const auto& document : everyClass())
            made.push_back(plugin::loadedBox(document, "a test"));
        return made;
    }();
    return all;
}

/// What the class itself makes of it, in the output's unit, and its linear part of that.
Eigen::VectorXd simulated(const plugin::LoadedBox& box, const std::vector<double>& volts)
{
    const nlohmann::json document(box.document);
    const auto model = modelDocumentFrom(JsonField(document, "", "a test"));
    return simulate(model, Eigen::Map<const Eigen::VectorXd>(volts.data(), static_cast<Eigen::Index>(volts.size())),
                    model.sampleRate)
        .col(0);
}

/// Some of what it was fitted under, in V.
std::vector<double> noise(const Stimulus& stimulus, double share, double sampleRate, std::uint64_t seed = 5,
                          int times = 4)
{
    const auto period = playedAs(stimulus, sampleRate, static_cast<int>(16384 * std::round(sampleRate / rate)), seed);
    std::vector<double> signal;
    for (int k = 0; k < times; ++k)
        for (const double sample : period)
            signal.push_back(share * sample);
    return signal;
}

/// What leaves the plugin, its latency taken out, in V. @param channel  the one that is told
std::vector<double> through(Processor& processor, const std::vector<double>& volts, int block = 512, int channel = 1,
                            bool bypassed = false)
{
    const double fullScale = processor.parameters().settings().fullScale;
    const auto latency = static_cast<std::size_t>(processor.getLatencySamples());
    std::vector<double> out;
    juce::MidiBuffer midi;
    for (std::size_t n = 0; n < volts.size() + latency; n += static_cast<std::size_t>(block)) {
        juce::AudioBuffer<double> buffer(2, block);
        for (int k = 0; k < block; ++k)
            for (int c = 0; c < 2; ++c) {
                const auto at = n + static_cast<std::size_t>(k);
                buffer.setSample(c, k, at < volts.size() ? volts[at] / fullScale : 0.0);
            }
        bypassed ? processor.processBlockBypassed(buffer, midi) : processor.processBlock(buffer, midi);
        for (int k = 0; k < block; ++k)
            out.push_back(fullScale * buffer.getSample(channel, k));
    }
    out.erase(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(latency));
    out.resize(volts.size());
    return out;
}

Eigen::VectorXd vectorOf(const std::vector<double>& v)
{
    return Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size()));
}

double errorDb(const Eigen::VectorXd& found, const Eigen::VectorXd& truth)
{
    return decibelsOf((found - truth).squaredNorm() / truth.squaredNorm());
}

void setMode(Processor& processor, Mode mode) { processor.parameters().mode() = static_cast<int>(mode); }

/// So that nothing that comes out is above full scale.
void roomy(Processor& processor)
{
    auto recipe = processor.parameters().recipe();
    recipe.fullScale = 100.0;
    recipe.voltageLimit = 100.0;
    processor.parameters().set(recipe);
}

std::string refused(const nlohmann::ordered_json& document)
{
    Processor processor;
    processor.rehearsing().load(document, "a file");
    processor.rehearsing().wait();
    const auto status = processor.rehearsing().status();
    CHECK(status.trouble);
    CHECK(processor.box() == nullptr);
    CHECK(processor.modelVersion() == 1);
    return status.words;
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

TEST_CASE("A host hears of the latency of the model that plays, and on the message thread alone", "[plugin][blackbox]")
{
    struct Host : juce::AudioProcessorListener {
        void audioProcessorParameterChanged(juce::AudioProcessor*, int, float) override {}
        void audioProcessorChanged(juce::AudioProcessor*, const ChangeDetails& what) override
        {
            told += what.latencyChanged ? 1 : 0;
            elsewhere += juce::MessageManager::existsAndIsCurrentThread() ? 0 : 1;
        }
        std::atomic<int> told {0}, elsewhere {0};
    } host;
    const auto deliver = [] {
        while (juce::dispatchNextMessageOnSystemQueue(true)) {}
    };
    Processor processor;
    processor.prepareToPlay(rate, 512);
    const int driver = processor.getLatencySamples();
    processor.addListener(&host);
    processor.rehearsing().load(boxes().front()->document, "a file");
    processor.rehearsing().wait();
    const auto status = processor.rehearsing().status();
    INFO(status.words);
    CHECK_FALSE(status.trouble);
    CHECK(status.words == wordsOf(boxes().front()->played));
    CHECK(status.words.find("a gain of") != std::string::npos);
    REQUIRE(processor.box());
    CHECK(processor.box()->played.box.name == "pnlss");
    // It plays already; the thread that made it ready has left the word to the message thread.
    CHECK(host.told == 0);
    CHECK(processor.getLatencySamples() == driver);
    deliver();
    CHECK(host.told == 1);
    CHECK(processor.getLatencySamples() != driver);
    processor.setModel(processor.model());
    CHECK(processor.getLatencySamples() == driver);
    CHECK(host.told == 2);
    // From a thread of a host's, and then prepared before a message came: the one that prepares knows at once.
    std::thread([&] { processor.setModel(boxes().front()); }).join();
    CHECK(processor.getLatencySamples() == driver);
    processor.prepareToPlay(rate, 512);
    CHECK(processor.getLatencySamples() != driver);
    CHECK(host.told == 3);
    deliver();
    CHECK(host.told == 3);
    CHECK(host.elsewhere == 0);
    processor.removeListener(&host);
}

TEST_CASE("Models are rehearsed, taken back and handed over while audio runs on a thread of its own",
          "[plugin][blackbox]")
{
    Processor processor;
    setMode(processor, Mode::audition);
    processor.prepareToPlay(rate, 256);
    std::atomic<bool> finite {true};
    std::jthread audio([&](const std::stop_token& stop) {
        juce::MidiBuffer midi;
        juce::AudioBuffer<float> buffer(2, 256);
        for (int n = 0; !stop.stop_requested(); ++n) {
            for (int k = 0; k < 256; ++k)
                for (int c = 0; c < 2; ++c)
                    buffer.setSample(c, k, 0.3f * std::sin(0.01f * static_cast<float>(256 * (n % 1000) + k)));
            processor.processBlock(buffer, midi);
            if (!std::isfinite(buffer.getMagnitude(0, 256)))
                finite = false;
            std::this_thread::yield();
        }
    });
    const int driver = processor.getLatencySamples();
    for (int k = 0; k < 3; ++k) {
        processor.rehearsing().load(boxes()[static_cast<std::size_t>(k)]->document, "a file");
        while (processor.rehearsing().status().busy) {
            while (juce::dispatchNextMessageOnSystemQueue(true)) {}
            CHECK(processor.getLatencySamples() > 0);
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
        while (juce::dispatchNextMessageOnSystemQueue(true)) {}
        CHECK(processor.box() != nullptr);
        CHECK(processor.collectMeters().faults == 0);
        processor.setModel(processor.model());
        CHECK(processor.getLatencySamples() == driver);
    }
    audio.request_stop();
    audio.join();
    CHECK(finite);
}

TEST_CASE("A rehearsal that is cancelled while its model is handed over replaces no newer model", "[plugin][blackbox]")
{
    // Whom it hands the model to can tell that it is not wanted any more.
    std::atomic<bool> there {false}, cancelled {false};
    plugin::Rehearsing rehearsing([&](const plugin::LoadedBoxPointer&, const std::stop_token& stop) {
        there = true;
        for (int k = 0; k < 1000 && !stop.stop_requested(); ++k)
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        cancelled = stop.stop_requested();
        throw Error(Error::Kind::cancelled, "Not wanted any more.");
    });
    rehearsing.load(boxes().front()->document, "a file");
    while (!there)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    rehearsing.cancel();
    rehearsing.wait();
    CHECK(cancelled);
    CHECK(rehearsing.status().version == 0);

    // And so can the plugin, kept busy so that both wait for it.
    for (int k = 0; k < 3; ++k) {
        Processor processor;
        std::jthread busy([&](const std::stop_token& stop) {
            while (!stop.stop_requested())
                processor.prepareToPlay(rate, 512);
        });
        processor.rehearsing().load(boxes().front()->document, "a file");
        while (processor.rehearsing().status().busy && processor.rehearsing().status().fraction < 1.0) {}
        processor.setModel(processor.model());
        processor.rehearsing().wait();
        CHECK_FALSE(processor.box());
    }
}

TEST_CASE("Of a state with a model that cannot run at the rate nothing is taken", "[plugin][blackbox]")
{
    Processor saved, processor;
    const auto stimulus = pinkStimulus(2.0);
    auto document = nlohmann::ordered_json::parse(stateOf(saved).toString().toStdString());
    document["model"] = documentOf(randomPnlss(11, 47000.0, stimulus), stimulus);
    document["recipe"]["amount"] = 0.25;
    document["recipe"]["mode"] = "audition";
    const auto text = document.dump();
    processor.prepareToPlay(768000.0, 512);  // more than 16 times the model's
    const auto before = stateOf(processor);
    processor.setStateInformation(text.data(), static_cast<int>(text.size()));
    CHECK_FALSE(processor.box());
    CHECK((stateOf(processor) == before));
    // At another rate it is one that can be used.
    processor.prepareToPlay(rate, 512);
    processor.setStateInformation(text.data(), static_cast<int>(text.size()));
    CHECK(processor.box());
    CHECK(processor.parameters().recipe().amount == 0.25);
}

TEST_CASE("A driver and models without physics take over from one another without a step", "[plugin][blackbox]")
{
    for (const auto mode : {Mode::bypass, Mode::speaker, Mode::linearize, Mode::audition}) {
        Processor processor;
        auto recipe = processor.parameters().recipe();
        recipe.fullScale = 4.0;
        processor.parameters().set(recipe);
        setMode(processor, mode);
        processor.prepareToPlay(rate, 480);
        juce::MidiBuffer midi;
        std::vector<double> out;
        std::size_t next = 0;
        for (std::size_t block = 0; block < 600; ++block) {
            juce::AudioBuffer<double> buffer(2, 480);
            for (int k = 0; k < 480; ++k)
                for (int c = 0; c < 2; ++c) {
                    const double t = (480.0 * static_cast<double>(block) + k) / rate;
                    buffer.setSample(c, k, 0.4 * std::sin(2.0 * std::numbers::pi * 60.0 * t) * std::min(1.0, 20.0 * t));
                }
            processor.processBlock(buffer, midi);
            for (int k = 0; k < 480; ++k)
                out.push_back(buffer.getSample(0, k));
            if (block % 100 == 99) {
                if (next < boxes().size())
                    processor.setModel(boxes()[next++]);
                else
                    processor.setModel(processor.model());
            }
        }
        double steepest = 0.0, bent = 0.0;
        for (std::size_t n = 2; n < out.size(); ++n) {
            steepest = std::max(steepest, std::abs(out[n] - out[n - 1]));
            bent = std::max(bent, std::abs(out[n] - 2.0 * out[n - 1] + out[n - 2]));
        }
        INFO(name(mode));
        // The tone itself: 3.1e-3 a sample, and 2.5e-5 of it bends.
        CHECK(steepest < 0.05);
        CHECK(bent < 2e-3);
    }
}

TEST_CASE("A model without physics is kept in the state, byte for byte, and plays the same when it is restored",
          "[plugin][blackbox]")
{
    for (const auto& box : boxes()) {
        Processor processor, other;
        roomy(processor);
        setMode(processor, Mode::audition);
        processor.setModel(box);
        const auto state = stateOf(processor);
        CHECK(stateOf(processor) == state);
        other.setStateInformation(state.getData(), static_cast<int>(state.getSize()));
        REQUIRE(other.box());
        CHECK(stateOf(other) == state);
        CHECK(other.getLatencySamples() == processor.getLatencySamples());
        processor.prepareToPlay(rate, 512);
        other.prepareToPlay(rate, 512);
        const auto volts = noise(box->played.box.stimulus, 0.7, rate, 5, 1);
        CHECK((through(other, volts) == through(processor, volts)));
        // And back to a driver
        const auto driver = stateOf(*std::make_unique<Processor>());
        other.setStateInformation(driver.getData(), static_cast<int>(driver.getSize()));
        CHECK_FALSE(other.box());
    }
}

TEST_CASE("A model that cannot be inverted plays, and lets the signal through where it should be linearized",
          "[plugin][blackbox]")
{
    Processor processor;
    roomy(processor);
    processor.rehearsing().load(documentOf(oneWay(rate, pinkStimulus(2.0)), pinkStimulus(2.0)), "a file");
    processor.rehearsing().wait();
    const auto status = processor.rehearsing().status();
    INFO(status.words);
    CHECK_FALSE(status.trouble);
    CHECK(status.words.find("cannot be inverted") != std::string::npos);
    REQUIRE(processor.box());
    const auto volts = noise(processor.box()->played.box.stimulus, 0.7, rate, 5, 2);
    setMode(processor, Mode::linearize);
    processor.prepareToPlay(rate, 512);
    CHECK(errorDb(vectorOf(through(processor, volts)), vectorOf(volts)) < -250.0);
    setMode(processor, Mode::speaker);
    processor.reset();
    const auto out = vectorOf(through(processor, volts));
    CHECK(out.allFinite());
    CHECK(out.norm() > 0.0);
    auto broken = volts;
    broken[3000] = std::numeric_limits<double>::quiet_NaN();
    for (const auto mode : modes) {
        setMode(processor, mode);
        CHECK(vectorOf(through(processor, broken)).allFinite());
    }
}

TEST_CASE("A document that cannot be played is refused in a sentence, and changes nothing", "[plugin][blackbox]")
{
    const auto stimulus = pinkStimulus(2.0);
    const auto good = everyClass();
    for (auto document : good) {
        document.erase("stimulus");
        CHECK(refused(document).find("does not say at which level") != std::string::npos);
    }
    auto unstable = randomPnlss(13, rate, stimulus);
    unstable.linear.A *= 1.2;
    CHECK(refused(documentOf(unstable, stimulus)).find("not stable") != std::string::npos);
    auto linear = toJson(NamedStateSpace {"straight", {"voltage"}, {"displacement"}, unstable.linear, 0.0});
    CHECK(refused(linear).find("nothing to correct") != std::string::npos);
    auto cut = good.front();
    cut["linear"].erase("A");
    CHECK(refused(cut).find("A") != std::string::npos);
    auto empty = nlohmann::ordered_json::object();
    CHECK_FALSE(refused(empty).empty());
}

TEST_CASE("Where a model without physics cannot run the signal goes through, until another one can",
          "[plugin][blackbox]")
{
    const auto stimulus = pinkStimulus(2.0);
    auto slow = randomPnlss(11, 12000.0, stimulus);
    const auto box = plugin::loadedBox(documentOf(slow, stimulus), "a test");
    Processor processor;
    roomy(processor);
    setMode(processor, Mode::speaker);
    processor.setModel(box);
    processor.prepareToPlay(200000.0, 512);  // 17 times the model's
    CHECK(processor.standstill().find("as it is") != std::string::npos);
    const auto volts = noise(stimulus, 0.5, 192000.0, 5, 1);
    CHECK(errorDb(vectorOf(through(processor, volts)), vectorOf(volts)) < -250.0);
    processor.setModel(processor.model());
    CHECK(processor.standstill().empty());
    CHECK(errorDb(vectorOf(through(processor, volts)), vectorOf(volts)) > -40.0);
    CHECK_THROWS_AS(processor.setModel(box), Error);  // as another plays, it stays
    CHECK(processor.box() == nullptr);
    CHECK(processor.standstill().empty());
}

TEST_CASE("Of a model that knows no coil the page shows no heat, whatever its dials say", "[plugin][blackbox]")
{
    const auto voltage = boxes().front();
    auto copy = std::make_shared<plugin::LoadedBox>(*voltage);
    copy->played.box.input = "force";
    const plugin::LoadedBoxPointer force = copy;
    Processor processor;
    auto recipe = processor.parameters().recipe();
    recipe.powerLimit = 1.0;
    recipe.coilResistance = 6.0;
    processor.parameters().set(recipe);
    plugin::Editor editor(processor);
    editor.go(plugin::PageName::linearize);
    for (const auto& [box, meters] : {std::pair {voltage, 3U}, {force, 2U}}) {
        processor.setModel(box);
        editor.update();
        editor.update();
        CHECK(plugin::all<plugin::Meter>(editor.page(plugin::PageName::linearize)).size() == meters);
    }
}
