// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Document/JsonField.h"
#include "Engine/Loudspeaker/ModelFile.h"
#include "Fuzz/Target.h"

#include <nlohmann/json.hpp>

using namespace excursion;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    if (size == 0)
        return 0;
    const fuzz::MemoryFile file(data, size);
    try {
        const auto model = readModel(file.path());
        fuzz::demand(model.effectIds().size() < 100, "each effect once");
    } catch (const Error& e) {
        fuzz::demand(std::string(e.what()).size() > 10, "a sentence");
    }
    return 0;
}

std::vector<std::string> fuzz::seeds()
{
    const std::string base =
        R"({"format": "excursion-model", "version": 1, "name": "m", "base": {"id": "electrodynamic", "parameters": [
 {"name": "Re", "value": 4.27, "unit": "ohm", "standardError": 0.001, "free": true},
 {"name": "Le", "value": 0.000243, "unit": "H", "standardError": null, "free": true},
 {"name": "Bl", "value": 5.4, "unit": "N/A", "standardError": 0.002, "free": true},
 {"name": "m", "value": 0.011, "unit": "kg", "standardError": 1e-5, "free": true},
 {"name": "Rms", "value": 1.87, "unit": "N s/m", "standardError": 0.003, "free": true},
 {"name": "K", "value": 1415.0, "unit": "N/m", "standardError": 1.9, "free": true}]},)";
    return {base + R"("effects": [{"id": "stiffness", "operatingRange": {"displacement": 0.0024,
 "velocity": 0.77, "current": 1.8, "lowFrequency": 14.6, "highFrequency": 3665.0, "degree": 2, "scale": 1402.5},
 "parameters": [
 {"name": "c1", "value": -20.1, "unit": "N/m", "standardError": 1.3, "free": true},
 {"name": "c2", "value": 176.7, "unit": "N/m", "standardError": 1.5, "free": true}]}],
 "path": {"parameters": [{"name": "Sd", "value": 0.0103, "unit": "m^2", "standardError": 5e-6, "free": true},
 {"name": "tau", "value": 0.0003, "unit": "s",
 "standardError": 4e-8, "free": true}], "microphoneDistance": 0.112}, "covariance": null})"};
}
