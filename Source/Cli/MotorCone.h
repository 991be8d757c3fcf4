// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Cli/OpenResponse.h"

#include <optional>
#include <vector>

namespace excursion::cli {

class Terminal;

struct MotorConeArguments {
    ResponseChoice response;  ///< its output is not used
    int motorOrder = 3, coneOrder = 0;
    std::optional<double> delay;  ///< s; without it the distance of the take's microphone at 343 m/s
    std::vector<double> band;     ///< Hz, or empty
    bool quick = false;
    std::string out;  ///< where the models are kept, or empty
};

/// What `identify --cone` does: a loudspeaker as motor and cone, from displacement and pressure of one take.
void identifyMotorAndCone(const MotorConeArguments&, Terminal&);

}  // namespace excursion::cli
