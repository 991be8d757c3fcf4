// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Diagnosis/Ladder.h"

#include <string>
#include <string_view>
#include <vector>

namespace excursion {

/// Title of an effect of the catalogue; the id itself when the file knows an effect that this program does not.
std::string effectTitle(const std::string& id);

/// "start" for the first rung, "1 · Stiffness K(x)" for the next.
std::string rungTitle(const Ladder&, std::size_t rung);

/// The text with a capital at its head.
std::string capitalized(std::string_view);

/// Values times the factor of a display unit.
std::vector<double> scaled(const std::vector<double>&, double factor);
double largest(const std::vector<double>&);  ///< magnitude among the finite ones; 0 when there is none

}  // namespace excursion
