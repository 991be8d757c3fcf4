// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

namespace excursion::cli {

/// --alpha: a number, or nothing for "free". Throws Error (usage) for anything else.
std::optional<double> alphaFrom(const std::string&);

/// "0.5006 +- 0.001"; without the error where it is not known.
std::string withError(double value, double standardError);

}  // namespace excursion::cli
