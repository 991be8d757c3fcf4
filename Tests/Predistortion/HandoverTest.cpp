// SPDX-License-Identifier: GPL-3.0-or-later
#include "Predistortion/Drivers.h"

#include "Engine/Predistortion/Crossfade.h"
#include "Engine/Predistortion/Predistorter.h"

#include <catch2/catch.hpp>

#include <atomic>
#include <thread>

using namespace excursion;

namespace {

/// An engine that multiplies, and is counted.
struct Gain {
    explicit Gain(double factor, std::atomic<int>* alive = nullptr) : factor_(factor), alive_(alive)
    {
        if (alive_)
            ++*alive_;
    }
    ~Gain()
    {
        factor_ = 0.0;
        if (alive_)
            --*alive_;
    }
    Gain(const Gain&) = delete;
    Gain& operator=(const Gain&) = delete;
    void process(const double* in, double* out, std::size_t n)
    {
        for (std::size_t k = 0; k < n; ++k)
            out[k] = factor_ * in[k];
    }
    double factor_;
    std::atomic<int>* alive_;
};

}  // namespace

TEST_CASE("A new engine fades in over the time that was asked for, and the old one comes back", "[handover]")
{
    std::atomic<int> alive {0};
    {
        Crossfade<Gain> crossfade(2400);
        std::vector<double> ones(1000, 1.0), out(1000);
        crossfade.process(ones.data(), out.data(), 1000);
        CHECK(out == ones);  // nothing is there yet
        crossfade.start(std::make_unique<Gain>(2.0, &alive));
        crossfade.process(ones.data(), out.data(), 1000);
        CHECK(out == std::vector<double>(1000, 2.0));

        crossfade.offer(std::make_unique<Gain>(5.0, &alive));
        crossfade.offer(std::make_unique<Gain>(3.0, &alive));  // replaces the one before, which never played
        CHECK(alive == 2);
        std::vector<double> all;
        for (int block = 0; block < 4; ++block) {
            crossfade.process(ones.data(), out.data(), 1000);
            all.insert(all.end(), out.begin(), out.end());
            if (block == 1)
                crossfade.offer(std::make_unique<Gain>(4.0, &alive));  // has to wait
        }
        for (std::size_t n = 1; n < 2400; ++n) {
            CHECK(all[n] >= all[n - 1]);
            CHECK(all[n] - all[n - 1] < 1.9 / 2400.0);  // the steepest of the curve is 15/8
        }
        CHECK(all[2399] == 3.0);
        CHECK(all.back() > 3.0);
        CHECK(alive == 3);
        CHECK(crossfade.collect() == 1);
        CHECK(alive == 2);
    }
    CHECK(alive == 0);
}

namespace {

/// An engine that is late, and silent until its delay line is full.
struct Late {
    void process(const double* in, double* out, std::size_t n)
    {
        for (std::size_t k = 0; k < n; ++k) {
            const double sample = in[k];
            out[k] = line[at];
            line[at] = sample;
            at = (at + 1) % line.size();
        }
    }
    std::vector<double> line = std::vector<double>(100, 0.0);
    std::size_t at = 0;
};

}  // namespace

TEST_CASE("A new engine is heard once its delay line is full: two that do the same are swapped without a trace",
          "[handover]")
{
    Crossfade<Late> crossfade(500, 100);
    crossfade.start(std::make_unique<Late>());
    auto u = noise(4000, 1.0), out = u;
    for (std::size_t n = 0; n < u.size(); n += 50) {
        if (n == 1000)
            crossfade.offer(std::make_unique<Late>());
        crossfade.process(u.data() + n, out.data() + n, 50);
    }
    CHECK(std::equal(u.begin(), u.end() - 100, out.begin() + 100));
    CHECK(crossfade.collect() == 1);
}

TEST_CASE("Engines are handed over and taken back while audio runs", "[handover]")
{
    std::atomic<int> alive {0};
    std::atomic<bool> done {false};
    int freed = 0;
    bool plausible = true;
    {
        Crossfade<Gain> crossfade(64);
        crossfade.start(std::make_unique<Gain>(1.0, &alive));
        std::thread audio([&] {
            std::vector<double> ones(48, 1.0), out(48);
            while (!done) {
                crossfade.process(ones.data(), out.data(), out.size());
                for (const double value : out)
                    plausible = plausible && value >= 1.0 && value <= 2.0;  // a freed engine multiplies by 0
            }
        });
        for (int k = 0; k < 2000; ++k) {
            crossfade.offer(std::make_unique<Gain>(1.0 + (k % 11) / 10.0, &alive));
            if (k % 3 == 0)
                freed += crossfade.collect();
            if (k % 50 == 0)
                std::this_thread::yield();
        }
        for (int patience = 0; freed < 2 && patience < 100000; ++patience) {
            crossfade.offer(std::make_unique<Gain>(1.5, &alive));
            freed += crossfade.collect();
            std::this_thread::yield();
        }
        done = true;
        audio.join();
    }
    CHECK(plausible);
    CHECK(freed >= 2);
    CHECK(alive == 0);
}

TEST_CASE("Meters are read and models are swapped from another thread", "[handover]")
{
    std::atomic<bool> done {false};
    Crossfade<Predistorter> crossfade(2400);
    const auto make = [](double amount) {
        return std::make_unique<Predistorter>(everything(), RealTimeOptions {48000.0, 1},
                                              PredistortionControls {amount, xmax, 40.0});
    };
    crossfade.start(make(1.0));
    bool finite = true;
    std::thread audio([&] {
        auto u = noise(256, 5.0);
        std::vector<double> out(256);
        while (!done) {
            crossfade.each([](Predistorter& engine) { engine.set({0.7, xmax, 40.0}); });
            crossfade.process(u.data(), out.data(), out.size());
            finite = finite && std::isfinite(out[0]);
        }
    });
    for (int k = 0; k < 10; ++k) {
        crossfade.offer(make(0.1 * k));
        crossfade.collect();
    }
    done = true;
    audio.join();
    CHECK(finite);
}
