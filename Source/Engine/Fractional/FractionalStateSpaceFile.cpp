// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Fractional/FractionalStateSpaceFile.h"

#include "Engine/Document/DocumentFormat.h"
#include "Engine/Document/JsonText.h"
#include "Engine/Error.h"

namespace excursion {
namespace {

using Json = nlohmann::ordered_json;

constexpr DocumentFormat fractionalStateSpaceFormat {"excursion-fractional-state-space"};

}  // namespace

Json toJson(const NamedFractionalStateSpace& named)
{
    Json document = fractionalStateSpaceFormat.with({{"name", named.name}});
    document["alpha"] = named.model.alpha;
    document["form"] = toJson(NamedStateSpace {named.name, named.inputs, named.outputs, named.model.form});
    return document;
}

NamedFractionalStateSpace fractionalStateSpaceFromJson(const JsonField& field)
{
    fractionalStateSpaceFormat.require(field);
    const auto form = field.at("form");
    auto inner = stateSpaceFromJson(form);
    if (!inner.model.continuous())
        form.at("sampleRate").refuse("0, as a fractional model is one of continuous time");
    NamedFractionalStateSpace named {field.at("name").text(), std::move(inner.inputs), std::move(inner.outputs), {}};
    named.model.alpha = field.at("alpha").number();
    if (!(named.model.alpha > 0.0 && named.model.alpha < 2.0))
        field.at("alpha").refuse("a number between 0 and 2");
    named.model.form = std::move(inner.model);
    return named;
}

}  // namespace excursion
