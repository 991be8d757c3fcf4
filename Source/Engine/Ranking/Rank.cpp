// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Ranking/Rank.h"

#include "Engine/BlackBox/Stimulus.h"
#include "Engine/Check/TakeResponse.h"
#include "Engine/Document/Engineering.h"
#include "Engine/Error.h"
#include "Engine/Linear/OrderSweep.h"
#include "Engine/Ranking/Predistortion.h"
#include "Engine/Ranking/ModelClasses.h"
#include "Engine/Validity.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <limits>
#include <new>

namespace excursion {
namespace {

struct Fitting {
    ModelClass told;
    FittedClass (*fit)(const RankedTake&, const Progress&);
    double share;  // of the whole work, about
};

const std::vector<Fitting>& fittings()
{
    static const std::vector<Fitting> all {
        {{"linear", "linear state space, order by minimum description length"}, fitLinearClass, 0.01},
        {{"fractional", "linear, R + L s^alpha and a resonance"}, fitFractionalClass, 0.01},
        {{"hammerstein", "powers of the input through filters"}, fitHammersteinClass, 0.08},
        {{"block", "linear dynamics with polynomials before, behind and in a loop around them"}, fitBlockClass, 0.08},
        {{"narx", "a polynomial in past inputs and outputs"}, fitNarxClass, 0.12},
        {{"pnlss", "polynomial state space"}, fitPnlssClass, 0.2},
        {{"fractional-pnlss", "polynomial state space, the coil's state of fractional order"},
         fitFractionalPnlssClass,
         0.15},
        {{"driver", "the physical driver without effects"}, fitDriverClass, 0.05},
        {{"driver-with-effects", "the physical driver with the effects that were found missing"},
         fitDriverWithEffectsClass,
         0.3}};
    return all;
}

double errorDb(const FittedClass& fitted, const std::vector<InputOutputRecord>& records)
{
    std::vector<Eigen::MatrixXd> outputs;
    for (const auto& record : records)
        outputs.push_back(fitted.play(record));
    return outputErrorDb(outputs, records);
}

double secondsSince(std::chrono::steady_clock::time_point start)
{
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

RankedModel judge(const Fitting& fitting, const RankedTake& data, const Progress& progress)
{
    RankedModel model;
    model.name = fitting.told.name;
    try {
        const auto start = std::chrono::steady_clock::now();
        const auto fitted = fitting.fit(data, progress);
        model.fitSeconds = secondsSince(start);
        model.description = fitted.description;
        model.parameters = fitted.parameters;
        model.document = fitted.document;
        if (!model.document.is_null())
            model.document["stimulus"] = toJson(
                stimulusOf(data.records.estimation, data.take.measurement().sampleRate));
        model.estimationDb = errorDb(fitted, data.records.estimation);
        const auto& judges = data.records.validation.empty() ? data.records.estimation : data.records.validation;
        const auto playing = std::clock();
        const double judged = errorDb(fitted, judges);
        double samples = 0.0;
        for (const auto& record : judges)
            samples += static_cast<double>(record.input.rows());
        model.load = static_cast<double>(std::clock() - playing) / CLOCKS_PER_SEC * data.take.measurement().sampleRate
                     / samples;
        model.validationDb = data.records.validation.empty() ? std::numeric_limits<double>::quiet_NaN() : judged;
        model.stable = fitted.stable && std::isfinite(model.estimationDb) && std::isfinite(judged);
    } catch (const Error& e) {
        model.trouble = e.what();
    } catch (const std::bad_alloc&) {
        model.trouble = "There is not enough memory to fit it to so long a take.";
    }
    return model;
}

/// Which class linearizes best: among those within half a decibel, the one with the least load.
void tellStraightest(Ranking& ranking)
{
    const auto worthIt = [](const RankedModel& m) { return m.trouble.empty() && m.predistortion.trouble.empty(); };
    double least = std::numeric_limits<double>::infinity();
    for (const auto& model : ranking.models)
        if (worthIt(model))
            least = std::min(least, model.predistortion.leftDb);
    const RankedModel* chosen = nullptr;
    for (const auto& model : ranking.models)
        if (worthIt(model) && model.predistortion.leftDb < least + 0.5
            && (!chosen || model.predistortion.load < chosen->predistortion.load))
            chosen = &model;
    if (!chosen) {
        ranking.straightSentence = "No class of models linearizes this take.";
        return;
    }
    const auto& told = chosen->predistortion;
    ranking.straightest = chosen->name;
    ranking.straightSentence = "\"" + chosen->name + "\" linearizes best: it brings the distortion from "
                               + plainText(told.beforeDb, 1) + " to " + plainText(told.leftDb, 1) + " dB, with "
                               + plainText(100.0 * told.load, 2) + " % of a core a channel and a latency of "
                               + plainText(1e3 * told.latency, 1) + " ms.";
}

}  // namespace

bool RankOptions::isValid(std::string* reason) const
{
    if (order < 0 || order > 20 || degree < 2 || degree > 7 || iterations < 1)
        return refuse(reason, "an order of at most 20, a degree of 2 to 7 and at least one iteration are needed");
    for (const auto& wanted : classes)
        if (std::none_of(fittings().begin(), fittings().end(), [&](const Fitting& f) { return f.told.name == wanted; }))
            return refuse(reason, "there is no class of models \"" + wanted + "\"");
    return true;
}

const RankedModel* explainingMost(const std::vector<RankedModel>& models)
{
    const auto counts = [](const RankedModel& m) { return m.trouble.empty() && m.stable; };
    const auto first = std::find_if(models.begin(), models.end(), counts);
    const RankedModel* chosen = nullptr;
    for (auto m = first; m != models.end(); ++m)
        if (counts(*m) && m->judgedDb() < first->judgedDb() + 0.5 && (!chosen || m->parameters < chosen->parameters))
            chosen = &*m;
    return chosen;
}

const std::vector<ModelClass>& modelClasses()
{
    static const std::vector<ModelClass> all = [] {
        std::vector<ModelClass> classes;
        for (const auto& fitting : fittings())
            classes.push_back(fitting.told);
        return classes;
    }();
    return all;
}

Ranking rank(const PreparedTake& given, const RankOptions& options, const Progress& progress)
{
    std::string reason;
    if (!options.isValid(&reason))
        throw Error(Error::Kind::usage, "Models cannot be ranked: " + reason + ".");
    const auto& take = given.settled();
    const auto& input = take.input();
    const Channel* output = nullptr;
    for (const auto& channel : take.channels)
        if (options.output ? channel.quantity == *options.output : !output && channel.quantity != input.quantity)
            output = &channel;
    if (!output || output == &input)
        throw Error(Error::Kind::data, "The take has no such channel beside its input.");
    const int level = take.levelOf(options.level);

    progress.at(0.0, "the linear model");
    const auto response = frequencyDataOf(responseOf(given, {std::string(name(output->quantity)), {}, level}).frf);
    OrderSweepOptions sweeping;
    sweeping.orders = ordersWithin({2, 3, 4, 5, 6, 8}, response);
    sweeping.identify.sampleRate = take.sampleRate;
    const auto sweep = sweepOrders(response, sweeping);
    const auto linear = sweep.entries[sweep.chosen].found.model;
    const int order = options.order > 0 ? options.order : std::min(4, static_cast<int>(linear.order()));
    const RankedTake data {given,    input, *output,           level,          recordsOf(take, input, *output, level),
                           response, order, options.order > 0, options.degree, options.iterations,
                           linear};

    Ranking ranking;
    ranking.input = input.quantity;
    ranking.output = output->quantity;
    ranking.noiseDb = data.records.noiseDb;
    double done = 0.02;
    for (const auto& fitting : fittings()) {
        const bool wanted = options.classes.empty()
                            || std::find(options.classes.begin(), options.classes.end(), fitting.told.name)
                                   != options.classes.end();
        if (wanted)
            ranking.models.push_back(
                judge(fitting, data, progress.part(done, std::min(0.95, done + 0.93 * fitting.share))));
        done += 0.93 * fitting.share;
    }
    std::stable_sort(ranking.models.begin(), ranking.models.end(), [](const RankedModel& a, const RankedModel& b) {
        return a.trouble.empty() != b.trouble.empty() ? a.trouble.empty() : a.judgedDb() < b.judgedDb();
    });
    const auto* chosen = explainingMost(ranking.models);
    ranking.best = chosen ? chosen->name : "";
    ranking.sentence = chosen ? "\"" + chosen->name + "\" explains most with " + std::to_string(chosen->parameters)
                                    + " parameters."
                              : "No model of this take is stable.";
    for (auto& model : ranking.models)
        if (model.trouble.empty()) {
            progress.at(0.95, "inverting " + model.name);
            model.predistortion = predistortionOf(model, std::string(name(ranking.output)), take.sampleRate,
                                                  ranking.noiseDb, progress.part(0.95, 0.95));
        }
    tellStraightest(ranking);
    progress.at(1.0, "done");
    return ranking;
}

}  // namespace excursion
