// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Import/CurveTable.h"

#include "Engine/Error.h"
#include "Engine/Import/PlainText.h"

#include <algorithm>

namespace excursion {

TextTable readCurveTable(const std::filesystem::path& path, std::size_t columns, const std::string& expected)
{
    const auto refuse = [&](const std::string& why) {
        throw Error(Error::Kind::input, "'" + path.string() + "' " + why);
    };
    TextTable table(readPlainText(path), path.string());
    const auto all = table.titles().size();
    if (all < 2 || table.rows() < 2)
        refuse("has " + std::to_string(table.rows()) + " lines of " + std::to_string(all) + " numbers; " + expected
               + ".");
    const auto frequency = table.column(0);
    for (std::size_t c = 1; c < std::min(columns, all); ++c)
        if (table.column(c).size() != frequency.size())
            refuse("has columns of different lengths.");
    for (std::size_t k = 0; k < frequency.size(); ++k)
        if (!(frequency[k] > (k == 0 ? 0.0 : frequency[k - 1])))
            refuse("has a frequency that is not positive or not above the one before it in line "
                   + std::to_string(table.lineOf(k)) + ".");
    return table;
}

}  // namespace excursion
