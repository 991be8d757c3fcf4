// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

namespace excursion {

/// A number and its unit as an engineer writes them: 14.35 g, 266 µH, 132 cm², 1.85 kN/m.

/// The unit to show numbers of about this size in: shown = value * factor.
struct DisplayUnit {
    double factor = 1.0;
    std::string unit;  ///< typeset, UTF-8: "µH", "N·s/m", "Ω"
};

/// @param size  the largest of the numbers
/// @param unit  as in the files: "H", "kg", "N/A", "N s/m", "m^2", "ohm s^a"; "1" or empty for a pure number
DisplayUnit displayUnit(double size, std::string_view unit);

/// "ohm s^a" as Ω·s^a, "m^2" as m².
std::string typesetUnit(std::string_view unit);

/// "14.35 g" with so many significant digits; "unknown" when not finite.
std::string engineering(double value, std::string_view unit, int digits = 4);

/// "48 kHz", "1.7 V": a setting, with no more digits than it needs.
std::string nominal(double value, std::string_view unit);

/// "14.35 ± 0.03 g", as many decimals as the error's second digit; without the error when that is not known.
std::string withError(double value, double standardError, std::string_view unit);

/// Locale-free numbers. A minus is a true minus sign in typeset text.
std::string plainText(double value, int decimals);  ///< "-61.0", with a hyphen, as terminals and documents have it
std::string fixedText(double value, int decimals);
std::string decibels(double value);  ///< "−61.0 dB", an en dash when not finite

}  // namespace excursion
