// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Check/PreparedTake.h"
#include "Engine/Diagnosis/Compare.h"
#include "Engine/Loudspeaker/Drift.h"

#include <string>
#include <vector>

namespace excursion {

/// A driver model whose drifting parameters were refitted to a new take, and how well it explained the take before and
/// after.
struct Adaptation {
    Drift drift;
    Comparison before, after;
    bool beyond = false;  ///< the cone goes farther than in the measurement of the laws
};

/// @param take   fit for use, of the same kind (with or without a coil) as the model; a short take or an impedance is
///               enough
/// @param names  parameters of the base; see driftingParameters()
/// Throws Error, see followDrift; (data) for a take of the other kind; (cancelled).
Adaptation adaptTo(const Model&, const PreparedTake&, const std::vector<std::string>& names, const Progress& = {});

/// A sentence for the user on how the error fell; empty if the noise is not known.
std::string sentenceOn(const Adaptation&);

/// Text for the user on what has drifted, and by how much: each parameter and figure then and now, and the coil's
/// temperature.
std::string wordsOn(const Adaptation&);

}  // namespace excursion
