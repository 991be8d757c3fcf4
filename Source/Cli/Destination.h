// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace excursion::cli {

/// Asked before long work, so that nobody waits for minutes to learn that the result has no place.
/// Both throw Error (input) and create nothing.
void requireFilePlace(const std::string& file);  ///< a file can be written there
/// it is a folder that files can be written to, or can become one
void requireFolderPlace(const std::string& folder);

/// Throws Error (usage) if writing to `written`, a file or the folder of a take, would replace `read`: a file, or a
/// take, plan, ladder or model in a folder.
void requireApart(const std::string& read, const std::string& written);

}  // namespace excursion::cli
