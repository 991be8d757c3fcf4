// SPDX-License-Identifier: GPL-3.0-or-later
// Audio devices by PortAudio, which knows ALSA and JACK.
#include "Audio/Stream.h"

#include "Engine/Error.h"

#ifndef EXCURSION_PORTAUDIO

namespace excursion::audio {

std::unique_ptr<System> openSystem()
{
    throw Error(Error::Kind::input,
                "This excursion was built without PortAudio and reaches no audio device; install portaudio19-dev and "
                "build it again, or use any recorder and 'excursion import'.");
}

}  // namespace excursion::audio

#else

#include <portaudio.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <thread>

#if __has_include(<dlfcn.h>)
#include <dlfcn.h>
#endif
#if __has_include(<pa_jack.h>)
#include <pa_jack.h>
#endif

namespace excursion::audio {
namespace {

[[noreturn]] void refuse(const std::string& what, PaError error)
{
    std::string why = Pa_GetErrorText(error);
    if (error == paUnanticipatedHostError)
        if (const auto* host = Pa_GetLastHostErrorInfo(); host != nullptr && host->errorText != nullptr)
            why += std::string(", ") + host->errorText;
    throw Error(Error::Kind::input, what + " (" + why + ").");
}

void ignoreAlsa(const char*, int, const char*, int, const char*, ...) {}
void ignoreJack(const char*) {}

/// ALSA and JACK tell on stderr about every device that is configured and not there. PortAudio has loaded them.
void silenceBackends()
{
#if __has_include(<dlfcn.h>)
    if (auto* const set = dlsym(RTLD_DEFAULT, "snd_lib_error_set_handler"))
        reinterpret_cast<int (*)(decltype(&ignoreAlsa))>(set)(ignoreAlsa);
    for (const char* const setter : {"jack_set_error_function", "jack_set_info_function"})
        if (auto* const set = dlsym(RTLD_DEFAULT, setter))
            reinterpret_cast<void (*)(decltype(&ignoreJack))>(set)(ignoreJack);
#endif
}

/// What PortAudio calls. It is never freed when a device was abandoned, as a call may still come.
struct Link {
    std::atomic<Client*> client {nullptr};
    std::atomic<bool> inside {false};
    std::size_t inputs = 0, outputs = 0;
};

int callback(const void* in, void* out, unsigned long frames, const PaStreamCallbackTimeInfo*,
             PaStreamCallbackFlags flags, void* data)
{
    auto& link = *static_cast<Link*>(data);
    auto* const* const outputs = static_cast<float* const*>(out);
    link.inside.store(true);
    auto* const client = link.client.load();
    if (client != nullptr && out != nullptr) {
        Block block;
        block.in = static_cast<const float* const*>(in);
        block.out = outputs;
        block.inputs = link.inputs;
        block.outputs = link.outputs;
        block.frames = frames;
        // in is null while an input has overflowed for so long that PortAudio has nothing to give
        block.broken = in == nullptr
                       || (flags & (paInputUnderflow | paInputOverflow | paOutputUnderflow | paOutputOverflow)) != 0;
        client->process(block);
    } else if (out != nullptr) {
        for (std::size_t c = 0; c < link.outputs; ++c)
            for (unsigned long n = 0; n < frames; ++n)
                outputs[c][n] = 0.0f;
    }
    link.inside.store(false);
    return paContinue;
}

class PortAudioStream : public Stream {
public:
    PortAudioStream(const Device& device, const StreamOptions& options) : name_(device.name), link_(new Link)
    {
        link_->inputs = static_cast<std::size_t>(options.inputs);
        link_->outputs = static_cast<std::size_t>(options.outputs);
        const PaStreamParameters in {device.index, options.inputs, paFloat32 | paNonInterleaved, options.latency,
                                     nullptr},
            out {device.index, options.outputs, paFloat32 | paNonInterleaved, options.latency, nullptr};
        const auto error = Pa_OpenStream(&stream_, &in, &out, options.sampleRate, paFramesPerBufferUnspecified,
                                         paClipOff | paDitherOff, callback, link_);
        if (error != paNoError) {
            delete link_;
            refuse("'" + name_ + "' cannot be opened for playing and recording", error);
        }
    }
    ~PortAudioStream() override
    {
        if (!abandoned_) {
            Pa_CloseStream(stream_);
            delete link_;
        }
    }
    PortAudioStream(const PortAudioStream&) = delete;
    PortAudioStream& operator=(const PortAudioStream&) = delete;

    void start(Client& client) override
    {
        link_->client = &client;
        if (const auto error = Pa_StartStream(stream_); error != paNoError)
            refuse("'" + name_ + "' does not start", error);
    }

    void stop() override
    {
        Pa_StopStream(stream_);
        link_->client = nullptr;
    }

    /// Closing a stream of a server that has died would wait for its answer.
    void abandon() override
    {
        abandoned_ = true;
        link_->client = nullptr;
        for (int k = 0; k < 100 && link_->inside; ++k)
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }

    bool running() const override { return Pa_IsStreamActive(stream_) == 1; }
    bool abandoned() const { return abandoned_; }

private:
    std::string name_;
    Link* link_;
    PaStream* stream_ = nullptr;
    bool abandoned_ = false;
};

class PortAudioSystem : public System {
public:
    PortAudioSystem()
    {
        silenceBackends();
#if __has_include(<pa_jack.h>)
        PaJack_SetClientName("excursion");
#endif
        if (const auto error = Pa_Initialize(); error != paNoError)
            refuse("PortAudio does not start", error);
        silenceBackends();  // it has set a function of its own
    }
    ~PortAudioSystem() override
    {
        if (!stuck_)
            Pa_Terminate();
    }
    PortAudioSystem(const PortAudioSystem&) = delete;
    PortAudioSystem& operator=(const PortAudioSystem&) = delete;

    std::vector<Device> devices() override
    {
        std::vector<Device> devices;
        for (int k = 0; k < Pa_GetDeviceCount(); ++k) {
            const auto* info = Pa_GetDeviceInfo(k);
            Device device;
            device.backend = shortNameOf(Pa_GetHostApiInfo(info->hostApi));
            device.name = info->name;
            device.inputs = info->maxInputChannels;
            device.outputs = info->maxOutputChannels;
            device.index = k;
            for (const double rate : {44100.0, 48000.0, 88200.0, 96000.0, 176400.0, 192000.0})
                if (does(k, *info, rate))
                    device.rates.push_back(rate);
            devices.push_back(std::move(device));
        }
        return devices;
    }

    std::string description() const override
    {
        const auto* version = Pa_GetVersionInfo();
        auto text = "PortAudio " + std::to_string(version->versionMajor) + "." + std::to_string(version->versionMinor)
                    + "." + std::to_string(version->versionSubMinor);
        bool jack = false;
        for (int k = 0; k < Pa_GetHostApiCount(); ++k) {
            const auto* api = Pa_GetHostApiInfo(k);
            jack = jack || api->type == paJACK;
            text += std::string(k == 0 ? ": " : ", ") + shortNameOf(api) + " ("
                    + (api->deviceCount == 0 ? "no" : std::to_string(api->deviceCount)) + " device"
                    + (api->deviceCount == 1 ? ")" : "s)");
        }
#if __has_include(<pa_jack.h>)
        if (!jack)
            text += ", JACK (no server is running)";
#endif
        return text;
    }

    std::unique_ptr<Stream> open(const Device& device, const StreamOptions& options) override
    {
        return std::make_unique<Guarded>(device, options, stuck_);
    }

private:
    /// Remembers that a device was abandoned: then PortAudio must not be ended either.
    class Guarded : public PortAudioStream {
    public:
        Guarded(const Device& device, const StreamOptions& options, bool& stuck)
            : PortAudioStream(device, options), stuck_(stuck)
        {
        }
        ~Guarded() override { stuck_ = stuck_ || abandoned(); }

    private:
        bool& stuck_;
    };

    static std::string shortNameOf(const PaHostApiInfo* api)
    {
        return api->type == paJACK ? "JACK" : api->type == paCoreAudio ? "CoreAudio" : api->name;
    }

    static bool does(int index, const PaDeviceInfo& info, double rate)
    {
        const PaStreamParameters in {index, info.maxInputChannels, paFloat32, info.defaultHighInputLatency, nullptr},
            out {index, info.maxOutputChannels, paFloat32, info.defaultHighOutputLatency, nullptr};
        return Pa_IsFormatSupported(info.maxInputChannels > 0 ? &in : nullptr,
                                    info.maxOutputChannels > 0 ? &out : nullptr, rate)
               == paFormatIsSupported;
    }

    bool stuck_ = false;
};

}  // namespace

std::unique_ptr<System> openSystem() { return std::make_unique<PortAudioSystem>(); }

}  // namespace excursion::audio

#endif
