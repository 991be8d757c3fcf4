// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

namespace excursion {

/// The page's style sheet: one column of text, one colour a role (light, dark and on paper), figures that line up.
std::string_view pageStyle();

}  // namespace excursion
