// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Import/LevelCurve.h"

#include "Engine/Error.h"
#include "Engine/Import/CurveTable.h"

#include <string>

namespace excursion {

LevelCurve readLevelCurve(const std::filesystem::path& path)
{
    const auto table = readCurveTable(path, 2, "a curve has frequencies in Hz and levels in dB");
    LevelCurve curve {table.column(0), table.column(1)};
    for (std::size_t k = 0; k < curve.db.size(); ++k)
        if (!(curve.db[k] >= -200.0 && curve.db[k] <= 300.0))
            throw Error(Error::Kind::input, "'" + path.string() + "' has a level in line "
                                                + std::to_string(table.lineOf(k))
                                                + " that is none: dB between -200 and 300 are expected.");
    return curve;
}

}  // namespace excursion
