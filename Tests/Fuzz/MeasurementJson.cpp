// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Take/MeasurementJson.h"
#include "Fuzz/Target.h"

#include <cmath>
#include <nlohmann/json.hpp>

using namespace excursion;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    try {
        const auto header = parseMeasurementJson({reinterpret_cast<const char*>(data), size}, "fuzz.json");
        fuzz::demand(header.measurement.sampleRate >= 1.0 && header.measurement.sampleRate <= 1e8,
                     "a possible sample rate");
        for (const auto& channel : header.measurement.channels)
            fuzz::demand(std::isfinite(channel.fullScale) && channel.fullScale > 0.0, "a full scale");
        if (const auto& e = header.measurement.excitation) {
            fuzz::demand(e->period > 0 && e->periods > 0 && e->realizations > 0 && e->settlePeriods >= 0
                             && !e->levels.empty(),
                         "a possible excitation");
            fuzz::demand(e->totalSamples() > 0, "lengths that do not overflow");
        }
        if (const auto& e = header.sweep) {
            const double rate = header.measurement.sampleRate;
            fuzz::demand(e->isValid(rate), "possible sweeps");
            fuzz::demand(e->totalSamples(rate) >= e->blockSamples(rate) && e->blockSamples(rate) > 0,
                         "lengths of sweeps that do not overflow");
        }
        measurementJson(header.measurement, header.audio, header.sweep ? &*header.sweep : nullptr)
            .dump(2, ' ', false, nlohmann::json::error_handler_t::replace);
    } catch (const Error& e) {
        fuzz::demand(std::string(e.what()).size() > 10, "a sentence");
    }
    return 0;
}

std::vector<std::string> fuzz::seeds()
{
    return {
        R"({"format": "excursion-measurement", "version": 1, "sampleRate": 48000.0, "audio": "take.wav",
 "channels": [{"quantity": "voltage", "unit": "V", "fullScale": 16.0},
 {"quantity": "current", "unit": "mA", "fullScale": 4.0}],
 "excitation": {"kind": "multisine", "period": 1024, "settlePeriods": 1, "periods": 2, "realizations": 3,
 "levels": [0.3, 1.2, 2.7],
  "grid": "odd-random", "shape": "pink", "band": [11.7, 3668.8], "lines": [5, 9, 11]},
 "driver": {"name": "midbass", "coneArea": 0.0103, "microphoneDistance": 0.112}})",
        R"({"format": "excursion-measurement", "version": 1, "sampleRate": 44100, "audio": "a.wav",
 "channels": [{"quantity": "force", "unit": "V", "fullScale": 1}]})",
        R"({"format": "excursion-measurement", "version": 1, "sampleRate": 48000, "audio": "a.wav",
 "channels": [{"quantity": "voltage", "unit": "V", "fullScale": 8}],
 "excitation": {"kind": "sweep", "band": [20, 20000], "seconds": 7.98, "fades": [0.1, 0.01],
 "silence": 1, "repeats": 2, "levels": [0.5, 1.5]}})",
        R"({"format":"excursion-measurement","version":1,"sampleRate":1e4,"audio":"a.wav",
 "channels":[{"quantity":"voltage","unit":"V","fullScale":1}],"excitation":{"kind":"noise"}})"};
}
