// SPDX-License-Identifier: GPL-3.0-or-later
// Two tones are bent so that a loudspeaker plays them as if it were linear, block by block as an audio thread does it,
// and a simulation of that loudspeaker tells what is gained.
//     example_predistortbuffer MODEL.json
#include "Engine/Error.h"
#include "Engine/Loudspeaker/ModelFile.h"
#include "Engine/Loudspeaker/Simulate.h"
#include "Engine/Predistortion/Predistorter.h"
#include "Engine/Signal/Fft.h"

#include <cmath>
#include <iostream>
#include <numbers>

using namespace excursion;

constexpr double sampleRate = 48000.0;
constexpr std::size_t window = 4800;  // 0.1 s: 40 Hz and 300 Hz stand on lines 4 and 30

// What the cone's acceleration holds beside the two tones, over these, in dB.
double distortionDb(const Model& model, const std::vector<double>& voltage)
{
    const auto take = simulate(model, voltage, sampleRate, SimulationOptions {});
    const auto spectrum = fft(std::span(take.find(Quantity::acceleration)->samples).last(window));
    double tones = 0.0, rest = 0.0;
    for (std::size_t line = 1; line < spectrum.size(); ++line)
        (line == 4 || line == 30 ? tones : rest) += std::norm(spectrum[line]);
    return 10.0 * std::log10(rest / tones);
}

int main(int argc, char** argv)
{
    try {
        const Model model = readModel(argc > 1 ? argv[1] : "Presets/drivers/woofer.json");
        std::vector<double> plain(48000);
        for (std::size_t n = 0; n < plain.size(); ++n) {
            const double turn = 2.0 * std::numbers::pi * static_cast<double>(n) / sampleRate;  // of 1 Hz
            plain[n] = 5.0 * std::sin(40.0 * turn) + 2.0 * std::sin(300.0 * turn);             // V
        }

        PredistortionControls controls;
        controls.displacementLimit = measuredDisplacement(model);
        controls.voltageLimit = 30.0;
        // allocates; what follows does not
        Predistorter predistorter(model, RealTimeOptions {sampleRate}, controls);
        auto bent = plain;
        for (std::size_t n = 0; n < bent.size(); n += 256)
            predistorter.process(&bent[n], &bent[n], std::min<std::size_t>(256, bent.size() - n));

        const double before = distortionDb(model, plain), after = distortionDb(model, bent);
        const auto meters = predistorter.collectMeters();
        std::cout << model.name << ": distortion " << before << " dB, linearized " << after << " dB, "
                  << predistorter.latency() << " samples later; the cone moves " << 1e3 * meters.displacement
                  << " mm, at " << meters.voltage << " V\n";
        return after < before - 30.0 && meters.faults == 0 ? 0 : 1;
    } catch (const Error& error) {
        std::cerr << error.what() << "\n";
        return error.exitCode();
    }
}
