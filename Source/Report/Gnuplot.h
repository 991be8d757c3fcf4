// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace excursion {

/// Runs gnuplot with this script on its standard input and returns what it prints. Nothing passes through a shell or a
/// file. Throws Error (numerical) with a sentence that says what to install when gnuplot is missing, or what it
/// complained of.
std::string runGnuplot(const std::string& script);

}  // namespace excursion
