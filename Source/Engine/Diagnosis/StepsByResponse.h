// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Diagnosis/Vote.h"
#include "Engine/Loudspeaker/Model.h"
#include "Engine/Progress.h"
#include "Engine/Take/Measurement.h"

#include <string>
#include <vector>

namespace excursion {

/// A model that has one effect more than another.
struct Step {
    std::string added;  ///< effect id
    Model model;
    Vote vote;  ///< on what that effect takes off the error here
};

/// The steps that lead from a model to all the linear effects that a frequency response shows, in the opposite order in
/// which they could go again: at each step the one that is missed least. Effects are searched for together: those that
/// have been found are the start for every other one, in the best orders, as a port behind a leaking box or beside a
/// swinging part may not lower the error before that other effect is in. Then those are taken out that the others can
/// do without, and those that stand for something else (isItself()).
/// @param base  fitted; what it has stays
std::vector<Step> stepsByResponse(const Model& base, const Spectra&, unsigned threads, const Progress& = {});

}  // namespace excursion
