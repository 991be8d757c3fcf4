// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/Destination.h"
#include "Cli/OpenModel.h"
#include "Cli/OpenResponse.h"
#include "Cli/Terminal.h"
#include "Cli/Verbs.h"
#include "Engine/Document/DocumentFormat.h"
#include "Engine/Linear/Response.h"

#include "Engine/Document/JsonText.h"
#include "Engine/Error.h"
#include "Engine/Linear/Stabilization.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <limits>
#include <memory>
#include <utility>

namespace excursion::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::pair<const char*, StabilizingMethod> methods[] {{"mirror", StabilizingMethod::mirror},
                                                               {"project", StabilizingMethod::project},
                                                               {"delay", StabilizingMethod::delay},
                                                               {"decompose", StabilizingMethod::decompose}};
constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

struct StabilizeArguments {
    std::string model, out, unstable, method = "mirror";
    ResponseChoice response;
    double seconds = unknown;
    bool unfitted = false;
};

FrequencyData dataFor(const StabilizeArguments& options, const OpenModel& open)
{
    const auto& named = open.named;
    if (options.response.path.empty())
        return sampled(named.model, 1000, open.alpha);
    if (named.model.inputs() != 1 || named.model.outputs() != 1)
        throw Error(Error::Kind::data,
                    "Only models with one input and one output are stabilized by a response; leave --frf out.");
    auto choice = options.response;
    choice.input = named.inputs[0];
    choice.output = named.outputs[0];
    return delayed(frequencyDataOf(openResponse(choice).frf), named.delay);
}

Stabilization stabilizeBy(const StabilizeArguments& options, const OpenModel& open, const FrequencyData& data,
                          Terminal& terminal)
{
    StabilizeOptions stabilizing;
    stabilizing.alpha = open.alpha;
    for (const auto& [name, method] : methods)
        if (options.method == name)
            stabilizing.method = method;
    stabilizing.refit = !options.unfitted;
    if (std::isfinite(options.seconds))
        stabilizing.seconds = options.seconds;
    return stabilized(open.named.model, data, stabilizing, terminal.progress());
}

void print(const Stabilization& result, Terminal& terminal)
{
    std::vector<std::vector<std::string>> rows;
    for (const auto& step : result.steps)
        rows.push_back({step.what, std::to_string(step.order), step.stable ? "yes" : "no", fixed(step.errorDb, 1),
                        fixed(step.weightedErrorDb, 1)});
    terminal.table({"model", "order", "stable", "error dB", "weighted dB"}, rows);
    if (result.delay != 0.0)
        terminal.say("The model answers " + significant(1e6 * result.delay, 5) + " us later than the response"
                     + (result.delayStandardError && std::isfinite(*result.delayStandardError)
                            ? " (+- " + significant(1e6 * *result.delayStandardError, 2) + " us)."
                            : "."));
    terminal.say("Ended: " + result.reason + ".");
}

void writeUnstable(const StabilizeArguments& options, OpenModel open, const Decomposition& parts, Json& document,
                   Terminal& terminal)
{
    open.named.model = parts.unstable;
    const auto kept = documentOf(open);
    document["coupling"] = parts.coupling;
    document["unstable"] = kept;
    if (options.unstable.empty())
        return;
    writeJson(kept, options.unstable);
    terminal.say("Wrote " + options.unstable + ", the unstable part of order " + std::to_string(parts.unstable.order())
                 + ".");
}

void run(const StabilizeArguments& options, Terminal& terminal)
{
    requireFilePlace(options.out);
    if (!options.unstable.empty()) {
        if (options.method != "decompose")
            throw Error(Error::Kind::usage, "Only --method decompose has an unstable part to write.");
        requireFilePlace(options.unstable);
    }
    if (std::isfinite(options.seconds) && options.method != "delay")
        throw Error(Error::Kind::usage, "--seconds goes with --method delay.");
    auto open = openModel(options.model);
    if (open.fractional && options.method == "delay")
        throw Error(Error::Kind::usage,
                    "No delay is fitted with a model of fractional order; mirror, project or decompose it.");
    const auto data = dataFor(options, open);
    Json document = DocumentFormat {"excursion-stabilization"}.with(
        {{"source", options.model}, {"method", options.method}});
    document["response"] = textOrNull(options.response.path);
    const auto result = stabilizeBy(options, open, data, terminal);
    if (result.parts)
        writeUnstable(options, open, *result.parts, document, terminal);
    open.named.model = result.model;
    open.named.delay += result.delay;
    document["steps"] = Json::array();
    for (const auto& step : result.steps)
        document["steps"].push_back({{"step", step.what},
                                     {"order", step.order},
                                     {"stable", step.stable},
                                     {"errorDb", step.errorDb},
                                     {"weightedErrorDb", step.weightedErrorDb}});
    document["delay"] = result.delay;
    document["delayStandardError"] = numberOrNull(result.delayStandardError.value_or(unknown));
    document["stopped"] = result.reason;
    document["stable"] = isStable(open);
    const auto kept = documentOf(open);
    writeJson(kept, options.out);
    print(result, terminal);
    terminal.say("Wrote " + options.out + ".");
    document["model"] = kept;
    terminal.document(document);
}

}  // namespace

void addStabilize(CLI::App& app, Terminal& terminal)
{
    const auto [verb, o] = addVerb<StabilizeArguments>(
        app, terminal, step::fit, "stabilize",
        "Replace an unstable linear model by a stable one, and show what each step costs", run);
    verb->add_option("MODEL", o->model, "the model, as identify --allow-unstable wrote it")->required();
    verb->add_option("--method", o->method,
                     "mirror unstable poles, project on the stable part, add a delay and refit, or decompose into a "
                     "stable and an unstable model")
        ->check(CLI::IsMember({"mirror", "project", "delay", "decompose"}))
        ->capture_default_str();
    verb->add_option("--frf", o->response.path,
                     "the take or response to refit the model to; by default the model's own response")
        ->type_name("TAKE");
    verb->add_option("--level", o->response.level, "number of the take's level, 0 the quietest; by default the loudest")
        ->check(CLI::NonNegativeNumber);
    verb->add_option("--seconds", o->seconds, "the delay to add; by default the one that fits best");
    verb->add_flag("--no-refit", o->unfitted, "leave out the constrained fit at the end");
    verb->add_option("--unstable", o->unstable, "write the unstable part of --method decompose, a .json")
        ->type_name("FILE");
    verb->add_option("--out", o->out, "the stable model, a .json")->required()->type_name("FILE");
}

}  // namespace excursion::cli
