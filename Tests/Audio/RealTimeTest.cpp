// SPDX-License-Identifier: GPL-3.0-or-later
// What runs on the thread of a device neither allocates nor locks nor calls the system, and hands frames over in order.
// The sanitizers bring allocators and locks of their own.
#include "Audio/Procedure.h"
#include "Audio/Ring.h"

#include <catch2/catch.hpp>

#include <thread>

using namespace excursion;

TEST_CASE("Frames come out of a ring as they went in, from one thread to another", "[audio][realtime]")
{
    audio::Ring ring(3, 64);
    constexpr std::size_t frames = 200000;
    std::jthread writer([&ring] {
        for (std::size_t n = 0; n < frames;) {
            const auto x = static_cast<float>(n);
            const float frame[] {x, -x, x + 0.5f};
            if (ring.write(frame))
                ++n;
            else
                std::this_thread::yield();
        }
    });
    std::vector<std::vector<float>> channels(3);
    while (channels[0].size() < frames)
        if (ring.read(channels) == 0)
            std::this_thread::yield();
    std::size_t wrong = 0;
    for (std::size_t n = 0; n < frames; ++n) {
        const auto x = static_cast<float>(n);
        wrong += channels[0][n] != x || channels[1][n] != -x || channels[2][n] != x + 0.5f;
    }
    CHECK(wrong == 0);
    CHECK(channels[2].size() == frames);
}

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

#include "Predistortion/Detectors.h"

namespace {

/// All stages of a procedure in blocks of several sizes, then one that fades.
struct DeviceThread {
    DeviceThread()
        : whole(options()), limited(options(0.05)), stopped(options()), in(2, std::vector<float>(512)), out(in)
    {
    }

    static audio::ProcedureOptions options(double limit = 0.99)
    {
        audio::ProcedureOptions options;
        options.sampleRate = 8000.0;
        for (int n = 0; n < 8000; ++n)
            options.sound.push_back(n % 8 < 4 ? 0.1f : -0.1f);
        options.loudest.assign(options.sound.begin(), options.sound.begin() + 800);
        options.inputs = {{0, Quantity::voltage, 1.0, limit}, {1, Quantity::displacement, 1.0, limit}};
        options.recorded = 2;
        options.rise = 1.0;
        return options;
    }

    void run(audio::Procedure& procedure)
    {
        const float* const inPlaces[] {in[0].data(), in[1].data()};
        float* const outPlaces[] {out[0].data(), out[1].data()};
        audio::Block block;
        block.in = inPlaces;
        block.out = outPlaces;
        block.inputs = block.outputs = 2;
        for (int k = 0; k < 400; ++k) {
            block.frames = k % 3 == 0 ? 512 : k % 3 == 1 ? 64 : 1;
            block.broken = k == 2;
            procedure.process(block);
            for (std::size_t n = 0; n < 512; ++n)
                for (auto& channel : in)
                    channel[n] = out[0][n] + (n % 2 ? 1e-4f : -1e-4f);
        }
    }

    void runAll()
    {
        run(whole);
        run(limited);
        stopped.stop();
        run(stopped);
    }

    audio::Procedure whole, limited, stopped;
    std::vector<std::vector<float>> in, out;
};

}  // namespace

TEST_CASE("A procedure allocates nothing, locks nothing and does not call the system", "[audio][realtime]")
{
    DeviceThread device;
    const auto counts = countIn([&] { device.runAll(); });
    CHECK(counts.allocations == 0);
    CHECK(counts.locks == 0);
    CHECK(device.whole.ending().kind == audio::Ending::Kind::complete);
    CHECK(device.limited.ending().kind == audio::Ending::Kind::limit);
    CHECK(device.stopped.ending().kind == audio::Ending::Kind::stopped);
    if (!canWatchSystemCalls()) {
        WARN("skipped: the kernel does not watch system calls here");
        return;
    }
    DeviceThread other;
    CHECK_FALSE(callsSystem([&] { other.runAll(); }));
}

#endif
