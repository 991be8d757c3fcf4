// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/FittedPnlss.h"

#include "Engine/BlackBox/Stimulus.h"
#include "Engine/Document/Engineering.h"
#include "Engine/Error.h"
#include "Engine/Linear/Bilinear.h"
#include "Engine/Polynomial/FractionalPnlss/FractionalPnlssFile.h"
#include "Engine/Polynomial/FractionalPnlss/FractionalPnlssFit.h"
#include "Engine/Polynomial/Pnlss/LinearStarts.h"
#include "Engine/Polynomial/Pnlss/PnlssFile.h"
#include "Engine/Polynomial/TakeRecords.h"

#include <cmath>

namespace excursion::plugin {
namespace {

struct Work {
    const Measurement& take;
    const Identified& linear;
    const PnlssWish& wish;
    InputOutputRecords records;
    bool periodic = false;
    std::vector<std::string> inputs, outputs;
};

void keepErrors(FittedPnlss& told, double estimationDb, double validationDb, const InputOutputRecords& records)
{
    told.estimationDb = estimationDb;
    if (!records.validation.empty())
        told.validationDb = validationDb;
    told.noiseDb = records.noiseDb;
}

std::string fitWhole(FittedPnlss& told, Work& work, const Progress& progress)
{
    const double rate = work.take.sampleRate;
    const auto discrete = work.linear.model.continuous() ? toDiscrete(work.linear.model, rate) : work.linear.model;
    const auto start = withTerms(discrete, work.wish.degree);
    std::vector<PnlssStart> starts {{start, {}}};
    if (!work.periodic) {
        work.records.estimation.front().skip = 0;  // its first state is estimated
        starts.front().initialStates = {initialStateOf(start, work.records.estimation.front())};
    }
    PnlssFitOptions options;
    options.maximumIterations = work.wish.iterations;
    options.enoughDb = work.records.enoughDb();
    options.estimateInitialStates = options.judgeResidual = !work.periodic;
    const auto &estimation = work.records.estimation, &validation = work.records.validation;
    told.startDb = relativeErrorDb(start, validation.empty() ? estimation : validation, starts.front().initialStates);
    const auto fit = fitPnlss(starts, estimation, validation, options, progress);
    keepErrors(told, fit.estimationDb, fit.validationDb, work.records);
    told.history = fit.history;
    told.stable = fit.stable;
    told.terms = static_cast<int>(fit.model.terms());
    told.document = toJson(NamedPnlss {work.linear.name, work.inputs, work.outputs, fit.model});
    return fit.message;
}

std::string fitFractional(FittedPnlss& told, Work& work, const Progress& progress)
{
    if (!(work.linear.alpha < 1.0))
        throw Error(Error::Kind::data, "A polynomial model has states of an order \u03b1 below 1; identify one with "
                                       "that, or one of whole order.");
    const auto start = withTerms(FractionalStateSpace {work.linear.alpha, work.linear.model}, work.wish.degree,
                                 TermMask::full, false);
    const auto &estimation = work.records.estimation, &validation = work.records.validation;
    const double seconds = static_cast<double>(estimation.front().input.rows()) / work.take.sampleRate;
    const auto grid = gridFor(start, work.take.sampleRate, work.linear.data.frequency, seconds);
    FractionalPnlssOptions options;
    options.maximumIterations = work.wish.iterations;
    options.alphaFree = work.linear.asked.time == ModelTime::fractionalFree;
    told.startDb = relativeErrorDb(start, grid, validation.empty() ? estimation : validation);
    const auto fit = fitFractionalPnlss(start, grid, estimation, validation, options, progress);
    keepErrors(told, fit.estimationDb, fit.validationDb, work.records);
    told.history = fit.history;
    told.stable = fit.stable;
    told.terms = static_cast<int>(fit.model.form.terms());
    told.document = toJson(NamedFractionalPnlss {work.linear.name, work.inputs, work.outputs, fit.model, grid});
    return fit.message;
}

}  // namespace

FittedPnlss pnlssOf(const PreparedTake& take, const Identified& linear, const PnlssWish& wish, const Progress& progress)
{
    if (linear.delay != 0.0)
        throw Error(Error::Kind::data, "The linear model has a delay, which the states of a polynomial model do not "
                                       "hold; stabilize it in another way.");
    const auto& measurement = take.settled();
    const auto *input = measurement.find(linear.response.input), *output = measurement.find(linear.response.output);
    if (input == nullptr || output == nullptr)
        throw Error(Error::Kind::data, "The take has not the channels of the linear model; identify one of it.");
    progress.at(0.0, "fitting a PNLSS");
    Work work {measurement,
               linear,
               wish,
               recordsOf(measurement, *input, *output, linear.asked.ports.level),
               measurement.hasPeriods(),
               {std::string(name(input->quantity))},
               {std::string(name(output->quantity))}};
    FittedPnlss told;
    const bool whole = linear.asked.time == ModelTime::continuous || linear.asked.time == ModelTime::discrete;
    const auto stopped = whole ? fitWhole(told, work, progress) : fitFractional(told, work, progress);
    if (!std::isfinite(told.estimationDb))
        throw Error(Error::Kind::numerical,
                    "The model runs away on the records that it was to explain; try another order or degree.");
    told.document["stimulus"] = toJson(stimulusOf(work.records.estimation, measurement.sampleRate));
    told.words = "PNLSS of " + std::to_string(told.terms) + " terms: error " + decibels(told.estimationDb)
                 + (told.validationDb ? ", on records not seen " + decibels(*told.validationDb) : std::string())
                 + (told.noiseDb ? ", noise " + decibels(*told.noiseDb) : std::string()) + "; the linear model alone "
                 + decibels(told.startDb) + (told.stable ? "." : ". Its linear part is not stable.")
                 + " It stopped: " + stopped + ".";
    return told;
}

std::string shortWordsOf(const FittedPnlss& told)
{
    return "PNLSS: error " + decibels(told.validationDb.value_or(told.estimationDb))
           + (told.noiseDb ? ", noise " + decibels(*told.noiseDb) : std::string()) + ", linear "
           + decibels(told.startDb) + (told.stable ? "." : "; not stable.");
}

}  // namespace excursion::plugin
