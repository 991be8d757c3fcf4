// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/Destination.h"
#include "Cli/Terminal.h"
#include "Cli/Verbs.h"
#include "Engine/Import/ReadTake.h"

#include "Engine/Document/JsonText.h"
#include "Engine/Document/Words.h"
#include "Engine/Error.h"
#include "Engine/Ranking/RankingFile.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <memory>

namespace excursion::cli {
namespace {

struct RankArguments {
    std::string take, output, keep;
    RankOptions options;
};

/// One document a class, DIR/<class>.json.
void keep(Ranking& ranking, const std::string& folder, Terminal& terminal)
{
    std::vector<std::string> kept;
    std::filesystem::create_directories(folder);
    for (auto& model : ranking.models) {
        if (model.document.is_null())
            continue;
        const auto path = std::filesystem::path(folder) / (model.name + ".json");
        writeJson(model.document, path);
        model.kept = path.string();
        kept.push_back(path.filename().string());
    }
    terminal.say("Kept in " + folder + ": " + (kept.empty() ? "nothing" : joined(kept)) + ".");
}

/// What it is worth to invert each class, least distortion left first, and why the others are not.
void sayPredistortion(const Ranking& ranking, Terminal& terminal)
{
    std::vector<const RankedModel*> worthIt;
    for (const auto& m : ranking.models)
        if (m.trouble.empty() && m.predistortion.trouble.empty())
            worthIt.push_back(&m);
    std::stable_sort(worthIt.begin(), worthIt.end(),
                     [](const auto* a, const auto* b) { return a->predistortion.leftDb < b->predistortion.leftDb; });
    std::vector<std::vector<std::string>> rows;
    for (const auto* m : worthIt) {
        const auto& told = m->predistortion;
        rows.push_back({m->name, fixed(told.beforeDb, 1), fixed(told.modelDb, 1), fixed(told.leftDb, 1),
                        fixed(100.0 * told.load, 2) + " %", fixed(1e3 * told.latency, 1) + " ms"});
    }
    if (!rows.empty())
        terminal.table({"inverted", "distortion dB", "left on the model", "left on the take", "load", "latency"}, rows);
    for (const auto& m : ranking.models)
        if (m.trouble.empty() && !m.predistortion.trouble.empty())
            terminal.say(m.name + " is not inverted. " + m.predistortion.trouble);
    terminal.say(ranking.straightSentence);
}

void run(const RankArguments& arguments, Terminal& terminal)
{
    auto options = arguments.options;
    if (!arguments.output.empty()) {
        options.output = quantityNamed(arguments.output);
        if (!options.output)
            throw Error(Error::Kind::usage, "There is no quantity \"" + arguments.output + "\".");
    }
    if (!arguments.keep.empty())
        requireFolderPlace(arguments.keep);
    auto ranking = rank(readMeasurement(arguments.take), options, terminal.progress());
    ranking.take = arguments.take;
    terminal.say(std::string(name(ranking.output)) + " explained by " + std::string(name(ranking.input))
                 + ", errors of simulations"
                 + (ranking.noiseDb ? "; noise " + fixed(*ranking.noiseDb, 1) + " dB" : ""));
    std::vector<std::vector<std::string>> rows;
    for (const auto& m : ranking.models)
        if (m.trouble.empty())
            rows.push_back({m.name, std::to_string(m.parameters), errorText(m.estimationDb), errorText(m.validationDb),
                            fixed(100.0 * m.load, 2) + " %", fixed(m.fitSeconds, 1) + " s", m.stable ? "yes" : "no",
                            m.description});
    terminal.table(
        {"class", "parameters", "estimation dB", "validation dB", "load", "fitted in", "stable", "what it is"}, rows);
    for (const auto& m : ranking.models)
        if (!m.trouble.empty())
            terminal.say(m.name + ": " + m.trouble);
    terminal.say(ranking.sentence);
    sayPredistortion(ranking, terminal);
    if (!arguments.keep.empty())
        keep(ranking, arguments.keep, terminal);
    terminal.document(toJson(ranking));
}

}  // namespace

void addRank(CLI::App& app, Terminal& terminal)
{
    const auto [verb, o] = addVerb<RankArguments>(app, terminal, step::fit, "rank",
                                                  "Fit all classes of models to one take and compare them: error, "
                                                  "parameters, load, stability, and what their inverses are worth",
                                                  run);
    std::vector<std::string> names;
    std::string told = "Classes:\n";
    for (const auto& known : modelClasses()) {
        names.push_back(known.name);
        told += "  " + known.name + std::string(known.name.size() < 20 ? 20 - known.name.size() : 1, ' ')
                + known.sentence + "\n";
    }
    verb->add_option("TAKE", o->take, "the take: a folder, or a .csv of time signals")->required();
    verb->add_option("--output", o->output, "the channel to explain; by default the first beside the input");
    verb->add_option("--level", o->options.level, "number of the level, 0 the quietest; by default the loudest")
        ->check(CLI::NonNegativeNumber);
    verb->add_option("--order", o->options.order,
                     "states of the polynomial models; by default those of the linear model, at most 4")
        ->check(CLI::Range(1, 20));
    verb->add_option("--degree", o->options.degree, "highest degree of their monomials")
        ->capture_default_str()
        ->check(CLI::Range(2, 7));
    verb->add_option("--iterations", o->options.iterations, "largest number of iterations of each search")
        ->capture_default_str()
        ->check(CLI::Range(1, 1000));
    verb->add_option("--classes", o->options.classes, "only these, separated by commas")
        ->delimiter(',')
        ->check(CLI::IsMember(names))
        ->type_name("CLASS");
    verb->add_option("--keep", o->keep, "keep the model of each class as its document, CLASS.json")->type_name("DIR");
    verb->footer(told);
}

}  // namespace excursion::cli
