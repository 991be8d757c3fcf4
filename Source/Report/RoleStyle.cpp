// SPDX-License-Identifier: GPL-3.0-or-later
#include "Report/RoleStyle.h"

#include <array>

namespace excursion {

const RoleStyle& styleOf(Role role)
{
    static const std::array<RoleStyle, 7> styles {{{{1, 2, 10, "--measured"}, 1, 2.4},
                                                   {{1, 2, 11, "--model"}, 1, 1.2},
                                                   {{1, 2, 12, "--error"}, 1, 1.3},
                                                   {{1, 2, 13, "--noise"}, 3, 1.2},
                                                   {{1, 2, 14, "--before"}, 1, 1.6},
                                                   {{1, 2, 15, "--after"}, 1, 1.8},
                                                   {{1, 2, 16, "--reference"}, 2, 1.2}}};
    return styles[static_cast<std::size_t>(role)];
}

}  // namespace excursion
