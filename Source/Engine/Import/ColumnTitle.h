// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Import/ColumnUnits.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace excursion {

/// A column's title, taken apart: "Voltage (mV)", "x [mm]", "f/Hz", "displacement_mm", "|Z|(ohm)", "SPL(dB)", "Ohm".
struct ColumnTitle {
    std::string name;                ///< without the unit
    std::string unit;                ///< as it is written; empty: none
    std::vector<std::string> words;  ///< of the name, in lower case

    bool has(std::string_view word) const;
};

ColumnTitle columnTitle(std::string_view);

/// Whether a text is the unit of anything that files of measurements hold: Hz, s, degrees, decibels, ohm, a quantity or
/// a ratio of two.
bool isUnit(std::string_view);

/// Hz (and s) for each unit of a column that is a frequency (or a time); nullopt when it is none.
std::optional<double> frequencyFactor(const ColumnTitle&);
std::optional<double> timeFactor(const ColumnTitle&);

}  // namespace excursion
