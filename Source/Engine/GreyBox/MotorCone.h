// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Linear/Identify.h"

#include <string>
#include <vector>

namespace excursion {

/// What a cone's response is made of, see MotorConeOptions.
enum class ConeFrom {
    /// from the motor where the sum of |e|^2/deviation^2 over K lines is no more than K + 5 K^1/2, else from the
    /// quotient
    automatic,
    quotient,  ///< P/X where X is told
    motor      ///< P/(s^2 motor)
};

/// A loudspeaker as two linear systems in cascade ([B 4.5], which proposes it and goes no further): the motor turns
/// voltage into displacement, the cone turns the displacement into pressure, or into the acceleration of some point of
/// it. Each is of lower order than the whole, and the states of the motor are physical ones, so that laws along the
/// displacement can be put where they belong.
///     X/U = motor(s),  P/X = s^2 cone(s),  P/U = cone(s) s^2 motor(s)
/// What sound a cone radiates goes with its acceleration, so the cone is proper only as seen from there: its input is
/// the acceleration s^2 x, which a motor has among its states, or as a sum of them, when its displacement falls at
/// least as s^-2. That is kept exactly in the fit (RelativeDegree.h).
///
/// The cone's response is the quotient of both measured ones, which takes over no error of the motor's model. With
/// relative deviations r_p and r_x of pressure and displacement its deviation is |P/X| (r_p^2 + r_x^2)^1/2, as if the
/// noise of both were independent: noise of the voltage, which they share, cancels in the quotient and is overstated.
/// Where the motor explains the displacement down to its noise, its model knows the displacement better than any one
/// line of it, and the pressure over s^2 motor is the better response, of deviation |P/X| r_p. Then both are refined to
/// the maximum of their joint likelihood (CascadeRefinement.h): the motor learns from the pressure, too. A cone of too
/// low an order would teach it wrongly; if the motor comes out explaining the displacement no more, what was found
/// before is kept.
///
/// A displacement falls with 12 or 18 dB an octave and soon drowns in the noise of its sensor. Where the motor's model
/// stands less than `leastSignalDb` above that noise the split cannot be told: the quotient would be biased, by
/// exp(-|X|^2/deviation^2) of itself. There the pressure over the motor's model takes its place in any case, so the
/// cascade follows the pressure; what is the motor's and what the cone's rests on the model alone. Beside the quotient
/// such a line counts with the relative error of the motor, rms over the lines that are told, as its r_x.
struct MotorConeOptions {
    int motorOrder = 3, coneOrder = 10;
    int relativeDegree = 3;  ///< of voltage to displacement: 3 with an inductance that counts, else 2
    ConeFrom from = ConeFrom::automatic;
    double leastSignalDb = 10.0;  ///< of the displacement over its noise
    double delay = 0.0;           ///< s, of the sound on its way; it is taken off the pressure first
    bool thorough = true;         ///< as IdentifyOptions::thorough
    PoleRefinementOptions refinement;

    bool isValid(std::string* reason = nullptr) const;
};

struct MotorCone {
    /// Continuous time, V to (m, m/s, m/s^2). Its first states are displacement, velocity and, with relative degree 3,
    /// acceleration. The current is a sum of those three, which one and only one mass and force factor tells.
    StateSpace motor;
    StateSpace cone;     ///< continuous time, m/s^2 to the unit of the pressure
    StateSpace cascade;  ///< V to the unit of the pressure, without the delay

    double motorErrorDb = 0.0;  ///< unweighted relative rms errors [B 4.26]: of the displacement,
    double coneErrorDb = 0.0;   ///< of the cone to its response,
    double errorDb = 0.0;       ///< of the cascade to the pressure
    /// as LinearIdentification's, of motor and cascade; NaN without deviations
    double motorChiSquared = 0.0, chiSquared = 0.0;

    FrequencyData coneResponse;                     ///< what the cone was fitted to
    ConeFrom from = ConeFrom::quotient;             ///< where that came from
    bool refined = false;                           ///< together; false where that was not done, or not kept
    std::vector<bool> told;                         ///< one a line: displacement above its noise
    double toldUpTo = 0.0;                          ///< Hz, the highest line that is told; 0 if none is
    bool stable = false;                            ///< motor and cone
    SearchSummary motorRefinement, coneRefinement;  ///< the same where both were refined together
    std::string sentence;                           ///< how far the split can be told
};

/// @param displacement  voltage to displacement, m/V, one input and output
/// @param pressure      voltage to pressure (Pa/V), or to acceleration, at the same frequencies, which are all above 0
/// Hz
/// Throws Error (usage) for options that make no sense, (data) for responses that do not go together, or when fewer
/// lines are told than the cone's order asks for, and as identify() does.
MotorCone identifyMotorCone(const FrequencyData& displacement, const FrequencyData& pressure,
                            const MotorConeOptions& = {}, const Progress& = {});

}  // namespace excursion
