// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace excursion::audio {

/// What sound can be played through and recorded by, as a backend tells it.
struct Device {
    std::string backend;  ///< "ALSA", "JACK"
    std::string name;
    int inputs = 0, outputs = 0;
    std::vector<double> rates;  ///< Hz, ascending: those of the usual ones that it does
    int index = 0;              ///< of the System that told it
};

/// A stretch of sound, played and recorded at the same time. Samples are -1 .. 1.
struct Block {
    const float* const* in = nullptr;  ///< one pointer an input; null, and broken, when there is nothing to be had
    float* const* out = nullptr;       ///< one pointer an output, to be filled
    std::size_t inputs = 0, outputs = 0, frames = 0;
    bool broken = false;  ///< samples of before or within this block were lost or made up (xrun)
};

/// What a stream calls.
class Client {
public:
    virtual ~Client() = default;
    /// On the thread of the device, which waits for no one: no allocation, no lock, no system call.
    virtual void process(const Block&) noexcept = 0;
};

/// A device that is open for playing and recording.
class Stream {
public:
    virtual ~Stream() = default;
    virtual void start(Client&) = 0;  ///< throws Error (input)
    /// Plays out what the client has given; then the client is called no more.
    virtual void stop() = 0;
    /// As stop(), of a device that answers no longer: waits for nothing.
    virtual void abandon() = 0;
    virtual bool running() const = 0;  ///< false when the device is gone
};

struct StreamOptions {
    double sampleRate = 0.0;      ///< Hz, exactly
    int inputs = 1, outputs = 1;  ///< the first ones of the device
    double latency = 0.1;         ///< s, of buffers each way: more where the computer does not keep up
};

/// The audio devices of this computer.
class System {
public:
    virtual ~System() = default;
    virtual std::vector<Device> devices() = 0;
    virtual std::string description() const = 0;  ///< "PortAudio 19.6: ALSA, JACK"
    /// Throws Error (input) when the device refuses.
    virtual std::unique_ptr<Stream> open(const Device&, const StreamOptions&) = 0;
};

/// Throws Error (input), with what is missing, where Excursion was built without a library for audio devices.
std::unique_ptr<System> openSystem();

}  // namespace excursion::audio
