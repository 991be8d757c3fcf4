// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/Block/BlockModelFile.h"

#include "Engine/Document/DocumentFormat.h"
#include "Engine/Document/JsonText.h"
#include "Engine/Linear/StateSpaceFile.h"

namespace excursion {
namespace {

constexpr DocumentFormat blockModelFormat {"excursion-block-model"};

}  // namespace

nlohmann::ordered_json toJson(const Named<BlockModel>& named)
{
    nlohmann::ordered_json document = blockModelFormat.with({{"name", named.name}});
    document["linear"] = toJson(NamedStateSpace {named.name, {named.input}, {named.output}, named.model.linear});
    for (const auto branch : blockBranches()) {
        const auto& c = named.model.of(branch);
        document[std::string(name(branch))] = std::vector<double>(c.begin(), c.end());
    }
    document["offset"] = named.model.offset;
    return document;
}

Named<BlockModel> blockModelFromJson(const JsonField& field)
{
    blockModelFormat.require(field);
    auto linear = stateSpaceFromJson(field.at("linear"));
    if (linear.inputs.size() != 1 || linear.outputs.size() != 1 || linear.model.continuous())
        field.at("linear").refuse("a linear part of discrete time with one input and one output");
    Named<BlockModel> named {field.at("name").text(), linear.inputs[0], linear.outputs[0], {}};
    named.model.linear = std::move(linear.model);
    for (const auto branch : blockBranches()) {
        const auto items = field.at(std::string(name(branch)).c_str()).items();
        auto& c = named.model.of(branch);
        c.resize(static_cast<Eigen::Index>(items.size()));
        for (std::size_t k = 0; k < items.size(); ++k)
            c[static_cast<Eigen::Index>(k)] = items[k].number();
    }
    named.model.offset = field.at("offset").number();
    if (std::string reason; !named.model.isValid(&reason))
        field.refuse("a block model that fits: " + reason);
    return named;
}

}  // namespace excursion
