// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Check/PreparedTake.h"
#include "Engine/Diagnosis/Compare.h"
#include "Engine/Loudspeaker/Drift.h"

#include <string>
#include <vector>

namespace excursion {

/// A driver's model that has followed what drifted since it was fitted, and how well it explained a new take before and
/// after.
struct Adaptation {
    Drift drift;
    Comparison before, after;
    bool beyond = false;  ///< the cone goes farther than the laws were measured
};

/// @param take   fit for use, of the same kind (with or without a coil) as the model; a short one, or an impedance,
/// will
///               do
/// @param names  of parameters of the base; see driftingParameters()
/// Throws Error, see followDrift; (data) for a take of the other kind; (cancelled).
Adaptation adaptTo(const Model&, const PreparedTake&, const std::vector<std::string>& names, const Progress& = {});

/// What a person should know of how the error fell; empty where the noise is not known.
std::string sentenceOn(const Adaptation&);

/// What has drifted, and by how much, for a person: each parameter and figure then and now, and the coil's
/// temperature.
std::string wordsOn(const Adaptation&);

}  // namespace excursion
