// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/BlackBox/BlackBoxFile.h"

#include "Engine/Error.h"
#include "Engine/Polynomial/Block/BlockModelFile.h"
#include "Engine/Polynomial/FractionalPnlss/FractionalPnlssFile.h"
#include "Engine/Polynomial/Hammerstein/ParallelHammersteinFile.h"
#include "Engine/Polynomial/Narx/NarxFile.h"
#include "Engine/Polynomial/Pnlss/PnlssFile.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>

namespace excursion {
namespace {

constexpr std::array playableFormats {"excursion-pnlss", "excursion-fractional-pnlss", "excursion-block-model",
                                      "excursion-parallel-hammerstein", "excursion-narx"};

void nameAs(BlackBox& box, const std::string& name, const std::string& input, const std::string& output)
{
    box.name = name;
    box.input = input;
    box.output = output;
}

template <class Model>
BlackBox boxOf(const Named<Model>& named)
{
    auto box = blackBoxOf(named.model);
    nameAs(box, named.name, named.input, named.output);
    return box;
}

}  // namespace

bool isBlackBox(const JsonField& document)
{
    if (!document.has("format") || !document.at("format").value().is_string())
        return false;
    const auto format = document.at("format").value().get<std::string>();
    return std::find(playableFormats.begin(), playableFormats.end(), format) != playableFormats.end();
}

BlackBox blackBoxFromJson(const JsonField& document)
{
    const auto format = document.at("format").oneOf({playableFormats.begin(), playableFormats.end()});
    const auto stimulus = stimulusFrom(document);
    if (!stimulus)
        throw Error(
            Error::Kind::data,
            "'" + document.source()
                + "' does not say at which level and in which band it was fitted (the field stimulus), so nobody "
                  "knows how far it holds: fit it again with excursion pnlss or excursion rank --keep.");
    BlackBox box;
    if (format == "excursion-pnlss") {
        const auto named = pnlssFromJson(document);
        box = blackBoxOf(named.model);
        nameAs(box, named.name, named.inputs.front(), named.outputs.front());
    } else if (format == "excursion-fractional-pnlss") {
        const auto named = fractionalPnlssFromJson(document);
        box = blackBoxOf(named.model, named.grid);
        nameAs(box, named.name, named.inputs.front(), named.outputs.front());
    } else if (format == "excursion-block-model") {
        box = boxOf(blockModelFromJson(document));
    } else if (format == "excursion-narx") {
        box = boxOf(narxFromJson(document));
    } else {
        const auto named = parallelHammersteinFromJson(document);
        box = blackBoxOf(named.model, *stimulus);
        nameAs(box, named.name, named.input, named.output);
    }
    box.stimulus = *stimulus;
    if (std::string reason; !box.isValid(&reason))
        throw Error(Error::Kind::data, "'" + document.source() + "' cannot be played: " + reason + ".");
    return box;
}

BlackBox readBlackBox(const std::filesystem::path& path)
{
    const auto document = readJson(path);
    return blackBoxFromJson(JsonField(document, "", path.string()));
}

}  // namespace excursion
