// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Bench/Bench.h"
#include "Bench/Loudspeaker.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace excursion::bench {

struct HiddenEffect {
    std::string id;
    double strength = 0.0;  ///< change of the law over the visited range, 0.05 .. 0.6; 0: drawn, log-uniform
    /// eddy currents and creep: cells of random size instead of a law; absent: drawn, 2 in 5
    std::optional<bool> chain {};
};

/// Requirements for a draw; everything left open is drawn from the seed.
struct DrawOptions {
    std::optional<std::string> driver;                ///< micro, midrange, midbass, woofer, subwoofer or seed
    std::optional<std::vector<HiddenEffect>> hidden;  ///< absent: one of drawnEffects(); empty: none
    std::optional<double> noiseDb;                    ///< drawn from -50 .. -85
    std::optional<double> sampleRate;                 ///< drawn from 44.1, 48, 88.2 and 96 kHz
    std::optional<std::vector<Quantity>> channels;
    std::optional<bool> jumps;  ///< of BenchSetup, drawn: 1 in 2
    std::string oddity;         ///< a name of oddityNames(); empty: none
    double seconds = 12.0;      ///< approximate; with long periods up to twice as long
};

/// The range of the linear driver at the loudest level: over these ranges, laws change by their strength.
struct Visited {
    double displacement = 0.0;  ///< m, largest magnitude
    double velocity = 0.0;      ///< m/s
    double current = 0.0;       ///< A
    double power = 0.0;         ///< W, mean of Re i^2
};

struct Draw {
    std::string driver;  ///< its class
    Loudspeaker speaker;
    BenchSetup setup;
    std::vector<HiddenEffect> hidden;  ///< with the strength reached
    Visited visited;                   ///< of the driver without effects, at the voltage for which the laws were drawn
};

const std::vector<std::string>& driverClasses();

/// The effects that a draw chooses from if none are given.
const std::vector<std::string>& drawnEffects();

/// A linear driver of the class: mass, resonance, Bl, Re, Le, Qms (2 .. 8), area and xmax are drawn log-uniformly
/// within the usual ranges of such drivers. "seed" is the driver of [B 2.2].
Loudspeaker drawLinear(const std::string& driverClass, Random&);

/// Excitation, channels and noise that suit a driver: low edge 0.2 to 0.5 f0, high edge 2 to 10 kHz, f0/10 or finer
/// resolution, three levels. The levels are relative (the loudest is 1 V) until settleLevel().
BenchSetup drawSetup(const Loudspeaker&, const DrawOptions&, Random&);

/// The range of the driver without effects when the setup is played, from its closed-form response.
Visited visit(const Loudspeaker&, const BenchSetup&);

/// Adds an effect with this strength; returns the strength reached (some laws saturate earlier).
double addEffect(Loudspeaker&, const HiddenEffect&, const Visited&, const BenchSetup&, Random&);

/// Loops in the iron move with the coil. The product of motion and current then drives them down to 0 Hz, and the loops
/// that draw K s^a, a hundredth as slow as the band, would keep its flux over many sections. Iron does not: in a pole
/// of radius a the slowest loop has the rate j01^2/(mu sigma a^2), some Hz. So they become a chain of their own,
/// without those slower than a thirtieth of the band's lower edge.
void setMoving(Loudspeaker&, const Excitation&);

/// Everything for one take. The loudest level takes the driver, with its effects, to 45 .. 85 % of xmax.
/// Throws Error (usage) for an unknown driver or effect.
Draw draw(std::uint64_t seed, const DrawOptions& = {});

/// As draw(), but only the loudspeaker.
Loudspeaker drawLoudspeaker(std::uint64_t seed, const std::vector<HiddenEffect>& hidden);

}  // namespace excursion::bench
