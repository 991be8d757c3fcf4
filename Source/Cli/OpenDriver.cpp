// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/OpenDriver.h"

#include "Engine/Diagnosis/LadderFile.h"
#include "Engine/Error.h"
#include "Engine/Loudspeaker/ModelFile.h"

#include <filesystem>

namespace excursion::cli {

Model openDriver(const std::string& path)
{
    std::error_code ignored;
    const auto file = std::filesystem::is_directory(path, ignored)
                          ? (std::filesystem::path(path) / "ladder.json").string()
                          : path;
    const auto document = readJson(file);
    const JsonField field(document, "", file);
    if (!field.has("format") || field.at("format").value() != "excursion-ladder")
        return modelFromJson(field);
    auto ladder = ladderFromJson(document, file).ladder;
    if (ladder.rungs.empty())
        throw Error(Error::Kind::data, "'" + file + "' holds no model: " + ladder.sentence);
    return ladder.model();
}

}  // namespace excursion::cli
