// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/BlackBox/BlackBoxRehearsal.h"
#include "Engine/Progress.h"

#include <optional>
#include <string>

namespace excursion {

/// A black box that is ready to be played, and to be inverted where that helps: what is found out once, before any
/// signal is touched, and serves any number of channels.
struct PlayedBox {
    /// Rehearses. Throws Error (data) for a model that runs away or does not come to rest, (cancelled).
    explicit PlayedBox(const BlackBox&, const Progress& = {});

    BlackBox box;
    Region region;
    Rest rest;
    std::optional<BlackBoxRehearsal> rehearsal;  ///< none where inverting it does not help
    std::string refusal;                         ///< then why, one sentence
    /// input's unit per output's unit: rms of the stimulus over the rms that the linear part makes of it. Times this,
    /// the output is as loud as the signal was under the fit.
    double perOutput = 0.0;
};

/// The excursion up to which the fit has been, m; infinite where the model tells none.
double measuredDisplacement(const PlayedBox&);

/// For a person, before it is used: what the model is, the distortion that it makes as it was fitted, what is left of
/// it with the correction and the gain, in dB, or why there is none; and that a current is not the sound.
std::string wordsOf(const PlayedBox&);

/// What is protected while it is linearized, and what cannot be as the model does not tell it.
std::string protectionOf(const PlayedBox&, double coilResistance);

}  // namespace excursion
