// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CLI/CLI.hpp>

#include <string>

namespace excursion::cli {

/// The manual page, as man(7) wants it, with all verbs and their options as they are registered.
std::string manualOf(const CLI::App&, const std::string& version);

/// A script for bash that completes verbs, options, choices, effects and files.
std::string bashCompletionOf(const CLI::App&);

}  // namespace excursion::cli
