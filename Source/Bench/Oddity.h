// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace excursion::bench {

class Random;

/// A force that real loudspeakers show and that no effect of the diagnosis describes. It is added to the known effects,
/// so that takes with it show whether the known effects are still named, and nothing else.
struct Oddity {
    enum class Kind {
        contact,     ///< F = stiffness (side x - gap)^1.5 where side x > gap: a coil former that touches
        wander,      ///< F = K w(t) x, w(t) a sum of slow sinusoids: a suspension that wanders
        hysteresis,  ///< Bouc-Wen: F = stiffness z, z' = v (1 - (b sign(v z) + 1 - b) |z/limit|^n)
        jump         ///< F = K d(t), d(t) jumps between two rest positions: a spider that snaps over
    };
    Kind kind = Kind::contact;
    double side = 1.0;       ///< contact: +1 or -1
    double gap = 0.001;      ///< m, contact
    double stiffness = 0.0;  ///< contact: N/m^1.5; hysteresis: N/m; wander and jump: N/m, of the spring
    double limit = 0.0;      ///< m, hysteresis: largest |z|
    double exponent = 2.0;   ///< hysteresis: n
    double pinch = 0.5;      ///< hysteresis: b, not below 1/2, where it would generate energy; 1 with n = 1 is Dahl's
    double depth = 0.0;      ///< wander: rms of w; jump: m, between the two rest positions
    std::uint64_t seed = 1;  ///< seed of the course over time
};

/// The names of the kinds: contact, wander, hysteresis, jump.
const std::vector<std::string>& oddityNames();

/// An oddity of the kind whose force is `strength` times the spring's at the visited displacement.
/// Throws Error (usage) for an unknown name.
Oddity drawOddity(const std::string& name, double strength, double stiffness, double visited, Random&);

}  // namespace excursion::bench
