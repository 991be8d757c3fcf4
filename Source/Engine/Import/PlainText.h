// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace excursion {

/// The text of a file that another program wrote, as UTF-8 with line feeds alone. UTF-16 is known by its byte order
/// mark or by the zero bytes that it has beside every letter; what is not valid UTF-8 is read as Latin-1. Throws Error
/// (input) with one sentence when the bytes are no text.
std::string plainText(std::string_view bytes, const std::string& source);

/// The same of a file (see readText for what is refused).
std::string readPlainText(const std::filesystem::path&, std::uintmax_t mostBytes = std::uintmax_t(1) << 30);

}  // namespace excursion
