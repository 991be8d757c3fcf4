// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace excursion {

/// "[Hz]" or "(Hz)" without its brackets.
std::string withoutBrackets(std::string_view);

/// Units of a frequency, a time, an angle (in rad) and a resistance (in ohm); nullopt when it is none. Case counts
/// where kilo and milli hang on it.
std::optional<double> frequencyUnit(std::string_view);
std::optional<double> timeUnit(std::string_view);
std::optional<double> angleUnit(std::string_view);
std::optional<double> resistanceUnit(std::string_view);

}  // namespace excursion
