// SPDX-License-Identifier: GPL-3.0-or-later
// No allocation, no lock and no system call where audio runs. The sanitizers bring allocators and locks of their own.
#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

#include "Predistortion/Detectors.h"
#include "Predistortion/Drivers.h"

#include "Engine/Predistortion/Crossfade.h"
#include "Engine/Predistortion/Predistorter.h"
#include "Engine/Predistortion/Speaker.h"

#include <catch2/catch.hpp>

#include <cstdlib>
#include <limits>
#include <memory>
#include <mutex>

using namespace excursion;

namespace {

/// Everything that an audio thread does: blocks of all sizes, controls, a fault, a model handed over and its
/// predecessor back.
struct AudioThread {
    explicit AudioThread(int oversampling) : bend(1000), play(everything(), {48000.0, oversampling})
    {
        bend.start(std::make_unique<Predistorter>(everything(), RealTimeOptions {48000.0, oversampling}));
        bend.offer(std::make_unique<Predistorter>(midbass(), RealTimeOptions {48000.0, oversampling}));
        u = noise(8192, 6.0);
    }
    void run()
    {
        for (const std::size_t n :
             {std::size_t {0}, std::size_t {1}, std::size_t {64}, std::size_t {1000}, std::size_t {8192}}) {
            PredistortionControls controls {0.5, 3e-3, 10.0};
            controls.target = {Target::Kind::resonance, 30.0 + static_cast<double>(n % 7), 0.7};
            bend.each([&controls](Predistorter& engine) { engine.set(controls); });
            bend.process(u.data(), u.data(), n);
            play.process(u.data(), u.data(), n);
            u[17] = std::numeric_limits<double>::quiet_NaN();
        }
        bend.current()->reset();
        play.reset();
    }
    Crossfade<Predistorter> bend;
    Speaker play;
    std::vector<double> u;
};

}  // namespace

TEST_CASE("The detectors detect", "[realtime]")
{
    std::unique_ptr<int> kept;
    CHECK(countIn([&] { kept = std::make_unique<int>(3); }).allocations == 1);
    CHECK(countIn([&] { kept.reset(); }).allocations == 1);
    void* volatile place = nullptr;
    CHECK(countIn([&] { place = std::malloc(100); }).allocations == 1);
    CHECK(countIn([&] { place = std::realloc(place, 200); }).allocations == 1);
    std::free(place);
    std::mutex mutex;
    CHECK(countIn([&] { const std::lock_guard guard(mutex); }).locks == 1);
    CHECK(countIn([] {}).allocations == 0);
    if (canWatchSystemCalls())
        CHECK_FALSE(callsSystem([] {}));
}

TEST_CASE("Nothing in process allocates, locks or calls the system", "[realtime]")
{
    for (const int oversampling : {1, 2, 4}) {
        INFO(oversampling);
        AudioThread thread(oversampling);
        const auto counts = countIn([&] { thread.run(); });
        CHECK(counts.allocations == 0);
        CHECK(counts.locks == 0);
        CHECK(thread.bend.collect() == 1);
        if (canWatchSystemCalls()) {
            AudioThread other(oversampling);
            CHECK_FALSE(callsSystem([&] { other.run(); }));
        }
    }
}

TEST_CASE("Nor does a limit that acts behind an amplifier that passes no constant voltage", "[realtime]")
{
    for (const int order : {1, 2}) {
        Predistorter engine(everything(), {48000.0, 2, {5.0, order}}, {0.5, 1e-3});
        auto u = burst(48000.0, 0.5, 10.0);
        const auto counts = countIn([&] { engine.process(u.data(), u.data(), u.size()); });
        CHECK(counts.allocations == 0);
        CHECK(counts.locks == 0);
        CHECK(engine.collectMeters().displacementReduction > 3.0);
    }
}

#endif
