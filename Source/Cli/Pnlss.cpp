// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/Pnlss.h"

#include "Cli/Destination.h"
#include "Cli/Verbs.h"
#include "Engine/Import/ReadTake.h"

#include "Engine/BlackBox/Stimulus.h"
#include "Engine/Check/PreparedTake.h"
#include "Engine/Document/JsonText.h"
#include "Engine/Error.h"
#include "Engine/Polynomial/Pnlss/LinearStarts.h"
#include "Engine/Polynomial/Pnlss/PnlssFile.h"
#include "Engine/Polynomial/Pnlss/Recursion.h"
#include "Engine/Polynomial/Pnlss/ResidualTest.h"
#include "Engine/Polynomial/Volterra/VolterraSeriesFile.h"
#include "Engine/Ranking/Agreement.h"
#include "Engine/Ranking/PolynomialFitFile.h"
#include "Engine/Take/ChannelNamed.h"
#include "Engine/Take/TakeFile.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>

namespace excursion::cli {
namespace {

/// The take as the model plays it: the input as it is, the output from rest.
void writePlayed(const PnlssTake& data, const Eigen::MatrixXd& y, const std::string& folder)
{
    if (!y.allFinite())
        throw Error(Error::Kind::numerical, "The model runs away on this take, so nothing was written.");
    auto played = data.take;
    played.channels = {*data.input, *data.output};
    played.channels[1].samples.assign(y.data(), y.data() + y.size());
    played.channels[1].fullScale = std::max(data.output->fullScale, y.cwiseAbs().maxCoeff());
    writeMeasurement(played, folder);
}

/// The Volterra series of the model.
void writeKernels(const PnlssArguments& options, const PnlssTake& data, const PnlssOutcome& outcome)
{
    const nlohmann::json document(outcome.model);
    if (document.value("format", "") != "excursion-pnlss")
        throw Error(Error::Kind::usage, "--volterra is for models of whole order.");
    const auto named = pnlssFromJson(JsonField(document, "", "the model"));
    const Named<VolterraSeries> series {
        named.name, std::string(name(data.input->quantity)), std::string(name(data.output->quantity)),
        volterraSeries(named.model, options.memory[0], options.memory[1], options.memory[2])};
    writeJson(toJson(series), options.volterra);
}

bool isFractional(const PnlssArguments& options, const nlohmann::json& kept)
{
    return kept.is_object() ? kept.value("format", "") == "excursion-fractional-pnlss" : !options.alpha.empty();
}

/// The channels that a kept model connects, or those that are asked for.
void choose(const PnlssArguments& options, const nlohmann::json& kept, PnlssTake& data)
{
    if (!kept.is_null()) {
        const JsonField linear = JsonField(kept, "", options.model).at("linear");
        const auto inputs = linear.at("inputs").items(), outputs = linear.at("outputs").items();
        if (inputs.size() != 1 || outputs.size() != 1)
            throw Error(Error::Kind::data,
                        "The model has several inputs or outputs; a take is judged with one of each.");
        data.input = &channelNamed(data.take, inputs[0].text());
        data.output = &channelNamed(data.take, outputs[0].text());
    } else {
        data.input = &data.take.input();
        data.output = &outputNamed(data.take, options.response.output, data.input->quantity);
    }
    data.records = recordsOf(data.take, *data.input, *data.output, options.response.level);
    if (!isFractional(options, kept) && !data.periodic())
        data.records.estimation.front().skip = 0;  // its first state is estimated
}

void require(const PnlssArguments& options)
{
    if (options.model.empty() == (options.order == 0 && !options.mixed && options.start.empty()))
        throw Error(Error::Kind::usage,
                    "Give either --order (or --start, or --alpha with --mixed), to fit a model, or --model, to judge "
                    "one that was kept.");
    if (!options.start.empty() && !options.alpha.empty())
        throw Error(Error::Kind::usage, "--start is a model of whole order; leave --alpha out.");
    if (options.mixed && (options.alpha.empty() || options.order != 0))
        throw Error(
            Error::Kind::usage,
            "--mixed is a driver's current under a voltage, of three states: give --alpha, and leave --order out.");
    if (!options.terms.empty()
        && (!options.alpha.empty() || !options.model.empty() || options.offset || options.mask != "full"))
        throw Error(Error::Kind::usage, "--terms lists the monomials of a model of whole order that is fitted: leave "
                                        "--alpha, --model, --mask and --offset "
                                        "out; the offset is the monomial 1.");
    if (!options.model.empty() && !options.out.empty())
        throw Error(Error::Kind::usage, "--out is for a model that is fitted; --model is kept already.");
    if (!options.out.empty())
        requireFilePlace(options.out);
    if (!options.played.empty())
        requireFolderPlace(options.played);
    if (!options.volterra.empty())
        requireFilePlace(options.volterra);
}

void run(PnlssArguments options, Terminal& terminal)
{
    require(options);
    PnlssTake data;
    data.take = PreparedTake(readMeasurement(options.response.path)).settled();
    data.take.levelOf(options.response.level);  // asked before the work, not in it
    const auto kept = options.model.empty() ? nlohmann::json() : readJson(options.model);
    choose(options, kept, data);
    options.response.output = name(data.output->quantity);
    auto outcome = (isFractional(options, kept) ? fractionalPnlss : integerPnlss)(options, data, terminal);
    if (!std::isfinite(outcome.estimationDb))
        throw Error(Error::Kind::numerical,
                    "The model runs away on the records that it was to explain; try another --order or --mask.");
    if (options.model.empty())
        outcome.model["stimulus"] = toJson(stimulusOf(data.records.estimation, data.take.sampleRate));
    if (!options.out.empty())
        writeJson(outcome.model, options.out);
    if (!options.volterra.empty())
        writeKernels(options, data, outcome);
    if (!options.played.empty())
        writePlayed(data, outcome.play(data.wholeInput()), options.played);

    if (options.model.empty())
        terminal.say((options.start.empty() ? "linear part alone: " : "start: ") + errorText(outcome.startDb) + " dB; "
                     + std::to_string(outcome.search.iterations) + " iterations: " + outcome.search.message + ".");
    if (!outcome.alpha.empty())
        terminal.say("alpha " + outcome.alpha);
    const bool validated = !data.records.validation.empty();
    terminal.table(
        {"records", "error dB"},
        {{"estimation", errorText(outcome.estimationDb)},
         {"validation", errorText(validated ? outcome.validationDb : std::numeric_limits<double>::quiet_NaN())}});
    const auto arrival = arrivalOf(options, data, outcome);
    terminal.say(arrival.sentence);
    if (!arrival.advice.empty())
        terminal.say(arrival.advice);
    if (!outcome.stable)
        terminal.say("The linear part of this model is not stable.");
    for (const auto& written : {options.out, options.volterra, options.played})
        if (!written.empty())
            terminal.say("Wrote " + written + ".");

    std::optional<Agreement> found;
    if (options.laws) {
        found = agreement(data.take, data.output->quantity, outcome.play, terminal.progress());
        terminal.say(found->sentence + " The driver without effects leaves " + errorText(found->baseDb)
                     + " dB of what the model plays, with them " + errorText(found->leftDb) + " dB.");
    }

    PolynomialFit fit;
    fit.take = options.response.path;
    fit.estimationDb = outcome.estimationDb;
    if (validated)
        fit.validationDb = outcome.validationDb;
    fit.noiseDb = arrival.noiseDb;
    if (arrival.noiseDb)
        fit.noiseFrom = arrival.noiseFrom;
    fit.arrived = arrival.arrived;
    fit.advice = arrival.advice;
    fit.iterations = outcome.search.iterations;
    fit.stopped = options.model.empty() ? outcome.search.message : "a model that was kept";
    fit.stable = outcome.stable;
    fit.history = outcome.history;
    if (found)
        fit.laws = *found;
    fit.model = outcome.model;
    terminal.document(toJson(fit));
    if (!outcome.stable)
        terminal.answer = 1;
}

}  // namespace

Eigen::MatrixXd PnlssTake::wholeInput() const
{
    return Eigen::Map<const Eigen::VectorXd>(input->samples.data(), static_cast<Eigen::Index>(input->samples.size()));
}

TermMask maskNamed(const std::string& wanted)
{
    for (const auto mask : termMasks())
        if (name(mask) == wanted)
            return mask;
    throw Error(Error::Kind::usage, "There is no mask \"" + wanted + "\".");
}

PnlssOutcome integerPnlss(const PnlssArguments& options, const PnlssTake& data, Terminal& terminal)
{
    const auto &estimation = data.records.estimation, &validation = data.records.validation;
    PnlssOutcome outcome;
    NamedPnlss named;
    if (!options.model.empty()) {
        named = readDocument(options.model, pnlssFromJson);
        if (named.model.linear.sampleRate != data.take.sampleRate)
            throw Error(Error::Kind::data, "The model is one at " + significant(named.model.linear.sampleRate, 8)
                                               + " Hz, the take at " + significant(data.take.sampleRate, 8) + " Hz.");
        std::vector<Eigen::VectorXd> initial;
        if (!data.periodic()) {
            initial = {initialStateOf(named.model, estimation.front())};
            outcome.untold = untoldNoise(named.model, estimation, initial);
        }
        outcome.estimationDb = relativeErrorDb(named.model, estimation, initial);
        outcome.validationDb = relativeErrorDb(named.model, validation, initial);
        outcome.stable = isStable(named.model.linear) && std::isfinite(outcome.estimationDb);
    } else {
        const auto starts = startsFor(options, data);
        PnlssFitOptions fitting;
        fitting.maximumIterations = options.iterations;
        fitting.enoughDb = data.records.enoughDb();
        fitting.estimateInitialStates = fitting.judgeResidual = !data.periodic();
        const auto fit = fitPnlss(starts, estimation, validation, fitting, terminal.progress());
        outcome = {
            relativeErrorDb(starts[0].model, validation.empty() ? estimation : validation, starts[0].initialStates),
            fit.estimationDb,
            fit.validationDb,
            fit.stable,
            fit,
            fit.history,
            "",
            {},
            {},
            fit.untold,
            Recursion(fit.model, true).parameters()};
        std::vector<Eigen::MatrixXd> played;
        for (std::size_t k = 0; k < estimation.size(); ++k)
            played.push_back(
                simulate(starts[0].model, estimation[k].input,
                         k < starts[0].initialStates.size() ? starts[0].initialStates[k] : Eigen::VectorXd()));
        outcome.constantShare = constantShareOf(starts[0].model.exponents, estimation, played);
        named = {std::filesystem::path(options.response.path).stem().string(),
                 {std::string(name(data.input->quantity))},
                 {std::string(name(data.output->quantity))},
                 fit.model};
    }
    outcome.model = toJson(named);
    outcome.play = [model = named.model](const Eigen::MatrixXd& u) { return simulate(model, u); };
    return outcome;
}

void addPnlss(CLI::App& app, Terminal& terminal)
{
    auto o = std::make_shared<PnlssArguments>();
    auto* verb = app.add_subcommand(
                        "pnlss",
                        "Fit a polynomial state-space model to a take: it knows no physics, and explains what it can")
                     ->group(step::fit);
    std::vector<std::string> masks;
    for (const auto mask : termMasks())
        masks.emplace_back(name(mask));
    verb->add_option("TAKE", o->response.path, "the take: a folder, or a .csv of time signals")->required();
    verb->add_option("--order", o->order, "number of states")->check(CLI::Range(1, 100));
    verb->add_option("--start", o->start,
                     "start the fit from this model: a linear one from identify, one that pnlss kept, a block model "
                     "from rank, or a driver")
        ->type_name("MODEL");
    verb->add_option("--alpha", o->alpha, "states of fractional order alpha, a number below 1, or free to fit it, too");
    verb->add_flag("--mixed", o->mixed,
                   "with --alpha, for a current under a voltage: only the coil's state is of fractional order");
    verb->add_option("--degree", o->degree, "highest degree of the monomials")
        ->capture_default_str()
        ->check(CLI::Range(2, 9));
    verb->add_option("--mask", o->mask, "which monomials")->capture_default_str()->check(CLI::IsMember(masks));
    verb->add_option(
            "--terms", o->terms,
            "these monomials in place of --degree and --mask, such as x1^3,x1*x2,u^2; states are numbered from 1")
        ->type_name("LIST");
    verb->add_flag("--linear-output", o->noOutputTerms, "no monomials in the output equation");
    verb->add_flag("--offset", o->offset, "also constants in both equations, for sensors with an offset");
    verb->add_option("--output", o->response.output, "the channel to explain; by default the first beside the input");
    verb->add_option("--level", o->response.level, "number of the level, 0 the quietest; by default the loudest")
        ->check(CLI::NonNegativeNumber);
    verb->add_option("--iterations", o->iterations, "largest number of iterations for each start that is tried")
        ->capture_default_str()
        ->check(CLI::Range(1, 10000));
    verb->add_option("--model", o->model, "judge this kept model instead of fitting one")->type_name("FILE");
    verb->add_option("--out", o->out, "the model, a .json")->type_name("FILE");
    verb->add_option("--played", o->played, "also write the take as the model plays it")->type_name("DIR");
    verb->add_option("--volterra", o->volterra, "also write the model's Volterra kernels to order 3, a .json")
        ->type_name("FILE");
    verb->add_option("--memory", o->memory, "samples of the kernels of order 1, 2 and 3; 0 leaves 2 or 3 out")
        ->capture_default_str()
        ->expected(3)
        ->delimiter(',');
    verb->add_flag(
        "--laws", o->laws,
        "also tell which physical laws the model agrees with, by diagnosing what it plays as if it were a loudspeaker");
    verb->footer("Exit code 1: the linear part of the model is not stable.");
    verb->callback([o, &terminal, verb] {
        for (const auto* option : {"--degree", "--mask", "--terms", "--offset"})
            o->chosenTerms = o->chosenTerms || verb->count(option) > 0;
        run(*o, terminal);
    });
}

}  // namespace excursion::cli
