// SPDX-License-Identifier: GPL-3.0-or-later
#include "Bench/Truth.h"
#include "Engine/Document/DocumentFormat.h"

#include <nlohmann/json.hpp>

#include <functional>

namespace excursion::bench {
namespace {

using Json = nlohmann::ordered_json;

Json curveJson(const std::optional<Curve>& curve)
{
    return {{"shape", name(curve->shape)},
            {"centre", curve->centre},
            {"width", curve->width},
            {"amount", curve->amount},
            {"extra", curve->extra}};
}

Json lawJson(const char* against, double range, const std::function<double(double)>& law)
{
    Json at = Json::array(), value = Json::array();
    for (int n = -40; n <= 40; ++n) {
        at.push_back(range * n / 40.0);
        value.push_back(law(range * n / 40.0));
    }
    return {{"against", against}, {"at", at}, {"value", value}};
}

Json parametersOf(const Loudspeaker& speaker, const std::string& id)
{
    if (id == "force-factor")
        return curveJson(speaker.forceFactor);
    if (id == "stiffness")
        return curveJson(speaker.stiffness);
    if (id == "inductance-position")
        return curveJson(speaker.inductancePosition);
    if (id == "inductance-current")
        return curveJson(speaker.inductanceCurrent);
    if (id == "damping-velocity")
        return curveJson(speaker.dampingVelocity);
    if (id == "eddy-currents") {
        Json json {{"coefficient", speaker.eddyCurrents->coefficient},
                   {"exponent", speaker.eddyCurrents->exponent},
                   {"moves", speaker.eddyCurrents->moves}};
        for (const auto& cell : speaker.eddyCurrents->cells)
            json["cells"].push_back({{"resistance", cell.resistance}, {"rate", cell.rate}});
        return json;
    }
    if (id == "creep") {
        static constexpr const char* families[] {"logarithmic", "standard", "fractional", "chain"};
        const auto& creep = *speaker.creep;
        Json json {{"family", families[static_cast<int>(creep.family)]},
                   {"amount", creep.amount},
                   {"low", creep.low},
                   {"high", creep.high},
                   {"exponent", creep.exponent}};
        for (const auto& cell : creep.cells)
            json["cells"].push_back({{"yield", cell.yield}, {"rate", cell.rate}});
        return json;
    }
    if (id == "friction") {
        Json elements = Json::array();
        for (const auto& element : speaker.friction->elements)
            elements.push_back({{"stiffness", element.stiffness}, {"limit", element.limit}});
        return {{"elements", elements}};
    }
    if (id == "coil-heating") {
        const auto& heating = *speaker.coilHeating;
        return {{"alpha", heating.alpha},
                {"coilCapacity", heating.coilCapacity},
                {"coilResistance", heating.coilResistance},
                {"magnetCapacity", heating.magnetCapacity},
                {"magnetResistance", heating.magnetResistance}};
    }
    if (id == "vented-box")
        return {{"stiffness", speaker.ventedBox->stiffness},   {"mass", speaker.ventedBox->mass},
                {"resistance", speaker.ventedBox->resistance}, {"leak", speaker.ventedBox->leak},
                {"absorption", speaker.ventedBox->absorption}, {"spring", speaker.ventedBox->spring}};
    if (id == "port-and-air") {
        const auto& flow = *speaker.ventedBox->flow;
        return {{"outward", flow.outward}, {"inward", flow.inward}, {"power", flow.power}, {"length", flow.length}};
    }
    if (id == "cone-breakup") {
        Json modes = Json::array();
        for (const auto& mode : speaker.coneBreakup)
            modes.push_back({{"frequency", mode.frequency}, {"quality", mode.quality}, {"gain", mode.gain}});
        return {{"modes", modes}};
    }
    if (id == "side-resonance") {
        Json parts = Json::array();
        for (const auto& part : speaker.sideResonance)
            parts.push_back({{"mass", part.mass}, {"frequency", part.frequency}, {"quality", part.quality}});
        return {{"parts", parts}};
    }
    return Json::object();
}

}  // namespace

nlohmann::ordered_json truthOf(const Draw& draw)
{
    const auto& speaker = draw.speaker;
    const auto& visited = draw.visited;
    Json truth = DocumentFormat {"excursion-truth"}.with();
    truth["driver"] = {{"class", draw.driver}, {"Re", speaker.Re},   {"Le", speaker.Le}, {"Bl", speaker.Bl},
                       {"m", speaker.m},       {"Rms", speaker.Rms}, {"K", speaker.K},   {"coneArea", speaker.coneArea},
                       {"xmax", speaker.xmax}};
    truth["visited"] = {
        {"displacement", visited.displacement}, {"velocity", visited.velocity}, {"current", visited.current}};
    truth["noiseDb"] = draw.setup.noiseDb;
    truth["effects"] = Json::array();
    for (const auto& effect : draw.hidden) {
        auto entry = parametersOf(speaker, effect.id);
        entry["id"] = effect.id;
        entry["strength"] = effect.strength;
        truth["effects"].push_back(entry);
    }
    auto& laws = truth["laws"] = Json::object();
    if (speaker.forceFactor)
        laws["force-factor"] = lawJson("displacement", visited.displacement,
                                       [&](double x) { return speaker.forceFactorAt(x); });
    if (speaker.stiffness)
        laws["stiffness"] = lawJson("displacement", visited.displacement,
                                    [&](double x) { return speaker.stiffnessAt(x); });
    if (speaker.inductancePosition)
        laws["inductance-position"] = lawJson("displacement", visited.displacement,
                                              [&](double x) { return speaker.inductanceAt(x); });
    if (speaker.inductanceCurrent)
        laws["inductance-current"] = lawJson("current", visited.current,
                                             [&](double i) { return speaker.inductanceAt(0.0, i); });
    if (speaker.dampingVelocity)
        laws["damping-velocity"] = lawJson("velocity", visited.velocity,
                                           [&](double v) { return speaker.dampingAt(v); });
    return truth;
}

}  // namespace excursion::bench
