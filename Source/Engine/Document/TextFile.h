// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

namespace excursion {

/// The bytes of a text file, without a UTF-8 byte order mark. Throws Error (input) with one sentence when
/// the path is not a readable file, is empty, or is larger than `mostBytes`.
std::string readText(const std::filesystem::path&, std::uintmax_t mostBytes = 1u << 30);

/// What a file's name ends in, with the dot and in lower case: ".csv"; empty without one.
std::string endingOf(const std::filesystem::path&);

/// Throws Error (input) unless the path is a regular file of at least one byte; returns its size.
std::uintmax_t sizeOfFile(const std::filesystem::path&);

}  // namespace excursion
