// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/Named.h"

#include <nlohmann/json.hpp>

namespace excursion {

nlohmann::ordered_json modelHeader(const DocumentFormat& format, const std::string& name, double sampleRate,
                                   const std::string& input, const std::string& output)
{
    return format.with({{"name", name}, {"sampleRate", sampleRate}, {"input", input}, {"output", output}});
}

}  // namespace excursion
