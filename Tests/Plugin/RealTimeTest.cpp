// SPDX-License-Identifier: GPL-3.0-or-later
// No allocation, no lock and no system call where the host's audio runs. (That the detectors detect is tested where the
// engine is.)
#include <cstddef>  // by which the C library says which it is

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

#include "BlackBox/EveryClass.h"
#include "Predistortion/Detectors.h"

#include "Plugin/Editor.h"

#include <limits>
#include <random>
#include <thread>
#include <utility>

using namespace excursion;
using plugin::Editor;
using plugin::Processor;

// The kernel's watch lets write() pass, with which a message is posted; so it is counted.
namespace {
thread_local int writes = 0;
}
extern "C" ssize_t write(int file, const void* data, std::size_t size)
{
    count(writes);
    return syscall(SYS_write, file, data, size);
}

TEST_CASE("Nothing in processBlock allocates, locks or calls the system", "[plugin]")
{
    std::unique_ptr<int> kept;
    REQUIRE(countIn([&] { kept = std::make_unique<int>(3); }).allocations == 1);
    Processor processor;
    juce::AudioBuffer<float> buffers[] {{2, 1}, {2, 64}, {2, 4096}};
    juce::MidiBuffer midi;
    const auto work = [&] {
        for (auto& buffer : buffers) {
            processor.processBlock(buffer, midi);
            buffer.setSample(0, 0, std::numeric_limits<float>::quiet_NaN());
            processor.processBlock(buffer, midi);
            processor.processBlockBypassed(buffer, midi);
        }
        processor.reset();
    };
    for (const auto& [rate, mode] : {std::pair {48000.0, Mode::bypass},
                                     {48000.0, Mode::speaker},
                                     {48000.0, Mode::distortion},
                                     {48000.0, Mode::linearize},
                                     // the last where no engine can run
                                     {48000.0, Mode::audition},
                                     {1e6, Mode::audition}}) {
        INFO(rate << " Hz, " << name(mode));
        processor.prepareToPlay(rate, 64);
        processor.parameters().mode() = static_cast<int>(mode);
        const auto first = countIn([&] { processor.processBlock(buffers[0], midi); });
        CHECK(first.allocations == 0);
        CHECK(first.locks == 0);
        processor.setModel(processor.model());  // a hand-over is under way
        const auto counts = countIn(work);
        CHECK(counts.allocations == 0);
        CHECK(counts.locks == 0);
        if (canWatchSystemCalls())
            CHECK_FALSE(callsSystem(work));
    }
}

TEST_CASE("Nothing in processBlock allocates, locks or calls the system with models without physics either",
          "[plugin][blackbox]")
{
    Processor processor;
    juce::AudioBuffer<float> buffers[] {{2, 1}, {2, 64}, {2, 4096}};
    juce::MidiBuffer midi;
    std::mt19937 random(3);
    const auto work = [&] {
        for (auto& buffer : buffers) {
            for (int n = 0; n < buffer.getNumSamples(); ++n)
                buffer.setSample(1, n, static_cast<float>(random()) / 4294967296.0f - 0.5f);
            processor.processBlock(buffer, midi);
            buffer.setSample(0, 0, std::numeric_limits<float>::quiet_NaN());
            processor.processBlock(buffer, midi);
            processor.processBlockBypassed(buffer, midi);
        }
        processor.reset();
    };
    for (const auto& document : everyClass()) {
        const auto box = plugin::loadedBox(document, "a test");
        for (const double rate : {48000.0, 44100.0})
            for (const auto mode : modes) {
                INFO(box->played.box.kind << ", " << rate << " Hz, " << name(mode));
                processor.setModel(processor.model());
                processor.prepareToPlay(rate, 64);
                processor.parameters().mode() = static_cast<int>(mode);
                processor.processBlock(buffers[0], midi);
                processor.setModel(box);  // a hand-over is under way
                for (int round = 0; round < 2; ++round) {
                    const auto counts = countIn(work);
                    CHECK(counts.allocations == 0);
                    CHECK(counts.locks == 0);
                    if (canWatchSystemCalls())
                        CHECK_FALSE(callsSystem(work));
                }
            }
    }
}

TEST_CASE("Automation of all parameters neither allocates nor calls the system, and locks nothing of ours, while the "
          "window is open",
          "[plugin]")
{
    // A wrapper sets a parameter on the audio thread and tells its listeners, for which JUCE locks the list of them.
    juce::AudioParameterBool alone({"alone", 1}, "Alone", false);
    const int own = countIn([&alone] { alone.sendValueChangedMessageToListeners(1.0f); }).locks;
    REQUIRE(own <= 1);
    countIn([] { static_cast<void>(::write(-1, "", 0)); });
    REQUIRE(std::exchange(writes, 0) == 1);
    Processor processor;
    processor.prepareToPlay(48000.0, 64);
    Editor editor(processor);
    editor.go(plugin::PageName::linearize);
    editor.update();
    juce::AudioBuffer<float> buffer(2, 32);
    juce::MidiBuffer midi;
    std::mt19937 random(21);
    auto& all = processor.getParameters();
    const auto automate = [&](int operations) {
        for (int k = 0; k < operations; ++k) {
            auto* parameter = all.getUnchecked(static_cast<int>(random() % static_cast<unsigned>(all.size())));
            const float value = static_cast<float>(random()) / 4294967296.0f;
            parameter->setValue(value);
            parameter->sendValueChangedMessageToListeners(value);
            if (k % 3 == 0)
                processor.processBlock(buffer, midi);
        }
    };
    constexpr int operations = 5000;
    Counts counts {};
    bool calls = false;
    int written = -1;
    const bool watched = canWatchSystemCalls();
    std::thread([&] {  // as the thread of the window may post messages to itself
        calls = watched && callsSystem([&] { automate(operations); });
        counts = countIn([&] { automate(operations); });
        written = writes;
    })
        .join();
    CHECK(written == 0);
    CHECK_FALSE(calls);
    CHECK(counts.allocations == 0);
    CHECK(counts.locks == operations * own);
}

#endif
