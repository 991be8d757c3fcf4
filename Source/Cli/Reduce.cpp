// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/Destination.h"
#include "Cli/OpenModel.h"
#include "Cli/OpenResponse.h"
#include "Cli/Terminal.h"
#include "Cli/Verbs.h"

#include "Engine/Document/DocumentFormat.h"
#include "Engine/Document/JsonText.h"
#include "Engine/Error.h"
#include "Engine/Linear/IdentificationFile.h"
#include "Engine/Linear/PoleZeroReduction.h"
#include "Engine/Linear/Reduction.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

namespace excursion::cli {
namespace {

using Json = nlohmann::ordered_json;

struct ReduceArguments {
    std::string model, out;
    ResponseChoice response;
    int order = -1;
    double errorDb = 0.0, rippleDb = 0.0;
    std::vector<double> band;
    bool settled = false;
};

void balance(const ReduceArguments& options, OpenModel& open, Json& document, Terminal& terminal)
{
    if (options.order < 0)
        throw Error(Error::Kind::usage,
                    "Give the --order to reduce the model to, a --ripple to allow, or a --response to prune it by.");
    if (open.fractional)
        throw Error(Error::Kind::usage, "A model of fractional order has no Gramians to balance it by: give the "
                                        "--ripple to allow, or a --response to prune it by.");
    auto& named = open.named;
    const auto all = balanced(named.model);
    const double bound = truncationBound(all, options.order);
    named.model = truncated(all, options.order,
                            options.settled ? Truncation::singularPerturbation : Truncation::direct);
    document["method"] = options.settled ? "singular-perturbation" : "balanced-truncation";
    document["singularValues"] = numbersOrNulls({all.singularValues.begin(), all.singularValues.end()});
    document["bound"] = bound;
    terminal.say("Balanced and truncated to order " + std::to_string(named.model.order())
                 + ": the response changes by at most " + significant(bound, 3) + " at any frequency.");
}

void pruneBy(const ReduceArguments& options, OpenModel& open, Json& document, Terminal& terminal)
{
    auto& named = open.named;
    if (named.model.inputs() != 1 || named.model.outputs() != 1)
        throw Error(Error::Kind::data, "Only models with one input and one output are pruned by a response.");
    if (options.order < 0 && options.errorDb == 0.0)
        throw Error(Error::Kind::usage, "Give --order or --error, to say where the pruning is to end.");
    auto choice = options.response;
    choice.input = named.inputs[0];
    choice.output = named.outputs[0];
    const auto data = frequencyDataOf(openResponse(choice).frf);
    const double rate = named.model.sampleRate;
    const double scale = rate > 0.0 ? 1.0 : std::pow(2.0 * std::numbers::pi * data.frequency.back(), open.alpha);
    const auto start = fitPartialFractions(sectionsOf(poles(named.model), rate, scale, open.alpha), data);
    PruningOptions pruning;
    pruning.order = std::max(options.order, 0);
    pruning.errorDb = options.errorDb;
    const auto result = prune(start, data, pruning, terminal.progress());
    named.model = realize(result.fit.sections, result.fit.C, result.fit.D);
    document["method"] = "pruning";
    document["stopped"] = result.reason;
    document["steps"] = Json::array();
    std::vector<std::vector<std::string>> rows;
    for (const auto& step : result.steps) {
        document["steps"].push_back({{"order", step.order}, {"weightedErrorDb", step.errorDb}});
        rows.push_back({std::to_string(step.order), fixed(step.errorDb, 1)});
    }
    document["errorDb"] = judged(named.model, data, open.alpha).errorDb;
    terminal.table({"order", "weighted error dB"}, rows);
    terminal.say("Ended: " + result.reason + ".");
}

void takeOut(const ReduceArguments& options, OpenModel& open, Json& document, Terminal& terminal)
{
    auto& named = open.named;
    PoleZeroReductionOptions reduction;
    reduction.alpha = open.alpha;
    reduction.rippleDb = options.rippleDb;
    reduction.order = std::max(options.order, 0);
    if (!options.band.empty()) {
        reduction.low = options.band[0];
        reduction.high = options.band[1];
    }
    const auto result = reduceByPolesAndZeros(named.model, reduction);
    // roots are told as the model's own, z, s or s^alpha
    const double origin = named.model.continuous() ? 0.0 : 1.0;
    named.model = result.model;
    named.delay += result.delay;
    document["method"] = "poles-and-zeros";
    document["stopped"] = result.reason;
    document["delay"] = result.delay;
    document["steps"] = Json::array();
    std::vector<std::vector<std::string>> rows;
    for (const auto& step : result.steps) {
        document["steps"].push_back({{"order", step.order},
                                     {"cancelled", step.cancelled},
                                     {"poles", rootsJson(step.poles, origin)},
                                     {"zeros", rootsJson(step.zeros, origin)},
                                     {"boundDb", step.boundDb},
                                     {"rippleDb", step.rippleDb},
                                     {"errorBound", numberOrNull(step.errorBound)},
                                     {"error", step.error}});
        rows.push_back({std::to_string(step.order), step.cancelled ? "pair" : "remote", fixed(step.boundDb, 3),
                        fixed(step.rippleDb, 3)});
    }
    terminal.table({"order", "taken out", "bound dB", "ripple dB"}, rows);
    terminal.say("Ended: " + result.reason + ".");
    if (result.delay != 0.0)
        terminal.say("The model answers " + significant(-1e6 * result.delay, 4)
                     + " us earlier than the one it came from.");
}

void run(const ReduceArguments& options, Terminal& terminal)
{
    requireFilePlace(options.out);
    auto open = openModel(options.model);
    const auto& model = open.named.model;
    Json document = DocumentFormat {"excursion-reduction"}.with({{"source", options.model}, {"from", model.order()}});
    if (options.rippleDb > 0.0)
        takeOut(options, open, document, terminal);
    else if (options.response.path.empty())
        balance(options, open, document, terminal);
    else
        pruneBy(options, open, document, terminal);
    document["order"] = model.order();
    document["stable"] = isStable(open);
    const auto kept = documentOf(open);
    writeJson(kept, options.out);
    terminal.say("Wrote " + options.out + ".");
    document["model"] = kept;
    terminal.document(document);
}

}  // namespace

void addReduce(CLI::App& app, Terminal& terminal)
{
    const auto [verb, o] = addVerb<ReduceArguments>(
        app, terminal, step::fit, "reduce",
        "Replace a large linear model by a smaller one, with a bound on the error or the error itself", run);
    verb->add_option("MODEL", o->model, "the model, as identify wrote it")->required();
    verb->add_option("--order", o->order, "the order to reduce it to")->check(CLI::Range(0, 400));
    verb->add_option("--response", o->response.path,
                     "prune against this take or response, refitting after every step; without it the model is "
                     "balanced and truncated")
        ->type_name("TAKE");
    verb->add_option("--level", o->response.level, "number of the take's level, 0 the quietest; by default the loudest")
        ->check(CLI::NonNegativeNumber);
    verb->add_option("--error", o->errorDb, "stop pruning before the weighted error exceeds this, dB")
        ->check(CLI::Range(-400.0, 0.0));
    verb->add_option(
            "--ripple", o->rippleDb,
            "remove remote poles and zeros, and pairs that cancel, as long as the total ripple stays below this, dB")
        ->check(CLI::Range(0.0, 60.0))
        ->excludes("--response");
    verb->add_option(
            "--band", o->band,
            "lowest and highest frequency at which the ripple counts, Hz; a model of continuous time needs them")
        ->delimiter(',')
        ->expected(2)
        ->needs("--ripple");
    verb->add_flag("--settled", o->settled, "truncated states are taken as settled: exact at frequency 0");
    verb->add_option("--out", o->out, "the smaller model, a .json")->required()->type_name("FILE");
}

}  // namespace excursion::cli
