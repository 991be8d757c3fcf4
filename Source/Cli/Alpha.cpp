// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/Alpha.h"

#include "Cli/Terminal.h"

#include "Engine/Error.h"

#include <charconv>
#include <cmath>

namespace excursion::cli {

std::optional<double> alphaFrom(const std::string& text)
{
    if (text == "free")
        return std::nullopt;
    double alpha = 0.0;
    const auto end = text.data() + text.size();
    if (const auto read = std::from_chars(text.data(), end, alpha);
        read.ec != std::errc {} || read.ptr != end || !(alpha > 0.0 && alpha < 2.0))
        throw Error(Error::Kind::usage, "--alpha is \"" + text + "\", expected a number between 0 and 2, or free.");
    return alpha;
}

std::string withError(double value, double standardError)
{
    return significant(value, 5)
           + (std::isfinite(standardError) && standardError > 0.0 ? " +- " + significant(standardError, 2) : "");
}

}  // namespace excursion::cli
