// SPDX-License-Identifier: GPL-3.0-or-later
#include "Study/OutcomeFile.h"

#include "Engine/Document/JsonField.h"
#include "Engine/Document/JsonText.h"
#include "Engine/Error.h"

#include <nlohmann/json.hpp>

#include <limits>

namespace excursion::study {
namespace {

/// Of a number that is not finite the file says null.
double finiteOrInfinite(const nlohmann::json& value)
{
    return value.is_null() ? std::numeric_limits<double>::infinity() : value.get<double>();
}

Outcome outcomeFrom(const nlohmann::json& take)
{
    Outcome o;
    o.what.seed = take.at("seed");
    o.what.hidden = take.at("hidden").get<std::vector<std::string>>();
    o.driver = take.at("driver");
    o.channels = take.value("channels", std::vector<std::string> {});
    o.sampleRate = take.at("sampleRate");
    o.noiseDb = take.at("noiseDb");
    o.strengths = take.at("strengths").get<std::vector<double>>();
    o.takeSeconds = take.at("seconds");
    o.first = take.at("first");
    o.added = take.at("added").get<std::vector<std::string>>();
    o.confidence = take.at("confidence").get<std::vector<double>>();
    o.withdrawn = take.at("withdrawn").get<std::vector<std::string>>();
    o.verdict = take.at("verdict");
    o.standsDb = finiteOrInfinite(take.at("standsDb"));
    o.finalDb = finiteOrInfinite(take.at("finalDb"));
    o.improveSeconds = take.at("improveSeconds");
    o.failure = take.value("failure", "");
    if (take.contains("oddity")) {
        o.what.oddity = take["oddity"].at("kind");
        o.oddityDb = take["oddity"].at("showDb");
    }
    o.showDb = take.value("showDb", std::vector<double>(o.what.hidden.size(), o.standsDb));
    if (take.contains("laws"))
        for (const auto& law : take["laws"])
            o.laws.push_back({law.at("effect"), law.at("hidden"), law.at("points"), law.at("inside")});
    return o;
}

}  // namespace

nlohmann::ordered_json toJson(const Outcome& o)
{
    nlohmann::ordered_json take {{"seed", o.what.seed},
                                 {"hidden", o.what.hidden},
                                 {"driver", o.driver},
                                 {"channels", o.channels},
                                 {"sampleRate", o.sampleRate},
                                 {"noiseDb", o.noiseDb},
                                 {"strengths", o.strengths},
                                 {"seconds", o.takeSeconds},
                                 {"first", o.first},
                                 {"added", o.added},
                                 {"confidence", o.confidence},
                                 {"withdrawn", o.withdrawn},
                                 {"verdict", o.verdict},
                                 {"standsDb", numberOrNull(o.standsDb)},
                                 {"finalDb", numberOrNull(o.finalDb)},
                                 {"improveSeconds", o.improveSeconds}};
    if (o.odd())
        take["oddity"] = {{"kind", o.what.oddity}, {"showDb", o.oddityDb}};
    if (!o.control())
        take["showDb"] = o.showDb;
    for (const auto& law : o.laws)
        take["laws"].push_back(
            {{"effect", law.effect}, {"hidden", law.hidden}, {"points", law.points}, {"inside", law.inside}});
    if (!o.failure.empty())
        take["failure"] = o.failure;
    return take;
}

std::vector<Outcome> readOutcomes(const std::filesystem::path& path)
{
    std::vector<Outcome> outcomes;
    try {
        const auto document = readJson(path);
        for (const auto& take : document.at("takes"))
            outcomes.push_back(outcomeFrom(take));
    } catch (const nlohmann::json::exception& error) {
        throw Error(Error::Kind::input, path.string() + " is not a study: " + error.what());
    }
    return outcomes;
}

}  // namespace excursion::study
