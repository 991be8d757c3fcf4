// SPDX-License-Identifier: GPL-3.0-or-later
// A loudspeaker as a client of JACK: what is played to its input "terminals" comes back as voltage (16 V at full
// scale), current (4 A) and displacement (8 mm). It runs until SIGTERM, and then writes what it was played, up to five
// minutes of 32-bit floats, to the file that its argument names.
#include "Plugin/SampledSpeaker.h"

#include <jack/jack.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <pthread.h>
#include <vector>

namespace {

struct Client {
    jack_port_t* terminals = nullptr;
    std::array<jack_port_t*, 3> sensors {};
    excursion::plugin::SampledSpeaker speaker {48000.0};
    std::vector<float> heard = std::vector<float>(300 * 48000);
    std::atomic<std::size_t> count {0};
};

int process(jack_nframes_t count, void* data)
{
    auto& client = *static_cast<Client*>(data);
    const auto* in = static_cast<const float*>(jack_port_get_buffer(client.terminals, count));
    std::array<float*, 3> out;
    for (std::size_t k = 0; k < out.size(); ++k)
        out[k] = static_cast<float*>(jack_port_get_buffer(client.sensors[k], count));
    const auto heard = client.count.load();
    const auto kept = std::min<std::size_t>(count, client.heard.size() - heard);
    std::copy_n(in, kept, client.heard.begin() + static_cast<std::ptrdiff_t>(heard));
    client.count = heard + kept;
    for (jack_nframes_t n = 0; n < count; ++n) {
        const auto reading = client.speaker.next(16.0 * static_cast<double>(in[n]));
        out[0][n] = static_cast<float>(reading.voltage / 16.0);
        out[1][n] = static_cast<float>(reading.current / 4.0);
        out[2][n] = static_cast<float>(reading.displacement / 8e-3);
    }
    return 0;
}

}  // namespace

int main(int argc, char** argv)
{
    sigset_t end;
    sigemptyset(&end);
    sigaddset(&end, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &end, nullptr);  // of all threads: it is waited for
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
    int signal = 0;
    sigwait(&end, &signal);
    jack_client_close(jack);
    if (argc > 1)
        std::ofstream(argv[1], std::ios::binary)
            .write(reinterpret_cast<const char*>(client.heard.data()),
                   static_cast<std::streamsize>(client.count * sizeof(float)));
    return 0;
}
