// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/OpenModel.h"

#include "Engine/Fractional/FractionalStateSpaceFile.h"

#include <nlohmann/json.hpp>

namespace excursion::cli {

OpenModel openModel(const std::string& path)
{
    const auto document = readJson(path);
    const JsonField field(document, "", path);
    if (!field.has("format") || document.at("format") != "excursion-fractional-state-space")
        return {stateSpaceFromJson(field), 1.0, false};
    auto found = fractionalStateSpaceFromJson(field);
    return {{found.name, std::move(found.inputs), std::move(found.outputs), std::move(found.model.form), 0.0},
            found.model.alpha,
            true};
}

nlohmann::ordered_json documentOf(const OpenModel& open)
{
    const auto& named = open.named;
    return open.fractional
               ? toJson(NamedFractionalStateSpace {named.name, named.inputs, named.outputs, {open.alpha, named.model}})
               : toJson(named);
}

bool isStable(const OpenModel& open)
{
    return open.fractional ? isStable(FractionalStateSpace {open.alpha, open.named.model}) : isStable(open.named.model);
}

}  // namespace excursion::cli
