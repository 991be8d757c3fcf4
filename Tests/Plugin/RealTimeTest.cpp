// SPDX-License-Identifier: GPL-3.0-or-later
// No allocation, no lock and no system call where the host's audio runs. (That the detectors detect is tested where the engine is.)
#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

#include "Linearization/Detectors.h"

#include "Plugin/Processor.h"

#include <limits>

using namespace excursion;
using plugin::Processor;

TEST_CASE("Nothing in processBlock allocates, locks or calls the system", "[plugin]")
{
    std::unique_ptr<int> kept;
    REQUIRE(countIn([&] { kept = std::make_unique<int>(3); }).allocations == 1);
    Processor processor;
    processor.prepareToPlay(48000.0, 64);
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
    for (const auto mode : modes) {
        INFO(name(mode));
        processor.parameters().mode() = static_cast<int>(mode);
        processor.setModel(processor.model());   // a hand-over is under way
        const auto counts = countIn(work);
        CHECK(counts.allocations == 0);
        CHECK(counts.locks == 0);
        if (canWatchSystemCalls())
            CHECK_FALSE(callsSystem(work));
    }
}

#endif
