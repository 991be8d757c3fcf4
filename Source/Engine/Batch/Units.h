// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Diagnosis/LadderFile.h"

#include <filesystem>
#include <string>
#include <vector>

namespace excursion {

/// One loudspeaker of a batch: the ladder that was made of it.
struct Unit {
    std::string name;  ///< of the folder that holds the ladder
    LadderFile file;

    bool measured() const { return !file.ladder.rungs.empty(); }  ///< its take was fit for use
};

/// A ladder that could not be read, or a folder that has none.
struct Unread {
    std::string name, why;
};

struct Units {
    std::vector<Unit> units;
    std::vector<Unread> unread;
};

enum class UnitOrder { byName, asGiven };

struct ReadUnitsOptions {
    UnitOrder order = UnitOrder::byName;  ///< by name: digits in it count as numbers, so that 9 comes before 10, and
                                          ///< times as ISO 8601 writes them in order
    bool goOn = false;                    ///< what cannot be read is told in `unread`; else it throws
};

/// Reads ladders as improve() leaves them.
/// @param places  folders that hold a ladder.json, folders of such folders (those in them without a ladder are told in
/// `unread`), or ladder.json files
/// @throws Error (input) for a place that is not there or holds no ladder, for a ladder that cannot be read unless
/// `goOn`, and for two units of one name
Units readUnits(const std::vector<std::filesystem::path>& places, const ReadUnitsOptions& = {});

/// Whether one name comes before another one, digits as numbers.
bool nameBefore(const std::string&, const std::string&);

}  // namespace excursion
