// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Import/ReadTake.h"

#include "Engine/Document/TextFile.h"
#include "Engine/Error.h"
#include "Engine/Import/ImportMat.h"
#include "Engine/Import/ImportText.h"
#include "Engine/Take/TakeFile.h"

#include <utility>
#include <variant>

namespace excursion {

Take readTake(const std::filesystem::path& given)
{
    if (const auto json = headerOf(given); !json.empty())
        return readOwnTake(json).take;
    const auto extension = endingOf(given);
    if (extension == ".mat")
        return importMat(given, {});
    sizeOfFile(given);  // a path that does not exist deserves to be told so first
    if (extension == ".wav" || extension == ".flac" || extension == ".aif" || extension == ".aiff"
        || extension == ".caf")
        throw Error(
            Error::Kind::input,
            "'" + given.string()
                + "' is a recording, not a take yet; make one of it and of the plan that was played: excursion import '"
                + given.string() + "' --plan plan --map 1=voltage:32 --map 2=current:4 --out take.");
    return importText(given);
}

Measurement readMeasurement(const std::filesystem::path& path)
{
    auto take = readTake(path);
    if (auto* measurement = std::get_if<Measurement>(&take))
        return std::move(*measurement);
    throw Error(Error::Kind::data, "'" + path.string()
                                       + "' is a frequency response, but this verb needs the samples of a take; "
                                         "identify, fit, compare, diagnose, add, improve and bla "
                                         "work on a response.");
}

SweepTake readSweepTake(const std::filesystem::path& path)
{
    if (const auto json = headerOf(path); !json.empty())
        return readOwnTake(json);
    return {readMeasurement(path), std::nullopt};
}

}  // namespace excursion
