// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Import/LevelCurve.h"

#include "Engine/Error.h"
#include "Engine/Import/PlainText.h"
#include "Engine/Import/TextTable.h"

#include <cmath>
#include <string>

namespace excursion {

LevelCurve readLevelCurve(const std::filesystem::path& path)
{
    const auto refuse = [&](const std::string& why) {
        throw Error(Error::Kind::input, "'" + path.string() + "' " + why);
    };
    const TextTable table(readPlainText(path), path.string());
    if (table.titles().size() < 2 || table.rows() < 2)
        refuse("has " + std::to_string(table.rows()) + " lines of " + std::to_string(table.titles().size())
               + " numbers; a curve has frequencies in Hz and levels in dB.");
    LevelCurve curve {table.column(0), table.column(1)};
    if (curve.db.size() != curve.frequency.size())
        refuse("has columns of different lengths.");
    for (std::size_t k = 0; k < curve.frequency.size(); ++k) {
        if (!(curve.frequency[k] > (k == 0 ? 0.0 : curve.frequency[k - 1])))
            refuse("has a frequency that is not positive or not above the one before it in line "
                   + std::to_string(table.lineOf(k)) + ".");
        if (!(curve.db[k] >= -200.0 && curve.db[k] <= 300.0))
            refuse("has a level in line " + std::to_string(table.lineOf(k))
                   + " that is none: dB between -200 and 300 are expected.");
    }
    return curve;
}

}  // namespace excursion
