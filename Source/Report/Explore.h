// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

namespace excursion {

/// The script of a page, Explore/*.js one after the other: pictures tell their values under the pointer, are zoomed,
/// and what they have in common is switched on and off. It reads the element `curves`, see curveData().
std::string_view exploreScript();

}  // namespace excursion
