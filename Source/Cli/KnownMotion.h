// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Datasheet/KnownScale.h"

#include <CLI/CLI.hpp>

#include <string>

namespace excursion::cli {

/// --mass and --bl: what a take of voltage and current alone does not show.
void addMotionOptions(CLI::App&, KnownScale&);

/// What to say of results in metres where the motion is a guess.
/// @param what  the subject: "The displacement"
std::string guessedMotion(const std::string& what);

}  // namespace excursion::cli
