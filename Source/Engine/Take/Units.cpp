// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Take/Units.h"

#include <algorithm>
#include <cctype>

namespace excursion {
namespace {

struct UnitEntry {
    Quantity quantity;
    std::string_view written, unit;
    double factor;
    bool listed;  ///< named in sentences; the others are further spellings
};

using enum Quantity;
constexpr UnitEntry unitEntries[] {
    {voltage, "V", "V", 1, true},
    {voltage, "mV", "V", 1e-3, true},
    {current, "A", "A", 1, true},
    {current, "mA", "A", 1e-3, true},
    {displacement, "m", "m", 1, true},
    {displacement, "mm", "m", 1e-3, true},
    {displacement, "um", "m", 1e-6, true},
    {displacement, "\u00b5m", "m", 1e-6, false},  // micro sign
    {displacement, "\u03bcm", "m", 1e-6, false},  // Greek mu
    {displacement, "cm", "m", 1e-2, false},
    {displacement, "V", "V", 1, true},
    {velocity, "m/s", "m/s", 1, true},
    {velocity, "mm/s", "m/s", 1e-3, true},
    {velocity, "mps", "m/s", 1, false},
    {velocity, "mmps", "m/s", 1e-3, false},
    {acceleration, "m/s^2", "m/s^2", 1, true},
    {acceleration, "m/s2", "m/s^2", 1, false},
    {acceleration, "m/s\u00b2", "m/s^2", 1, false},
    {acceleration, "mps2", "m/s^2", 1, false},
    {acceleration, "g", "m/s^2", 9.80665, true},
    {pressure, "Pa", "Pa", 1, true},
    {pressure, "mPa", "Pa", 1e-3, true},
    {pressure, "kPa", "Pa", 1e3, true},
    {pressure, "uPa", "Pa", 1e-6, false},
    {pressure, "\u00b5Pa", "Pa", 1e-6, false},
    {pressure, "\u03bcPa", "Pa", 1e-6, false},
    {force, "N", "N", 1, true},
    {force, "mN", "N", 1e-3, true},
    {force, "V", "V", 1, true},
};

/// A capital M is mega: "MV" is not "mV".
bool sameButForCase(std::string_view a, std::string_view b)
{
    if (a.size() > 1 && b.size() > 1 && a.front() == 'm' && b.front() == 'M'
        && (a[1] == 'V' || a[1] == 'A' || a[1] == 'P' || a[1] == 'N'))
        return false;
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](unsigned char x, unsigned char y) {
        return std::tolower(x) == std::tolower(y);  // ASCII letters; bytes beyond are left alone by the C locale
    });
}

}  // namespace

std::optional<UnitScale> unitNamed(Quantity quantity, std::string_view text)
{
    for (const bool exact : {true, false})
        for (const auto& entry : unitEntries)
            if (entry.quantity == quantity && (exact ? entry.written == text : sameButForCase(entry.written, text)))
                return UnitScale {std::string(entry.unit), entry.factor};
    return std::nullopt;
}

std::string acceptedUnits(Quantity quantity)
{
    std::vector<std::string> units;
    for (const auto& entry : unitEntries)
        if (entry.quantity == quantity && entry.listed)
            units.emplace_back(entry.written);
    std::string text = units.front();
    for (std::size_t i = 1; i < units.size(); ++i)
        text += (i + 1 == units.size() ? " or " : ", ") + units[i];
    return text;
}

}  // namespace excursion
