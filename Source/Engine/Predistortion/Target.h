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

/// What a linearized driver is to move like: as its own linear part does, or with another resonance, which is put
/// before the predistorter as Linkwitz' equalizer,
///     T(s) = (s^2 + (w0/Q0) s + w0^2) / (s^2 + (wt/Qt) s + wt^2),
/// (f0, Q0) the driver's own (OwnLinearPart), (ft, Qt) the target's. The linearized driver has then the response of its
/// linear part times T: without inductance and creep exactly that of a driver that resonates at ft with Qt. These two
/// stay as they are, and so does the sensitivity above the resonance, as T goes to 1 there. At low frequencies T goes
/// to (f0/ft)^2, which is what an octave of extension costs: 12 dB of excursion and of voltage. Or its sound is
/// equalized in bands of a third of an octave (Equalizer), to what a band, some gains or a curve ask for. Sources: S.
/// Linkwitz, Wireless World, May and June 1980 (the equalizer); R. Small, J. AES 20(10), 1972 (the closed box).
struct Target {
    enum class Kind {
        own,        ///< the driver's own linear part
        resonance,  ///< that of frequency and quality
        closedBox,  ///< what the driver would have in a closed box of that volume
        flat,       ///< sound as loud as on average between `low` and `high`
        bands,      ///< the gains of `curve`
        response    ///< sound like `curve`, as loud as on average where that is given
    };
    Kind kind = Kind::own;
    double frequency = 40.0;  ///< Hz
    double quality = 0.707;
    double volume = 0.02;             ///< m^3 of air, without stuffing and leaks
    double low = 50.0, high = 500.0;  ///< Hz
    ThirdOctaves curve {};            ///< dB

    static constexpr double notGiven = -999.0;  ///< of a band of the curve
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

/// A curve in the bands of a target: the mean of its points in each third of an octave, what lies between its
/// neighbours, over the logarithm of the frequency, where there is none, and Target::notGiven beyond its ends.
/// @param frequency  Hz, ascending, positive; as many as levels
ThirdOctaves targetCurve(const std::vector<double>& frequency, const std::vector<double>& db);

/// What a loudspeaker moves and sounds like itself, and what can be put in its place.
struct OwnLinearPart {
    OwnLinearPart() = default;

    /// A driver's; its resonance is coneResonance().
    explicit OwnLinearPart(const Model&);

    /// @param motion  a loudspeaker's displacement per input at frequency, any unit
    /// @param own     what may be its resonance
    /// @param slow    the motion at 0 Hz
    void takeResonance(const std::function<std::complex<double>(double)>& motion, const Resonance& own, double slow);

    /// Nothing: the linear part departs from this resonance by more than 6 dB between a quarter of f0 and twice that,
    /// as in a vented box, where two resonances share the motion; then there is no other target than the own linear
    /// part.
    std::optional<Resonance> single;
    /// Vas = rho c^2 Sd^2/K, m^3: of air with the stiffness of the suspension; nothing where the area of the cone is
    /// not known.
    std::optional<double> suspensionVolume;
    std::optional<ThirdOctaves> sound;  ///< dB, of the level; nothing where the model does not tell a sound

    /// What is played for a target. A closed box adds the stiffness of its air,
    ///     ft = f0 sqrt(1 + Vas/V),   Qt = Q0 sqrt(1 + Vas/V).
    /// What require() refuses is not played: then it is the own one. Any thread.
    Resonance played(const Target&) const;

    /// The gains at the centres of the bands, dB. Beside the bands that are asked for half of the gain at their border,
    /// then none. Any thread.
    ThirdOctaves gains(const Target&) const;

    /// Throws Error (data): why this loudspeaker cannot be given this target; also where that is farther than by a
    /// factor of 8 from the own frequency, or takes a gain of more than 24 dB.
    void require(const Target&) const;

private:
    std::optional<Resonance> asked(const Target&) const;
    std::optional<ThirdOctaves> askedGains(const Target&) const;
};

}  // namespace excursion
