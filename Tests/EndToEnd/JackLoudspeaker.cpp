// SPDX-License-Identifier: GPL-3.0-or-later
// A loudspeaker as a client of JACK: what is played to its input "terminals" comes back as voltage (16 V at full
// scale), current (4 A) and displacement (8 mm). It runs until it is killed.
#include "Plugin/SampledSpeaker.h"

#include <jack/jack.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <thread>

namespace {

struct Client {
    jack_port_t* terminals = nullptr;
    std::array<jack_port_t*, 3> sensors {};
    excursion::plugin::SampledSpeaker speaker {48000.0};
};

int process(jack_nframes_t count, void* data)
{
    auto& client = *static_cast<Client*>(data);
    const auto* in = static_cast<const float*>(jack_port_get_buffer(client.terminals, count));
    std::array<float*, 3> out;
    for (std::size_t k = 0; k < out.size(); ++k)
        out[k] = static_cast<float*>(jack_port_get_buffer(client.sensors[k], count));
    for (jack_nframes_t n = 0; n < count; ++n) {
        const auto reading = client.speaker.next(16.0 * static_cast<double>(in[n]));
        out[0][n] = static_cast<float>(reading.voltage / 16.0);
        out[1][n] = static_cast<float>(reading.current / 4.0);
        out[2][n] = static_cast<float>(reading.displacement / 8e-3);
    }
    return 0;
}

}  // namespace

int main()
{
    Client client;
    auto* jack = jack_client_open("loudspeaker", JackNoStartServer, nullptr);
    if (jack == nullptr) {
        std::fprintf(stderr, "no JACK server is running\n");
        return 1;
    }
    client.terminals = jack_port_register(jack, "terminals", JACK_DEFAULT_AUDIO_TYPE, JackPortIsInput, 0);
    constexpr const char* names[] {"voltage", "current", "displacement"};
    for (std::size_t k = 0; k < client.sensors.size(); ++k)
        client.sensors[k] = jack_port_register(jack, names[k], JACK_DEFAULT_AUDIO_TYPE, JackPortIsOutput, 0);
    jack_set_process_callback(jack, process, &client);
    if (jack_activate(jack) != 0)
        return 1;
    for (;;)
        std::this_thread::sleep_for(std::chrono::hours(1));
}
