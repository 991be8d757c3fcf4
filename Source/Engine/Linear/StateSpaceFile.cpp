// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Linear/StateSpaceFile.h"

#include "Engine/Document/DocumentFormat.h"
#include "Engine/Document/JsonText.h"
#include "Engine/Error.h"

#include <cmath>

namespace excursion {
namespace {

using Json = nlohmann::ordered_json;

constexpr DocumentFormat stateSpaceFormat {"excursion-state-space"};

std::vector<std::string> names(const JsonField& field)
{
    std::vector<std::string> result;
    for (const auto& item : field.items())
        result.push_back(item.text());
    if (result.empty())
        field.refuse("at least one name");
    return result;
}

}  // namespace

Json matrixJson(const Eigen::MatrixXd& M)
{
    Json rows = Json::array();
    for (Eigen::Index r = 0; r < M.rows(); ++r) {
        Json row = Json::array();
        for (Eigen::Index c = 0; c < M.cols(); ++c)
            row.push_back(M(r, c));
        rows.push_back(std::move(row));
    }
    return rows;
}

Eigen::MatrixXd matrixFrom(const JsonField& field, Eigen::Index rows, Eigen::Index columns)
{
    const auto expected = std::to_string(rows) + " rows of " + std::to_string(columns) + " numbers";
    const auto items = field.items();
    if (static_cast<Eigen::Index>(items.size()) != rows)
        field.refuse(expected);
    Eigen::MatrixXd M(rows, columns);
    for (Eigen::Index r = 0; r < rows; ++r) {
        const auto values = items[static_cast<std::size_t>(r)].numbers();
        if (static_cast<Eigen::Index>(values.size()) != columns)
            items[static_cast<std::size_t>(r)].refuse(std::to_string(columns) + " numbers");
        for (Eigen::Index c = 0; c < columns; ++c) {
            M(r, c) = values[static_cast<std::size_t>(c)];
            if (!std::isfinite(M(r, c)))
                items[static_cast<std::size_t>(r)].refuse("finite numbers");
        }
    }
    return M;
}

Json toJson(const NamedStateSpace& named)
{
    Json document = stateSpaceFormat.with({{"name", named.name}});
    document["sampleRate"] = named.model.sampleRate;
    document["inputs"] = named.inputs;
    document["outputs"] = named.outputs;
    document["order"] = named.model.order();
    document["A"] = matrixJson(named.model.A);
    document["B"] = matrixJson(named.model.B);
    document["C"] = matrixJson(named.model.C);
    document["D"] = matrixJson(named.model.D);
    if (named.delay != 0.0)
        document["delay"] = named.delay;
    return document;
}

NamedStateSpace stateSpaceFromJson(const JsonField& field)
{
    stateSpaceFormat.require(field);
    NamedStateSpace named;
    named.name = field.at("name").text();
    named.inputs = names(field.at("inputs"));
    named.outputs = names(field.at("outputs"));
    const auto n = static_cast<Eigen::Index>(field.at("order").count(0, 10000));
    const auto m = static_cast<Eigen::Index>(named.inputs.size()), p = static_cast<Eigen::Index>(named.outputs.size());
    named.model.sampleRate = field.at("sampleRate").numberWithin(0.0, 1e9);
    named.model.A = matrixFrom(field.at("A"), n, n);
    named.model.B = matrixFrom(field.at("B"), n, m);
    named.model.C = matrixFrom(field.at("C"), p, n);
    named.model.D = matrixFrom(field.at("D"), p, m);
    if (field.has("delay"))
        named.delay = field.at("delay").numberWithin(-1e3, 1e3);
    return named;
}

}  // namespace excursion
