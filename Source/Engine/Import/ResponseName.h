// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Take/Measurement.h"

#include <optional>
#include <string>
#include <string_view>

namespace excursion {

/// What a complex column over frequency is: a response, output over input, or the spectrum of one quantity.
struct ResponseName {
    Quantity output = Quantity::voltage;
    std::optional<Quantity> input;  ///< absent: a spectrum

    bool operator==(const ResponseName&) const = default;
    bool isImpedance() const { return output == Quantity::voltage && input == Quantity::current; }
};

/// "impedance" (voltage/current), "admittance" (current/voltage), "displacement/voltage", "x/u", "pressure"; also
/// "response", as others call the sound pressure of a loudspeaker: pressure/voltage. nullopt when it is none of these.
std::optional<ResponseName> responseNamed(std::string_view);

/// "impedance" or "displacement/voltage".
std::string textOf(const ResponseName&);

enum class ResponsePart { real, imaginary, magnitude, decibels, phase };

/// "re", "im", "magnitude" (mag, abs), "dB", "phase", in any case.
std::optional<ResponsePart> responsePartNamed(std::string_view);

/// What a number in a unit is multiplied by: to SI of a real part, imaginary part or magnitude; to rad of a phase
/// (default degrees). Of decibels it is what 0 dB stands for, in SI: the unit says it ("mm/V"), and that of a sound
/// pressure is 20 uPa by default. nullopt when the unit does not suit.
std::optional<double> responseScale(const ResponseName&, ResponsePart, std::string_view unit);

/// "ohm, kohm or V/A": for sentences.
std::string acceptedUnits(const ResponseName&, ResponsePart);

/// "dB", "dBSPL", "dB SPL", "dB re 20 uPa", ... ; isSoundLevel: those whose 0 dB is 20 uPa.
bool isDecibel(std::string_view unit);
bool isSoundLevel(std::string_view unit);

/// The only ratio whose unit this is: "mm/V" is displacement/voltage. nullopt when it is none, or more than one.
std::optional<ResponseName> ratioOfUnit(std::string_view);

}  // namespace excursion
