// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/Volterra/VolterraSeriesFile.h"

#include "Engine/Document/JsonText.h"
#include "Engine/Linear/StateSpaceFile.h"

namespace excursion {
namespace {

constexpr DocumentFormat volterraSeriesFormat {"excursion-volterra-series"};

}  // namespace

nlohmann::ordered_json toJson(const Named<VolterraSeries>& named)
{
    const auto& model = named.model;
    auto document = modelHeader(volterraSeriesFormat, named.name, model.sampleRate, named.input, named.output);
    document["offset"] = model.offset;
    document["first"] = std::vector<double>(model.first.begin(), model.first.end());
    document["second"] = matrixJson(model.second);
    document["third"] = nlohmann::ordered_json::array();
    for (const auto& slice : model.third)
        document["third"].push_back(matrixJson(slice));
    return document;
}

Named<VolterraSeries> volterraSeriesFromJson(const JsonField& field)
{
    auto named = namedFromHeader<VolterraSeries>(field, volterraSeriesFormat);
    auto& model = named.model;
    model.offset = field.at("offset").number();
    const auto first = field.at("first").items();
    model.first.resize(static_cast<Eigen::Index>(first.size()));
    for (std::size_t k = 0; k < first.size(); ++k)
        model.first[static_cast<Eigen::Index>(k)] = first[k].number();
    const auto T2 = static_cast<Eigen::Index>(field.at("second").items().size());
    model.second = matrixFrom(field.at("second"), T2, T2);
    const auto slices = field.at("third").items();
    const auto T3 = static_cast<Eigen::Index>(slices.size());
    for (const auto& slice : slices)
        model.third.push_back(matrixFrom(slice, T3, T3));
    if (std::string reason; !model.isValid(&reason))
        field.refuse("kernels that fit: " + reason);
    return named;
}

}  // namespace excursion
