// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/Terminal.h"
#include "Cli/Verbs.h"

#include "Engine/Document/DocumentFormat.h"
#include "Engine/Document/Words.h"
#include "Engine/Loudspeaker/Catalogue.h"

#include <nlohmann/json.hpp>

#include <memory>

namespace excursion::cli {
namespace {

/// "Ks in ohm s^a, a"; of a law the count of its coefficients, whose names say nothing.
std::string parametersText(const Effect& effect, const std::vector<Parameter>& parameters)
{
    if (effect.law())
        return std::to_string(parameters.size()) + " coefficients in " + parameters.front().unit
               + ", more where the data asks for them";
    return joined(parameters, [&](const auto& p) { return p.name + (p.unit == "1" ? "" : " in " + p.unit); });
}

std::string lawText(const LawInfo& law)
{
    return law.name + " in " + law.unit + " over " + law.argument + " in " + law.argumentUnit + ", " + law.base
           + " at rest";
}

void print(const Effect& effect, Terminal& terminal)
{
    constexpr std::size_t indent = 16;
    const auto line = [&](const std::string& label, const std::string& text) {
        terminal.say(wrapped("    " + label + std::string(indent - 4 - label.size(), ' ') + text, indent));
    };
    terminal.say(effect.id() + std::string(effect.id().size() < 22 ? 22 - effect.id().size() : 1, ' ')
                 + effect.title());
    line("what it is", effect.physics());
    line("acts", std::string(effect.electrical() ? "on the coil, so it needs a voltage and a current"
                             : effect.felt()     ? "on the cone, with or without a coil"
                                                 : "on what leaves the cone, so it needs a microphone")
                     + (effect.linear() ? "; linear: it bends the frequency response" : "; nonlinear: it distorts"));
    if (const auto law = effect.law())
        line("law", lawText(*law));
    line("parameters", parametersText(effect, effect.parameters({})));
    line("look for", effect.symptoms());
    line("remedy", effect.remedy());
    terminal.say("");
}

nlohmann::ordered_json json(const Effect& effect)
{
    nlohmann::ordered_json object {{"id", effect.id()},
                                   {"title", effect.title()},
                                   {"physics", effect.physics()},
                                   {"domain", effect.electrical() ? "electrical"
                                              : effect.felt()     ? "mechanical"
                                                                  : "acoustical"},
                                   {"linear", effect.linear()}};
    if (const auto law = effect.law())
        object["law"] = {{"name", law->name},
                         {"unit", law->unit},
                         {"argument", law->argument},
                         {"argumentUnit", law->argumentUnit},
                         {"base", law->base}};
    else
        object["law"] = nullptr;
    object["parameters"] = nlohmann::ordered_json::array();
    for (const auto& p : effect.parameters({}))
        object["parameters"].push_back({{"name", p.name}, {"unit", p.unit}});
    object["symptoms"] = effect.symptoms();
    object["remedy"] = effect.remedy();
    return object;
}

void run(const std::vector<std::string>& wanted, Terminal& terminal)
{
    std::vector<const Effect*> effects;
    for (const auto& id : wanted)
        effects.push_back(&effectNamed(id));
    if (effects.empty())
        effects = catalogue();
    nlohmann::ordered_json document = DocumentFormat {"excursion-effects"}.with();
    document["effects"] = nlohmann::ordered_json::array();
    for (const auto* effect : effects) {
        print(*effect, terminal);
        document["effects"].push_back(json(*effect));
    }
    terminal.document(document);
}

}  // namespace

void addEffects(CLI::App& app, Terminal& terminal)
{
    auto ids = std::make_shared<std::vector<std::string>>();
    auto* verb = app.add_subcommand("effects",
                                    "The physical effects that Excursion knows: what they are, and what betrays them")
                     ->group(step::diagnose);
    verb->add_option("EFFECT", *ids, "only these");
    verb->callback([ids, &terminal] { run(*ids, terminal); });
}

}  // namespace excursion::cli
