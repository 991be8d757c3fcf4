// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/GreyBox/MotorConeFile.h"

#include "Engine/Document/DocumentFormat.h"
#include "Engine/Document/JsonText.h"

#include <nlohmann/json.hpp>

namespace excursion {
namespace {

constexpr DocumentFormat motorConeFormat {"excursion-motor-cone"};

}  // namespace

nlohmann::ordered_json toJson(const NamedMotorCone& found)
{
    nlohmann::ordered_json document = motorConeFormat.with({{"source", found.source}, {"name", found.name}});
    document["delay"] = found.delay;
    document["motorErrorDb"] = numberOrNull(found.motorErrorDb);
    document["coneErrorDb"] = numberOrNull(found.coneErrorDb);
    document["errorDb"] = numberOrNull(found.errorDb);
    document["motorChiSquared"] = numberOrNull(found.motorChiSquared);
    document["chiSquared"] = numberOrNull(found.chiSquared);
    document["refined"] = found.refined;
    document["toldUpTo"] = found.toldUpTo;
    document["sentence"] = found.sentence;
    document["stable"] = found.stable;
    document["motor"] = toJson(found.motor);
    document["cone"] = toJson(found.cone);
    document["cascade"] = toJson(found.cascade);
    return document;
}

NamedMotorCone motorConeFromJson(const JsonField& document)
{
    motorConeFormat.require(document);
    NamedMotorCone found;
    found.source = document.at("source").text();
    found.name = document.at("name").text();
    found.delay = document.at("delay").number();
    found.motorErrorDb = document.at("motorErrorDb").numberOrNaN();
    found.coneErrorDb = document.at("coneErrorDb").numberOrNaN();
    found.errorDb = document.at("errorDb").numberOrNaN();
    if (document.has("motorChiSquared"))
        found.motorChiSquared = document.at("motorChiSquared").number();
    if (document.has("chiSquared"))
        found.chiSquared = document.at("chiSquared").number();
    found.refined = document.at("refined").flag();
    found.toldUpTo = document.at("toldUpTo").number();
    found.sentence = document.at("sentence").text();
    found.stable = document.at("stable").flag();
    found.motor = stateSpaceFromJson(document.at("motor"));
    found.cone = stateSpaceFromJson(document.at("cone"));
    found.cascade = stateSpaceFromJson(document.at("cascade"));
    return found;
}

}  // namespace excursion
