// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Take/Measurement.h"

#include <string>

namespace excursion {

/// The channel that a user calls by its quantity, such as "current". Throws Error (usage) when the take has none of
/// that name.
const Channel& channelNamed(const Measurement&, const std::string& name);
const Spectra::Channel& channelNamed(const Spectra&, const std::string& name);

/// The channel of that name; without a name the first that is not `input`. Throws Error as above, and (data) when there
/// is none beside the input.
const Channel& outputNamed(const Measurement&, const std::string& name, Quantity input);
const Spectra::Channel& outputNamed(const Spectra&, const std::string& name, Quantity input);

}  // namespace excursion
