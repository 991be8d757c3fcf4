// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Audio/Stream.h"
#include "Bench/Collocation.h"
#include "Bench/Simulator.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <numbers>
#include <random>
#include <thread>
#include <vector>

namespace excursion::test {

/// What is connected to a device: a sample of output becomes one of each input.
using Wiring = std::function<std::vector<float>(float)>;

/// A loudspeaker of the bench behind an amplifier and converters: 16 V at the loudspeaker for a played sample of 1.0,
/// inputs voltage (16 V at full scale), current (4 A) and displacement (8 mm, resting at 0.1 of it), `delay` samples
/// late.
class WiredLoudspeaker {
public:
    WiredLoudspeaker(const bench::Loudspeaker& speaker, double sampleRate, std::size_t delay = 480)
        : simulator_(speaker, 1.0 / (steps * sampleRate), std::numbers::pi * sampleRate, 2.0 * std::numbers::pi),
          late_(delay, {0.0f, 0.0f, 0.1f})
    {
    }

    std::vector<float> operator()(float played)
    {
        const double u = 16.0 * played;
        for (int k = 0; k < steps; ++k) {
            bench::Triple drive {};
            for (std::size_t j = 0; j < 3; ++j)
                drive[j] = u_ + (u - u_) * (k + bench::Radau::points()[j]) / steps;
            simulator_.step(drive);
        }
        u_ = u;
        const auto& s = simulator_.sample();
        farthest = std::max(farthest, std::abs(s.displacement));
        late_.push_back({static_cast<float>(u / 16.0 + noise()), static_cast<float>(s.current / 4.0 + noise()),
                         static_cast<float>(0.1 + s.displacement / 8e-3 + noise())});
        auto now = late_.front();
        late_.pop_front();
        return now;
    }

    double farthest = 0.0;  ///< m, of the cone from rest

private:
    static constexpr int steps = 2;
    double noise() { return 1e-5 * normal_(random_); }

    bench::Simulator simulator_;
    double u_ = 0.0;
    std::deque<std::vector<float>> late_;
    std::mt19937_64 random_ {5};
    std::normal_distribution<double> normal_;
};

/// What goes wrong with a stream, at a frame of it.
struct Fault {
    enum class Kind { none, xrun, gone, hangs };
    Kind kind = Kind::none;
    std::size_t frame = 0;
};

/// Plays as quickly as the wiring computes, in blocks of random sizes, on a thread of its own.
class SimulatedStream : public audio::Stream {
public:
    SimulatedStream(Wiring wiring, const audio::StreamOptions& options, Fault fault, std::vector<float>& played,
                    std::uint64_t seed)
        : wiring_(std::move(wiring)), options_(options), fault_(fault), played_(played), random_(seed)
    {
    }
    ~SimulatedStream() override { stop(); }

    void start(audio::Client& client) override
    {
        thread_ = std::jthread([this, &client](std::stop_token stopped) { run(client, stopped); });
    }
    void stop() override
    {
        if (thread_.joinable()) {
            thread_.request_stop();
            thread_.join();
        }
    }
    void abandon() override
    {
        abandoned = true;
        stop();
    }
    bool running() const override { return running_; }

    bool abandoned = false;

private:
    void run(audio::Client& client, const std::stop_token& stopped)
    {
        const auto inputs = static_cast<std::size_t>(options_.inputs),
                   outputs = static_cast<std::size_t>(options_.outputs);
        std::vector<std::vector<float>> in(inputs), out(outputs);
        std::vector<float> next(inputs, 0.0f);
        bool broken = false;
        while (!stopped.stop_requested()) {
            const auto frames = std::uniform_int_distribution<std::size_t>(1, 700)(random_);
            for (auto& channel : in)
                channel.assign(frames, 0.0f);
            for (auto& channel : out)
                channel.assign(frames, 0.5f);  // what is not filled would be heard
            for (std::size_t n = 0; n < frames; ++n) {
                const auto reading = wiring_(pending_.empty() ? 0.0f : pending_.front());
                if (!pending_.empty())
                    pending_.pop_front();
                for (std::size_t k = 0; k < inputs && k < reading.size(); ++k)
                    in[k][n] = reading[k];
            }
            std::vector<const float*> inPlaces;
            std::vector<float*> outPlaces;
            for (auto& channel : in)
                inPlaces.push_back(channel.data());
            for (auto& channel : out)
                outPlaces.push_back(channel.data());
            audio::Block block;
            block.in = inPlaces.data();
            block.out = outPlaces.data();
            block.inputs = inputs;
            block.outputs = outputs;
            block.frames = frames;
            block.broken = broken;
            broken = false;
            client.process(block);
            pending_.insert(pending_.end(), out[0].begin(), out[0].end());
            played_.insert(played_.end(), out[0].begin(), out[0].end());
            if (fault_.kind != Fault::Kind::none && played_.size() >= fault_.frame) {
                if (fault_.kind == Fault::Kind::xrun)
                    broken = true;
                else {
                    running_ = fault_.kind != Fault::Kind::gone;
                    return;
                }
                fault_.kind = Fault::Kind::none;
            }
        }
    }

    Wiring wiring_;
    audio::StreamOptions options_;
    Fault fault_;
    std::vector<float>& played_;
    std::mt19937_64 random_;
    std::deque<float> pending_;
    std::atomic<bool> running_ {true};
    std::jthread thread_;
};

/// One device, "bench", with as many inputs as the wiring has. Every stream has the next of the faults.
class SimulatedSystem : public audio::System {
public:
    explicit SimulatedSystem(std::function<Wiring()> wiring, std::vector<Fault> faults = {})
        : wiring_(std::move(wiring)), faults_(std::move(faults))
    {
    }

    std::vector<audio::Device> devices() override { return {{"Simulation", "bench", 3, 1, {32000.0, 48000.0}, 0}}; }
    std::string description() const override { return "Simulation"; }
    std::unique_ptr<audio::Stream> open(const audio::Device&, const audio::StreamOptions& options) override
    {
        const auto fault = played.size() < faults_.size() ? faults_[played.size()] : Fault {};
        played.emplace_back();
        return std::make_unique<SimulatedStream>(wiring_(), options, fault, played.back(), played.size());
    }

    std::deque<std::vector<float>> played;  ///< by each stream, at its first output

private:
    std::function<Wiring()> wiring_;
    std::vector<Fault> faults_;
};

}  // namespace excursion::test
