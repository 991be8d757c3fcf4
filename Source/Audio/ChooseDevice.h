// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Audio/Stream.h"

#include <string>
#include <vector>

namespace excursion::audio {

/// The device of that name, or that number in the list from 1, or the only one whose name contains the text, whatever
/// the case; a backend may stand before it ("JACK:system"). Throws Error (usage) with a sentence that lists the
/// devices.
const Device& chooseDevice(const std::vector<Device>&, const std::string& wanted);

/// Throws Error (usage) when the device has fewer inputs or outputs than that, or does not do the rate.
/// @param plan  for sentences: what asks for the rate
void requireFit(const Device&, int inputs, int outputs, double rate, const std::string& plan);

/// "44.1, 48 and 96 kHz".
std::string ratesText(const std::vector<double>& rates);

}  // namespace excursion::audio
