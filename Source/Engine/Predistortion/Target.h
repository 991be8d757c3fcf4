// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Resonance.h"
#include "Engine/Predistortion/ThirdOctaves.h"

#include <algorithm>
#include <complex>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace excursion {

/// How a linearized driver is to move: like its own linear part, or with another resonance. Another resonance is a
/// Linkwitz equalizer in front of the predistorter,
///     T(s) = (s^2 + (w0/Q0) s + w0^2) / (s^2 + (wt/Qt) s + wt^2),
/// (f0, Q0) the driver's own (OwnLinearPart), (ft, Qt) the target's. The linearized driver then has the response of its
/// linear part times T. Without inductance and creep, this is exactly the response of a driver that resonates at ft
/// with Qt. Inductance and creep stay as they are, and so does the sensitivity above the resonance, where T goes to 1.
/// At low frequencies T goes to (f0/ft)^2: an octave of extension costs 12 dB of excursion and of voltage. Or the sound
/// is equalized in third-octave bands (Equalizer), to a flat band, given gains or a given curve. Sources: S. Linkwitz,
/// Wireless World, May and June 1980 (the equalizer); R. Small, J. AES 20(10), 1972 (the closed box).
struct Target {
    enum class Kind {
        own,        ///< the driver's own linear part
        resonance,  ///< the resonance of frequency and quality
        closedBox,  ///< the resonance that the driver would have in a closed box of that volume
        flat,       ///< flat sound between `low` and `high`, at its average level there
        bands,      ///< the gains of `curve`
        response    ///< sound like `curve`, at its average level where the curve is given
    };
    Kind kind = Kind::own;
    double frequency = 40.0;  ///< Hz
    double quality = 0.707;
    double volume = 0.02;             ///< m^3 of air, without stuffing and leaks
    double low = 50.0, high = 500.0;  ///< Hz
    ThirdOctaves curve {};            ///< dB

    static constexpr double notGiven = -999.0;  ///< marks a band without a value in the curve
    static constexpr double mostGain = 24.0;    ///< dB
    bool equalizes() const { return kind == Kind::flat || kind == Kind::bands || kind == Kind::response; }

    bool areSound() const
    {
        return frequency >= 1.0 && frequency <= 20000.0 && quality >= 0.1 && quality <= 10.0 && volume >= 1e-5
               && volume <= 100.0 && low >= 1.0 && high >= 1.0 && low <= 40000.0 && high <= 40000.0
               && std::all_of(curve.begin(), curve.end(),
                              [](double db) { return db == notGiven || (db >= -200.0 && db <= 300.0); });
    }
    bool isValid(std::string* reason) const;
    bool operator==(const Target&) const = default;
};

/// A curve in the bands of a target: the mean of its points in each third-octave band. A band without points is
/// interpolated over the logarithm of the frequency. Beyond the ends of the curve it is Target::notGiven.
/// @param frequency  Hz, ascending, positive; as many as levels
ThirdOctaves targetCurve(const std::vector<double>& frequency, const std::vector<double>& db);

/// How a loudspeaker moves and sounds by itself, and which targets it can have.
struct OwnLinearPart {
    OwnLinearPart() = default;

    /// For a driver; its resonance is coneResonance().
    explicit OwnLinearPart(const Model&);

    /// @param motion  displacement per input at a frequency, in any unit
    /// @param own     candidate for its resonance
    /// @param slow    the motion far below it, on the stiffness that the suspension has at the resonance
    void takeResonance(const std::function<std::complex<double>(double)>& motion, const Resonance& own, double slow);

    /// The single resonance of the motion. Nothing if the linear part departs from it by more than 6 dB between a
    /// quarter of f0 and twice f0, as in a vented box, where two resonances share the motion. Then the only target is
    /// the own linear part.
    std::optional<Resonance> single;
    /// Vas = rho c^2 Sd^2/K, m^3: volume of air with the stiffness that the suspension has at the resonance; nothing if
    /// the cone area is not known.
    std::optional<double> suspensionVolume;
    std::optional<ThirdOctaves> sound;  ///< level, dB; nothing if the model gives no sound

    /// The resonance that is played for a target. A closed box adds the stiffness of its air,
    ///     ft = f0 sqrt(1 + Vas/V),   Qt = Q0 sqrt(1 + Vas/V).
    /// If require() refuses the target, this is the own resonance. Any thread.
    Resonance played(const Target&) const;

    /// The gains at the centres of the bands, dB. The band next to the requested ones has half of the gain at their
    /// border, all further bands have none. Any thread.
    ThirdOctaves gains(const Target&) const;

    /// Throws Error (data): why this loudspeaker cannot have this target. Also if the target differs from the own
    /// frequency by more than a factor of 8, or takes a gain of more than 24 dB.
    void require(const Target&) const;

private:
    std::optional<Resonance> asked(const Target&) const;
    std::optional<ThirdOctaves> askedGains(const Target&) const;
};

}  // namespace excursion
