// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Resonance.h"

#include <optional>
#include <string>

namespace excursion {

/// What a linearized driver is to move like: as its own linear part does, or with another resonance, which is put
/// before the predistorter as Linkwitz' equalizer,
///     T(s) = (s^2 + (w0/Q0) s + w0^2) / (s^2 + (wt/Qt) s + wt^2),
/// (f0, Q0) the driver's own (OwnResonance), (ft, Qt) the target's. The linearized driver has then the response of its
/// linear part times T: without inductance and creep exactly that of a driver that resonates at ft with Qt. These two
/// stay as they are, and so does the sensitivity above the resonance, as T goes to 1 there. At low frequencies T goes
/// to (f0/ft)^2, which is what an octave of extension costs: 12 dB of excursion and of voltage. Sources: S. Linkwitz,
/// Wireless World, May and June 1980 (the equalizer); R. Small, J. AES 20(10), 1972 (the closed box).
struct Target {
    enum class Kind {
        own,        ///< the driver's own linear part
        resonance,  ///< that of frequency and quality
        closedBox   ///< what the driver would have in a closed box of that volume
    };
    Kind kind = Kind::own;
    double frequency = 40.0;  ///< Hz
    double quality = 0.707;
    double volume = 0.02;  ///< m^3 of air, without stuffing and leaks

    bool areSound() const
    {
        return frequency >= 1.0 && frequency <= 20000.0 && quality >= 0.1 && quality <= 10.0 && volume >= 1e-5
               && volume <= 100.0;
    }
    bool isValid(std::string* reason) const;
    bool operator==(const Target&) const = default;
};

/// The resonance that a driver has itself (coneResonance()), and what can be put in its place.
struct OwnResonance {
    explicit OwnResonance(const Model&);

    /// Nothing: the linear part departs from this resonance by more than 6 dB between a quarter of f0 and twice that,
    /// as in a vented box, where two resonances share the motion; then there is no other target than the own linear
    /// part.
    std::optional<Resonance> single;
    /// Vas = rho c^2 Sd^2/K, m^3: of air with the stiffness of the suspension; nothing where the area of the cone is
    /// not known.
    std::optional<double> suspensionVolume;

    /// What is played for a target. A closed box adds the stiffness of its air,
    ///     ft = f0 sqrt(1 + Vas/V),   Qt = Q0 sqrt(1 + Vas/V).
    /// What require() refuses is not played: then it is the own one. Any thread.
    Resonance played(const Target&) const;

    /// Throws Error (data): why this driver cannot be given this target; also where that is farther than by a factor of
    /// 8 from the own frequency.
    void require(const Target&) const;

private:
    std::optional<Resonance> asked(const Target&) const;
};

}  // namespace excursion
