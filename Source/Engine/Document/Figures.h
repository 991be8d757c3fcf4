// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace excursion {

/// The shortest text that reads back as the same double.
std::string shortestText(double);

/// Numbers within a sentence, in plain ASCII.
std::string figure(double value, const char* format = "%.1f");
std::string frequencyText(double hertz);                       ///< "47 Hz", "1.2 kHz"
std::string placeText(double value, const std::string& unit);  ///< "+3.1 mm", "-0.4 m/s"

}  // namespace excursion
