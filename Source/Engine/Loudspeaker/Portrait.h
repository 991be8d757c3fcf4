// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"

#include <string>
#include <vector>

namespace excursion {

/// The picture of an effect that has no law (Evidence): what it does by itself while the driver moves in the simplest
/// way that shows it, with its 95 % band.
///   loop      -force over x, one period of x = A sin(t V/X) after many, for A = X, X/2 and X/4
///   drift     r + drop/i over t from rest, for i = I/4, about the rms of a multisine whose peak is I; r is the base
///             parameter that sizes the effect
///   lateness  lateness over x, from -X to X
/// X, V and I are the visited peaks (OperatingRange), and the time is that of the take.
struct Portrait {
    struct Line {
        double size = 0.0;                               ///< A in m, i in A; 0 for lateness
        std::vector<double> argument, value, halfWidth;  ///< halfWidth of the 95 % band; NaN if unknown
    };

    std::string effectId;
    Evidence evidence = Evidence::loop;
    std::string name, unit;              ///< of the values: "force", "N"
    std::string argument, argumentUnit;  ///< "x", "m"
    std::vector<Line> lines;
};

/// Those of a model's effects that are shown neither by a law nor by a response, in the order of its components.
std::vector<Portrait> portraits(const Model&);

}  // namespace excursion
