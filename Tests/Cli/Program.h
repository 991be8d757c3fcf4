// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace excursion::test {

/// How a run of the program ended. A run that a signal ended has the code -signal.
struct Outcome {
    int code = 0;
    std::string out, err;
    bool spokeEarly = false;  ///< `early` was on stdout while the program was still at work
};

/// Runs the built `excursion` with these arguments. Its output goes through files beside `scratch`, as a pipe that
/// nobody empties would stop it.
/// @param early  a text to look for on stdout before the program ends
Outcome runProgram(const std::filesystem::path& scratch, const std::vector<std::string>& arguments,
                   const std::string& early = "");

/// Every file below a folder with its size and, of a folder, its name: what must be the same when nothing was written.
std::vector<std::string> contents(const std::filesystem::path& folder);

}  // namespace excursion::test
