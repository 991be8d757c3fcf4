// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"

#include <string>

namespace excursion::cli {

/// The model of a driver: an "excursion-model", or of an "excursion-ladder" or the folder of one that of its last rung.
/// Throws Error (input) for anything else, (data) for a ladder without a model, whose take was not fit for use.
Model openDriver(const std::string& path);

}  // namespace excursion::cli
