// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Diagnosis/Vote.h"
#include "Engine/Loudspeaker/Model.h"
#include "Engine/Progress.h"
#include "Engine/Take/Measurement.h"

#include <string>
#include <vector>

namespace excursion {

/// A model with one more effect than the previous one.
struct Step {
    std::string added;  ///< effect id
    Model model;
    Vote vote;  ///< on how much the effect reduces the error here
};

/// The steps that lead from a model to all the linear effects that a frequency response shows. Their order is the
/// reverse of removing the effects one by one, each time the one that is missed least. Effects are searched for
/// together: those already found are the start for every other one, in the best orders. A port behind a leaking box or
/// beside a swinging part, for example, may not lower the error before that other effect is in. Then effects that the
/// others can replace are removed, and those that stand for something else (isItself()).
/// @param base  fitted; its effects stay
std::vector<Step> stepsByResponse(const Model& base, const Spectra&, unsigned threads, const Progress& = {});

}  // namespace excursion
