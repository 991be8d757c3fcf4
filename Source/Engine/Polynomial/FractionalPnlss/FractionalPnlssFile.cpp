// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/FractionalPnlss/FractionalPnlssFile.h"

#include "Engine/Document/DocumentFormat.h"
#include "Engine/Document/JsonText.h"
#include "Engine/Linear/StateSpaceFile.h"
#include "Engine/Polynomial/Pnlss/PnlssFile.h"

namespace excursion {
namespace {

using Json = nlohmann::ordered_json;

constexpr DocumentFormat fractionalPnlssFormat {"excursion-fractional-pnlss"};

}  // namespace

Json toJson(const NamedFractionalPnlss& named)
{
    const auto& model = named.model;
    Json document = fractionalPnlssFormat.with({{"name", named.name}, {"alpha", model.alpha}});
    document["fractional"] = std::vector<bool>(model.fractional.begin(), model.fractional.end());
    document["grid"] = {{"sampleRate", named.grid.sampleRate},
                        {"substeps", named.grid.substeps},
                        {"lowFrequency", named.grid.band.lowFrequency},
                        {"highFrequency", named.grid.band.highFrequency},
                        {"cellsPerDecade", named.grid.band.cellsPerDecade}};
    document["linear"] = toJson(NamedStateSpace {named.name, named.inputs, named.outputs, model.form.linear});
    document["terms"] = termsJson(model.form);
    return document;
}

NamedFractionalPnlss fractionalPnlssFromJson(const JsonField& field)
{
    fractionalPnlssFormat.require(field);
    auto linear = stateSpaceFromJson(field.at("linear"));
    NamedFractionalPnlss named {field.at("name").text(), linear.inputs, linear.outputs, {}, {}};
    auto& model = named.model;
    model.alpha = field.at("alpha").number();
    model.form.linear = std::move(linear.model);
    const auto marks = field.at("fractional").items();
    model.fractional.resize(static_cast<Eigen::Index>(marks.size()));
    for (std::size_t i = 0; i < marks.size(); ++i)
        model.fractional[static_cast<Eigen::Index>(i)] = marks[i].flag();
    readTerms(field.at("terms"), model.form);
    std::string reason;
    if (!model.isValid(&reason))
        field.refuse("a valid model, but " + reason);
    const auto grid = field.at("grid");
    named.grid = {
        grid.at("sampleRate").number(),
        grid.at("substeps").count(1, 256),
        {grid.at("lowFrequency").number(), grid.at("highFrequency").number(), grid.at("cellsPerDecade").number()}};
    if (!(named.grid.sampleRate > 0.0))
        grid.at("sampleRate").refuse("a sample rate above 0 Hz");
    if (!named.grid.band.isValid(&reason))
        grid.refuse("a band of a ladder, but " + reason);
    return named;
}

}  // namespace excursion
