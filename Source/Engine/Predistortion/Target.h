// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"

#include <optional>
#include <string>

namespace excursion {

/// A resonance of second order, s^2 + (w/Q) s + w^2 with w = 2 pi f.
struct Resonance {
    double frequency = 0.0;  ///< f, Hz
    double quality = 0.0;    ///< Q
};

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

/// The resonance that a driver has itself, as Thiele and Small count it,
///     f0 = sqrt(K/m)/(2 pi),   Q0 = sqrt(K m)/(Rms + Bl^2/Re),
/// without the term in Bl for a driver without a coil. It is where the impedance has its peak. The poles of the linear
/// part are no better measure: those of an eddy current stand among them, and a woofer of 32 Hz that is well damped has
/// its pair at 62 Hz.
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
    /// No target is farther than a factor `farthest` from the own frequency: beyond
    /// that it is played as if it were there. Any thread.
    Resonance played(const Target&) const;
    static constexpr double farthest = 8.0;

    /// Throws Error (data): why this driver cannot be given this target. A target that is out of reach is refused, too.
    void require(const Target&) const;
};

}  // namespace excursion
