// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/Destination.h"
#include "Cli/OpenResponse.h"
#include "Cli/Terminal.h"
#include "Cli/Verbs.h"

#include "Engine/Document/JsonText.h"
#include "Engine/Error.h"
#include "Engine/Linear/Identify.h"
#include "Engine/Measurement/FindExcitation.h"
#include "Engine/Measurement/Periods.h"
#include "Engine/Measurement/TakeFile.h"
#include "Engine/Polynomial/PnlssFile.h"
#include "Engine/Polynomial/PnlssFit.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>

namespace excursion::cli {
namespace {

using Eigen::Index;
using Json = nlohmann::ordered_json;

struct PnlssArguments {
    ResponseChoice response;
    std::string model, out, played, mask = "full";
    int order = 0, degree = 3, iterations = 50;
    bool noOutputTerms = false, offset = false, guided = false;
};

struct Records {
    std::vector<PnlssRecord> estimation, validation;
};

const Channel& channelNamed(const Measurement& take, const std::string& quantity)
{
    const auto known = quantityNamed(quantity);
    const auto* channel = known ? take.find(*known) : nullptr;
    if (!channel)
        throw Error(Error::Kind::usage, "The take has no channel \"" + quantity + "\".");
    return *channel;
}

Eigen::MatrixXd column(std::span<const double> samples)
{
    return Eigen::Map<const Eigen::VectorXd>(samples.data(), static_cast<Index>(samples.size()));
}

/// Averaged periods of every realization at one level, the last one for validation; the last third of a take without periods.
Records recordsOf(const Measurement& take, const Channel& input, const Channel& output, int wantedLevel)
{
    Records records;
    if (!take.excitation || take.excitation->lines.empty()) {
        const auto N = static_cast<Index>(take.length()), cut = N * 2 / 3;
        const auto u = column(input.samples), y = column(output.samples);
        const Index skip = std::min<Index>(1000, N / 10);
        records.estimation.push_back({u.topRows(cut), y.topRows(cut), skip, false});
        records.validation.push_back({u.bottomRows(N - cut), y.bottomRows(N - cut), skip, false});
        return records;
    }
    const auto& excitation = periodicExcitation(take);
    const int level = wantedLevel >= 0 ? wantedLevel : static_cast<int>(excitation.levels.size()) - 1;
    for (int r = 0; r < excitation.realizations; ++r) {
        const auto record = periodicRecord(column(averagePeriod(take, input, level, r)), column(averagePeriod(take, output, level, r)),
                                           std::min(excitation.period, 4096));
        const bool last = excitation.realizations > 1 && r + 1 == excitation.realizations;
        (last ? records.validation : records.estimation).push_back(record);
    }
    return records;
}

/// The take as the model plays it: the input as it is, the output from rest.
void writePlayed(const Pnlss& model, const Measurement& take, const Channel& input, const Channel& output, const std::string& folder)
{
    auto played = take;
    played.channels = {input, output};
    const auto y = simulate(model, column(input.samples));
    if (!y.allFinite())
        throw Error(Error::Kind::numerical, "The model runs away on this take, so nothing was written.");
    played.channels[1].samples.assign(y.data(), y.data() + y.size());
    played.channels[1].fullScale = std::max(output.fullScale, y.cwiseAbs().maxCoeff());
    writeMeasurement(played, folder);
}

std::string decibels(double db) { return std::isfinite(db) ? fixed(db, 1) : "runs away"; }

TermMask maskNamed(const std::string& wanted)
{
    for (const auto mask : termMasks())
        if (name(mask) == wanted)
            return mask;
    throw Error(Error::Kind::usage, "There is no mask \"" + wanted + "\".");
}

Pnlss startFor(const PnlssArguments& options, const Measurement& take, int level)
{
    auto choice = options.response;
    choice.level = level;
    IdentifyOptions identifying;
    identifying.order = options.order;
    identifying.sampleRate = take.sampleRate;
    const auto linear = identify(frequencyDataOf(openResponse(choice).frf), identifying).model;
    auto start = withTerms(linear, options.degree, maskNamed(options.mask), options.offset);
    if (options.noOutputTerms)
        start.free.bottomRows(linear.outputs()).rightCols(start.terms() - (options.offset ? 1 : 0)).setConstant(false);
    return start;
}

void run(const PnlssArguments& options, Terminal& terminal)
{
    if (options.model.empty() == (options.order == 0))
        throw Error(Error::Kind::usage, "Give either --order, to fit a model, or --model, to judge one that was kept.");
    if (!options.model.empty() && !options.out.empty())
        throw Error(Error::Kind::usage, "--out is for a model that is fitted; --model is kept already.");
    if (!options.out.empty())
        requireFilePlace(options.out);
    if (!options.played.empty())
        requireFolderPlace(options.played);
    auto take = readMeasurement(options.response.path);
    completeExcitation(take);
    const auto levels = take.excitation ? static_cast<int>(take.excitation->levels.size()) : 0;
    if (options.response.level >= std::max(levels, 1))
        throw Error(Error::Kind::usage, "The take has " + std::to_string(levels) + " levels, numbered from 0.");

    NamedPnlss named;
    PnlssFit fit;
    if (!options.model.empty()) {
        named = readPnlss(options.model);
        if (named.inputs.size() != 1 || named.outputs.size() != 1)
            throw Error(Error::Kind::data, "The model has several inputs or outputs; a take is judged with one of each.");
        if (named.model.linear.sampleRate != take.sampleRate)
            throw Error(Error::Kind::data, "The model is one at " + significant(named.model.linear.sampleRate, 8) + " Hz, the take at "
                                               + significant(take.sampleRate, 8) + " Hz.");
    } else {
        named.inputs = {std::string(name(take.input().quantity))};
        std::string output = options.response.output;
        for (const auto& channel : take.channels)
            if (output.empty() && channel.quantity != take.input().quantity)
                output = name(channel.quantity);
        named.outputs = {output};
        named.name = std::filesystem::path(options.response.path).stem().string();
    }
    const auto& input = channelNamed(take, named.inputs[0]);
    const auto& output = channelNamed(take, named.outputs[0]);
    const auto records = recordsOf(take, input, output, options.response.level);
    if (options.model.empty()) {
        const auto start = startFor(options, take, options.response.level);
        PnlssFitOptions fitting;
        fitting.maximumIterations = options.iterations;
        if (options.guided)
            fitting.guideGains = {1.0, 0.3, 0.1};
        const double before = relativeErrorDb(start, records.validation.empty() ? records.estimation : records.validation);
        fit = fitPnlss(start, records.estimation, records.validation, fitting, terminal.progress());
        named.model = fit.model;
        terminal.say("linear part alone: " + decibels(before) + " dB; " + std::to_string(fit.iterations) + " iterations: " + fit.reason + ".");
    } else {
        fit.model = named.model;
        fit.reason = "a model that was kept";
        fit.estimationDb = relativeErrorDb(named.model, records.estimation);
        fit.validationDb = relativeErrorDb(named.model, records.validation);
        fit.stable = isStable(named.model.linear) && std::isfinite(fit.estimationDb);
    }
    if (!std::isfinite(fit.estimationDb))
        throw Error(Error::Kind::numerical, "The model runs away on the records that it was to explain; try --guided, another --order or --mask.");
    if (!options.out.empty())
        writePnlss(named, options.out);
    if (!options.played.empty())
        writePlayed(named.model, take, input, output, options.played);

    terminal.table({"records", "error dB"}, {{"estimation", decibels(fit.estimationDb)},
                                             {"validation", records.validation.empty() ? "-" : decibels(fit.validationDb)}});
    if (!fit.stable)
        terminal.say("The linear part of this model is not stable.");
    if (!options.out.empty())
        terminal.say("Wrote " + options.out + ".");
    if (!options.played.empty())
        terminal.say("Wrote " + options.played + ".");

    Json document {{"format", "excursion-pnlss-fit"}, {"version", 1}, {"take", options.response.path}};
    document["estimationDb"] = fit.estimationDb;
    document["validationDb"] = records.validation.empty() ? Json() : numberOrNull(fit.validationDb);
    document["iterations"] = fit.iterations;
    document["stopped"] = fit.reason;
    document["stable"] = fit.stable;
    document["history"] = numbersOrNulls(fit.history);
    document["model"] = toJson(named);
    terminal.document(document);
    if (!fit.stable)
        terminal.answer = 1;
}

} // namespace

void addPnlss(CLI::App& app, Terminal& terminal)
{
    auto o = std::make_shared<PnlssArguments>();
    auto* verb = app.add_subcommand("pnlss", "Fit a polynomial state-space model to a take: it knows no physics, and explains what it can")
                     ->group(step::fit);
    std::vector<std::string> masks;
    for (const auto mask : termMasks())
        masks.emplace_back(name(mask));
    verb->add_option("TAKE", o->response.path, "the take: a folder, or a .csv of time signals")->required();
    verb->add_option("--order", o->order, "number of states")->check(CLI::Range(1, 100));
    verb->add_option("--degree", o->degree, "highest degree of the monomials")->capture_default_str()->check(CLI::Range(2, 9));
    verb->add_option("--mask", o->mask, "which monomials")->capture_default_str()->check(CLI::IsMember(masks));
    verb->add_flag("--linear-output", o->noOutputTerms, "no monomials in the output equation");
    verb->add_flag("--offset", o->offset, "also constants in both equations, for sensors with an offset");
    verb->add_option("--output", o->response.output, "the channel to explain; by default the first beside the input");
    verb->add_option("--level", o->response.level, "number of the level, 0 the quietest; by default the loudest")->check(CLI::NonNegativeNumber);
    verb->add_option("--iterations", o->iterations, "at most")->capture_default_str()->check(CLI::Range(1, 10000));
    verb->add_flag("--guided", o->guided, "begin with a model that follows the measured output: for linear starts that run away");
    verb->add_option("--model", o->model, "judge this model, which was kept, instead of fitting one")->type_name("FILE");
    verb->add_option("--out", o->out, "the model, a .json")->type_name("FILE");
    verb->add_option("--played", o->played, "also write the take as the model plays it")->type_name("DIR");
    verb->footer("Exit code 1: the linear part of the model is not stable.");
    verb->callback([o, &terminal] { run(*o, terminal); });
}

} // namespace excursion::cli
