// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <utility>

namespace excursion {

/// What isValid(std::string* reason) of options and models returns where something is wrong: false, and one sentence in
/// `reason` where that is not null.
inline bool refuse(std::string* reason, std::string sentence)
{
    if (reason)
        *reason = std::move(sentence);
    return false;
}

}  // namespace excursion
