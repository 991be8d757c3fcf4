// SPDX-License-Identifier: GPL-3.0-or-later
// Models without physics that come to the plugin, take over from one another and are kept, or are refused.
#include "BlackBox/EveryClass.h"

#include "Engine/BlackBox/ModelDocument.h"
#include "Engine/Error.h"
#include "Engine/Linear/StateSpaceFile.h"
#include "Engine/Signal/Fft.h"
#include "Engine/Signal/Level.h"
#include "Plugin/Clicks.h"
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
    plugin::dispatch();
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
    plugin::dispatch();
    CHECK(host.told == 3);
    CHECK(host.elsewhere == 0);
    processor.removeListener(&host);
}

TEST_CASE("A host is told of a rehearsal that ends while no window is open, and a new window does not tell it again",
          "[plugin][blackbox]")
{
    struct Host : juce::AudioProcessorListener {
        void audioProcessorParameterChanged(juce::AudioProcessor*, int, float) override {}
        void audioProcessorChanged(juce::AudioProcessor*, const ChangeDetails& what) override
        {
            states += what.nonParameterStateChanged ? 1 : 0;
        }
        int states = 0;
    } host;
    Processor processor;
    processor.addListener(&host);
    const auto rehearse = [&] {
        processor.rehearsing().load(boxes().front()->document, "a file");
        processor.rehearsing().wait();
    };
    rehearse();
    plugin::dispatch();
    CHECK(host.states == 1);
    rehearse();
    processor.prepareToPlay(rate, 512);  // before a message came
    plugin::dispatch();
    CHECK(host.states == 2);
    plugin::Editor editor(processor);
    CHECK_FALSE(editor.status().contains("a gain of"));
    editor.useBox(boxes().front()->document, "a file");
    processor.rehearsing().wait();
    editor.update();
    CHECK(editor.status().contains("a gain of"));
    plugin::dispatch();
    CHECK(host.states == 3);
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
            plugin::dispatch();
            CHECK(processor.getLatencySamples() > 0);
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
        plugin::dispatch();
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
            while (!stop.stop_requested()) {
                processor.prepareToPlay(rate, 512);
                std::this_thread::sleep_for(std::chrono::milliseconds(1));  // a mutex is not fair: others never had it
            }
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
    const auto before = toJson(processor.parameters().recipe()).dump();
    processor.setStateInformation(text.data(), static_cast<int>(text.size()));
    CHECK_FALSE(processor.box());
    CHECK(toJson(processor.parameters().recipe()).dump() == before);
    CHECK((stateOf(processor) == juce::MemoryBlock(text.data(), text.size())));  // the host keeps it
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
    auto recipe = processor.parameters().recipe();
    const double most = vectorOf(volts).cwiseAbs().maxCoeff();
    recipe.voltageLimit = 0.5 * most;
    processor.parameters().set(recipe);
    CHECK(vectorOf(through(processor, volts)).cwiseAbs().maxCoeff() == Approx(0.5 * most));
    CHECK(protectionOf(processor.box()->played, 8.0).find("nothing else is limited") != std::string::npos);
    CHECK_FALSE(plugin::limitsExcursion(processor.anyModel()));
    recipe.voltageLimit = 100.0;
    processor.parameters().set(recipe);
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
