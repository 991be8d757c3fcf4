// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Estimate/Frf.h"
#include "Engine/Take/Measurement.h"

namespace excursion {

/// A channel's delay and polarity as the physics of a passive, electrodynamic loudspeaker tell them, without a
/// model of its nonlinearity and without trusting any of its parameters.
struct PhysicalDelay {
    double seconds = 0.0;  ///< the second channel is late against the first: positive
    double standardError = 0.0;
    bool clear = false;       ///< the delay cannot be explained by the loudspeaker
    bool inverted = false;    ///< the sign cannot be explained by the loudspeaker
    bool conclusive = false;  ///< the response was good enough to judge
    bool doubtful = false;    ///< something looks like a delay and may be none; else "not clear" is an acquittal
};

/// Current against voltage, from the electrical impedance above the resonance,
///     Z(s) exp(-s tau) = R + inductive(s) + c1/s + c2/s^2 + c3/s^3,
/// c/s^n being the tail of any motional impedance. A late current multiplies Z by exp(+s tau). Coils in iron have no
/// single law, so the inductive part is L s, K s^a, L s + K s^a and L s + R2 s/(s + p) in turn
/// (0.4 <= a <= 0.95; p within the band). A dispersive inductance resembles a delay over a narrow band; the
/// delay is clear only when all models that fit well agree on it, it turns the phase by 0.3 rad within the band,
/// exceeds 5 standard errors, and lets the error of the best model fall by 3 dB, by 10 dB when it turns the phase by
/// more than 2 rad, as a delay of that size leaves nothing in place. When less than 1.6 octaves lie above 2.5 times the
/// resonance, the fit begins at 1.7 times with a c4/s^4, and the error must fall by 6 dB.
/// Inverted: Re Z < 0 on most lines of the whole band, which no passive impedance can (Brune 1931).
/// @param admittance  current/voltage with its variance
PhysicalDelay currentDelay(const Frf& admittance);

/// What the cone's motion is referred to.
enum class MotionReference {
    force,   ///< current or force: a m s^2 law above resonance
    voltage  ///< the coil's impedance stands between, and blurs the verdict
};

/// Displacement, velocity or acceleration against its drive, above resonance and below the cone's breakup,
///     (drive/X)(s) exp(-s tau) = a s^2 + b s + c + d/s + e/s^2        (force, current; a = m/Bl > 0)
/// and for a voltage drive also with s^3 and s^2.6 (the inductance). Breakup starts where |drive/X| / w^2 leaves its
/// plateau: a delay does not touch magnitudes. When the band ends too near the resonance, the whole band is used with
/// a s^2 + b s + c + d log(s), d being creep and hysteresis. The delay is clear when it turns the phase by 0.2 rad
/// (voltage drive: 1 rad), exceeds 5 standard errors, lets the error fall by 4.5 dB (6 dB; both 10 dB beyond 2 rad),
/// and the lower 0.5 and 0.7 of the band say the same, as they do not when a mode of the cone turns the phase. Where
/// they hold too few lines to say anything, the error must fall by 10 dB, and nothing is said where it falls by less.
/// Where all lines, to the end of the band, show the corner of a sensor beside it (s^3 and s^4, which leave half of what
/// is left without them and at most 0.05), the delay is that beside the corner, if any. Inverted: a < 0.
/// @param motion  motion/drive with its variance
PhysicalDelay motionDelay(const Frf& motion, Quantity, MotionReference);

/// Whether the microphone turns the sign: the pressure of a piston is a positive multiple of its acceleration, delayed
/// by a time of flight, which is not judged. Said only when that law holds within 30 %.
/// @param pressure  pressure/motion with its variance
bool pressureIsInverted(const Frf& pressure, Quantity motion);

}  // namespace excursion
