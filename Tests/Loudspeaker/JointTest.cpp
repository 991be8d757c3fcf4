// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Document/JsonText.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/ModelFile.h"

#include <catch2/catch.hpp>

#include <algorithm>

using namespace excursion;

namespace {

/// Whether parameters that mean something beside another law alone are free; all of them are alike.
bool jointAreFree(const Model& model)
{
    const auto& own = model.find("inductance-current")->parameters;
    const auto free = std::count_if(own.begin(), own.end(), [](const Parameter& p) { return p.joint && p.free; });
    REQUIRE((free == 0 || free == std::count_if(own.begin(), own.end(), [](const Parameter& p) { return p.joint; })));
    return free > 0;
}

Parameter& firstJoint(Model& model)
{
    auto& own = model.components[1].parameters;
    return *std::find_if(own.begin(), own.end(), [](const Parameter& p) { return p.joint; });
}

Model readAgain(const Model& model) { return modelFromJson(toJson(model), "model.json"); }

}  // namespace

TEST_CASE("What depends on two laws at once is free beside both, and zero beside one", "[model]")
{
    auto model = withEffect(makeModel("electrodynamic"), effectNamed("inductance-current"), {});
    CHECK_FALSE(jointAreFree(model));
    model = withEffect(model, effectNamed("inductance-position"), {});
    followOthers(model);
    CHECK(jointAreFree(model));
    firstJoint(model).value = 0.3;
    CHECK(jointAreFree(readAgain(model)));

    auto held = model;
    for (auto& p : held.components[1].parameters)
        p.free = p.free && !p.joint;
    auto again = readAgain(held);
    followOthers(again);
    CHECK_FALSE(jointAreFree(again));  // as it was held
    CHECK(firstJoint(again).value == 0.3);

    model = withoutEffect(model, "inductance-position");
    auto older = readAgain(model);  // of a program that knew no such rule
    for (auto* one : {&model, &older}) {
        followOthers(*one);
        CHECK_FALSE(jointAreFree(*one));
        CHECK(firstJoint(*one).value == 0.0);
        firstJoint(*one).free = true;  // by whom else
        followOthers(*one);
        CHECK_FALSE(jointAreFree(*one));
    }
}
