// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Take/Measurement.h"

#include <optional>
#include <string>
#include <string_view>

namespace excursion {

/// What a unit in a file means: `unit` is what Channel::unit becomes, `factor` turns a number in the
/// file's unit into that one.
struct UnitScale {
    std::string unit;
    double factor = 1.0;
};

/// The units that files may give for a quantity: its SI unit and a few common multiples ("mm", "mV",
/// "kPa", ...), and "V" for the force and displacement of an electrical analogue. Matched exactly;
/// when nothing matches exactly, without regard to case ("current_a"). nullopt: not accepted.
std::optional<UnitScale> unitNamed(Quantity, std::string_view);

/// "m, mm, um or V": for sentences that refuse a unit.
std::string acceptedUnits(Quantity);

}  // namespace excursion
