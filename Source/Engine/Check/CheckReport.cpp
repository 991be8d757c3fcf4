// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Check/CheckReport.h"

#include <algorithm>

namespace excursion {

bool CheckReport::fitForUse() const
{
    return std::none_of(problems.begin(), problems.end(), [](const Problem& p) { return p.fatal; });
}

std::string CheckReport::verdict() const
{
    const auto fatal = std::count_if(problems.begin(), problems.end(), [](const Problem& p) { return p.fatal; });
    if (fatal > 0)
        return "The take is not fit for use. " + problems.front().sentence;
    if (problems.empty())
        return "The take is fit for use.";
    return "The take is fit for use, with " + std::to_string(problems.size())
           + (problems.size() == 1 ? " remark." : " remarks.");
}

}  // namespace excursion
