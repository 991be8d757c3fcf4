// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/KnownMotion.h"

namespace excursion::cli {

void addMotionOptions(CLI::App& verb, KnownScale& known)
{
    verb.add_option("--mass", known.mass, "moving mass in kg, where voltage and current alone do not show it");
    verb.add_option("--bl", known.forceFactor, "force factor in N/A, in place of the mass");
}

std::string guessedMotion(const std::string& what)
{
    return what + " is in a unit of its own: voltage and current alone do not show how far the cone moves, and the "
           + "moving mass is a guess. Give --mass or --bl.";
}

}  // namespace excursion::cli
