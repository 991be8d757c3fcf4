// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Check/PreparedTake.h"
#include "Engine/Estimate/Frf.h"

#include <optional>
#include <string>
#include <vector>

namespace excursion {

/// Which frequency response of a take is meant.
struct ResponsePorts {
    /// quantities, "current"; empty: the first beside the input; what the file is a response to, else the voltage or
    /// the force
    std::string output, input;
    int level = -1;  ///< of a take with levels, 0 the quietest; below 0: the loudest
};

struct TakeResponse {
    Frf frf;
    Quantity output = Quantity::current, input = Quantity::voltage;
    double sampleRate = 0.0;                   ///< Hz, of the take; 0 for a frequency response
    std::optional<double> microphoneDistance;  ///< m, where the take tells it
    std::vector<std::string> remarks;          ///< what the file's reader had to assume
};

/// The frequency response output / input of a take: its best linear approximation (see Estimate/Bla.h), Welch's
/// estimate without periods, or the ratio of its spectra where it is a response already. Throws Error (usage) for
/// channels or levels that are not there, (data) for a take that has no such response.
TakeResponse responseOf(const PreparedTake&, const ResponsePorts& = {});

}  // namespace excursion
