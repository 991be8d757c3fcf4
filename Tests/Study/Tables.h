// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Study/Summary.h"

#include <nlohmann/json_fwd.hpp>

#include <map>
#include <string>
#include <vector>

namespace excursion::study {

/// Where the diagnosis finds what is hidden, and what it takes it for. Effects that stand 6 dB above the noise count.
struct Tables {
    using Shares = std::map<std::string, Share>;  ///< of such effects, the ones that were added

    Shares byChannels;  ///< the sensors beside the voltage
    Shares byStrength;  ///< what the effect changes in the channel that shows it best, over the noise
    Shares byNoise;     ///< of the sensors
    Shares byDriver;
    /// How often an effect that is there (first) was told as another (second): as itself where it was added; where it
    /// was not, as each effect of that take that is not there, or as `nothing`. First `nothing`: added though all that
    /// shows was found.
    std::map<std::string, std::map<std::string, int>> confusion;
};

inline constexpr const char* nothing = "-";

Tables tabulate(const std::vector<Outcome>&);

std::string text(const Tables&);  ///< for the terminal
nlohmann::ordered_json toJson(const Tables&);

}  // namespace excursion::study
