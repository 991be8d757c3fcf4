// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/BlackBox/BlackBoxRehearsal.h"
#include "Engine/Progress.h"

#include <optional>
#include <string>

namespace excursion {

/// A black box that is ready to be played, and to be inverted if that helps. It is made once, before any signal is
/// processed, and serves any number of channels.
struct PlayedBox {
    /// Rehearses. Throws Error (data) for a model that runs away or does not come to rest, (cancelled).
    explicit PlayedBox(const BlackBox&, const Progress& = {});

    BlackBox box;
    Region region;
    Rest rest;
    std::optional<BlackBoxRehearsal> rehearsal;  ///< none if inverting it does not help
    std::string refusal;                         ///< then the reason, one sentence
    /// input's unit per output's unit: rms of the stimulus over the rms of the linear part's response to it. The output
    /// times this is as loud as the signal was in the fit.
    double perOutput = 0.0;
};

/// The largest excursion of the fit, m; infinite if the model gives none.
double measuredDisplacement(const PlayedBox&);

/// Text for the user, before the model is used: the model's class, its distortion under the stimulus of the fit, the
/// distortion left with the correction and the gain, in dB, or why there is none; and that a current is not the sound.
std::string wordsOf(const PlayedBox&);

/// Text on what is protected during linearization, and what cannot be because the model does not give it.
std::string protectionOf(const PlayedBox&, double coilResistance);

}  // namespace excursion
