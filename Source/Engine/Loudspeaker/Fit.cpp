// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/Fit.h"

#include "Engine/Loudspeaker/FeedbackError.h"
#include "Engine/Loudspeaker/FitCovariance.h"
#include "Engine/Loudspeaker/FitResponse.h"
#include "Engine/Loudspeaker/KeptSlopes.h"
#include "Engine/Loudspeaker/OutputError.h"
#include "Engine/Loudspeaker/SearchCoordinates.h"
#include "Engine/Loudspeaker/SensorStart.h"
#include "Engine/Loudspeaker/Trajectory.h"
#include "Engine/Validity.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <utility>

namespace excursion {
namespace {

/// What the model leaves of the sections to fit, with normal equations of the active parameters when asked for.
using ErrorOf = std::function<std::vector<SectionFit>(const std::vector<Eigen::Index>& active, bool gradient)>;

/// How much the record says of a parameter, in units of what was plausible beforehand.
/// @param N  of it alone
double toldOf(const Parameter& p, double N)
{
    const double even = p.even ? std::max(1.0, 0.5 * p.prior / std::abs(p.value)) : 1.0;  // its square is searched
    return N * std::pow(p.prior * even, 2);
}

/// The free parameters but for shapes of which the record says no more than was plausible beforehand: their wild steps
/// would hold up the others. Of an effect that is not at work yet nothing can be said: its shapes are kept.
struct Searched {
    std::vector<Eigen::Index> active;
    std::vector<SectionFit> fits;      // of the model by these, when they had to be known
    std::vector<Eigen::Index> shapes;  // that are left alone
    Eigen::MatrixXd beside;            // J_active^T J_shapes
    Eigen::VectorXd own;               // of each shape, J_shape^T J_shape
};

Searched telling(const Model& model, const ErrorOf& errorOf)
{
    Searched result;
    auto& active = result.active;
    active = freeParameters(model);
    const auto all = parametersOf(model);
    std::vector<bool> atWork;
    for (const auto& component : model.components)
        atWork.insert(atWork.end(), component.parameters.size(), isAtWork(component));
    atWork.resize(all.size(), true);  // the path
    const auto isShape = [&](Eigen::Index k) {
        const auto& p = *all[static_cast<std::size_t>(k)];
        return !p.strength && std::isfinite(p.prior) && atWork[static_cast<std::size_t>(k)];
    };
    if (std::none_of(active.begin(), active.end(), isShape))
        return result;
    auto& fits = result.fits;
    fits = errorOf(active, true);
    const auto sum = sumOf(fits);
    if (!sum || sum->N.size() == 0)
        return result;
    constexpr double fewTimes = 4.0;  // what the record must say, in units of what was known
    const double variance = std::max(1.0, sum->cost / std::max(1.0, sum->rows));
    std::vector<Eigen::Index> kept, left;  // places
    for (std::size_t j = 0; j < active.size(); ++j) {
        const auto k = static_cast<Eigen::Index>(j);
        const bool tells = !isShape(active[j])
                           || toldOf(*all[static_cast<std::size_t>(active[j])], sum->N(k, k)) > fewTimes * variance;
        (tells ? kept : left).push_back(k);
    }
    if (left.empty())
        return result;
    for (auto& fit : fits)
        fit.keepSlopes(kept);
    const auto every = std::move(active);
    const auto at = [&](const std::vector<Eigen::Index>& places) {
        std::vector<Eigen::Index> parameters;
        for (const auto place : places)
            parameters.push_back(every[static_cast<std::size_t>(place)]);
        return parameters;
    };
    result.beside = sum->N(kept, left);
    result.own = sum->N.diagonal()(left);
    result.shapes = at(left);
    active = at(kept);
    return result;
}

SearchCoordinates coordinatesOf(Model& model, const std::vector<Eigen::Index>& active)
{
    const auto all = parametersOf(model);
    std::vector<Parameter*> own;
    for (const auto k : active)
        own.push_back(all[static_cast<std::size_t>(k)]);
    return SearchCoordinates(std::move(own));
}

/// Puts the model where a search looks.
void place(Model& model, SearchCoordinates& coordinates, const Eigen::VectorXd& at)
{
    coordinates.place(at);
    tellHosts(model);
}

/// What damps the steps of shapes besides: where the record tells them no better than their prior, and many of them
/// alike, slopes hold for less than a step to the least cost. What it tells well moves as freely as without.
Eigen::VectorXd heldOf(const Model& model, const std::vector<Eigen::Index>& active, double variance)
{
    constexpr double times = 10.0;  // the prior's curvature
    const auto all = parametersOf(model);
    Eigen::VectorXd held = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(active.size()));
    for (Eigen::Index k = 0; k < held.size(); ++k) {
        const auto& p = *all[static_cast<std::size_t>(active[static_cast<std::size_t>(k)])];
        if (!p.strength && !p.even && std::isfinite(p.prior))
            held[k] = times * variance / (p.prior * p.prior);
    }
    return held;
}

/// Where a step of a search leads: each effect that moves as a whole follows its own slopes (Effect::follow()).
/// @param model  stands there afterwards
Eigen::VectorXd retracted(Model& model, const std::vector<Eigen::Index>& active, SearchCoordinates& coordinates,
                          const Eigen::VectorXd& from, const Eigen::VectorXd& step)
{
    const auto valuesOf = [](const Component& component) {
        std::vector<double> values;
        for (const auto& p : component.parameters)
            values.push_back(p.value);
        return values;
    };
    coordinates.place(from);
    std::vector<std::vector<double>> before;
    for (const auto& component : model.components)
        before.push_back(valuesOf(component));
    coordinates.place(from + step);
    for (std::size_t k = 0; k < model.components.size(); ++k) {
        auto& component = model.components[k];
        const auto first = firstParameterOf(model, k), last = firstParameterOf(model, k + 1);
        const auto moved = std::count_if(active.begin(), active.end(),
                                         [&](Eigen::Index n) { return n >= first && n < last; });
        auto values = valuesOf(component);
        if (moved == last - first && values != before[k]) {
            component.effect->follow(component.operatingRange, before[k].data(), values.data());
            for (std::size_t j = 0; j < values.size(); ++j)
                component.parameters[j].value = values[j];
        }
    }
    tellHosts(model);
    return coordinates.now();
}

/// The search of the model's parameters for the least error.
/// @param corrected  steps are corrected by the slopes of their begin; errorOf tells slopes and spectra then
FitSummary search(Model& model, const Record& record, const std::vector<std::size_t>& sections, const ErrorOf& errorOf,
                  const FitOptions& options, const Progress& progress, bool corrected = false)
{
    FitSummary summary;
    for (auto* parameter : parametersOf(model))
        if (parameter->free) {
            parameter->value = std::clamp(parameter->value, parameter->lower, parameter->upper);
            leaveZero(*parameter);
        }
    tellHosts(model);
    auto searched = telling(model, errorOf);
    const auto& active = searched.active;
    auto& atStart = searched.fits;
    const auto all = parametersOf(model);
    const auto P = static_cast<Eigen::Index>(active.size());
    auto coordinates = coordinatesOf(model, active);
    Eigen::VectorXd theta = coordinates.now(), slopesOfKept;
    std::vector<SectionFit> tried;  // where slopes were not asked for, last
    KeptSlopes slopes(record, sections);
    struct {
        NormalEquations sum;     // by parameters
        Eigen::MatrixXd ofData;  // N without priors
        Eigen::MatrixXd pulls;   // of bands
        Eigen::MatrixXd shared;
        bool onlyNoise = false;
    } last;                                                   // place with slopes
    double variance = 0.0;                                    // of the residuals at the start
    double lowest = std::numeric_limits<double>::infinity();  // cost
    const auto evaluate = [&](const Eigen::VectorXd& at, bool gradient, NormalEquations& sum) {
        place(model, coordinates, at);
        // asked for there first
        auto fits = atStart.empty() ? errorOf(active, gradient) : std::exchange(atStart, {});
        auto total = sumOf(fits);
        if (!total)
            return false;
        sum = std::move(*total);
        const bool onlyNoise = record.noiseKnown && worstPower(fits) <= ErrorPower::most;
        sum.sure = record.noiseKnown && !onlyNoise ? sureNoise * sum.rows : 0.0;
        if (variance == 0.0)
            variance = std::max(1.0, sum.cost / std::max(1.0, sum.rows));
        const Eigen::MatrixXd ofData = sum.N;
        addPrior(model, active, sum, variance);
        if (gradient && sum.N.allFinite() && sum.g.allFinite()) {
            last = {sum, ofData, pullsOf(fits, record, sections), sharedOf(fits), onlyNoise};
        }
        coordinates.convert(sum, variance);
        sum.held = heldOf(model, active, variance);
        if (corrected && gradient) {
            slopes.keep(std::move(fits));
            slopesOfKept = coordinates.slopes();
        } else if (corrected)
            tried = std::move(fits);
        if (sum.cost < lowest) {  // the search takes every such step
            lowest = sum.cost;
            summary.onlyNoise = onlyNoise;
        }
        return true;
    };
    const auto chord = [&] {
        Eigen::VectorXd pull = slopes.gradientAt(tried);
        if (pull.size() == 0)
            return pull;
        NormalEquations prior;
        prior.g = Eigen::VectorXd::Zero(P);
        prior.N = Eigen::MatrixXd::Zero(P, P);
        addPrior(model, active, prior, variance);  // the model stands where it was tried
        coordinates.convert(prior, variance);
        return Eigen::VectorXd(pull.cwiseProduct(slopesOfKept) + prior.g);
    };
    const auto retraction = [&](const Eigen::VectorXd& from, const Eigen::VectorXd& step) {
        return retracted(model, active, coordinates, from, step);
    };
    static_cast<SearchSummary&>(summary) = minimize(evaluate, theta, coordinates.lower(), coordinates.upper(),
                                                    options.search, progress,
                                                    corrected ? ChordGradient(chord) : ChordGradient(), retraction);
    place(model, coordinates, theta);
    if (!summary.usable())
        return summary;
    if (summary.termination == Termination::noSlopes)
        summary.onlyNoise = last.onlyNoise;
    summary.chiSquaredPerValue = summary.finalCost / std::max(1.0, last.sum.rows - static_cast<double>(P));
    const double scatter = std::max(1.0, summary.chiSquaredPerValue);
    const FitCurvature curvature {active, last.sum.N, last.ofData, last.shared, last.pulls, scatter};
    keepCovariance(model, curvature, {searched.shapes, searched.beside, searched.own});
    for (auto* p : all)
        if (p->free)
            p->standardError = std::numeric_limits<double>::quiet_NaN();
    for (const auto k : active)
        all[static_cast<std::size_t>(k)]->standardError = std::sqrt(model.covariance(k, k));
    return summary;
}

/// Frees what a record can tell, and holds what it cannot.
void holdUntold(Model& model, const Record& record)
{
    freeSensors(model, record);
    // Without a current only laws tell the coil's damping from the suspension's.
    const auto& seen = record.channels;
    const bool current = std::find(seen.begin(), seen.end(), Quantity::current) != seen.end();
    if (model.electrical() && !current)
        model.baseParameter("Rms").free = hasLaws(model);
}

constexpr std::size_t roomForSlopes = 1 << 26;  // numbers, of 4 bytes

std::size_t residualsOf(const Record& record, const std::vector<std::size_t>& sections)
{
    std::size_t count = 0;
    for (const auto s : sections) {
        const auto [first, last] = record.lineRange(record.sections[s]);
        count += 2 * (last - first + 1) * record.channels.size();
    }
    return count;
}

/// Sections as a model played them at its last two places: a search asks for the slopes of the step that it has just
/// tried, or of the one before it where a correction of that was refused.
class PlayedSections {
public:
    const std::vector<SectionFit>& of(const Model& model, const Record& record,
                                      const std::vector<std::size_t>& sections, OutputErrorOptions options,
                                      const Progress& progress)
    {
        const auto now = parameterVector(model);
        if (before_.isAt(now))
            std::swap(last_, before_);
        if (!last_.isAt(now)) {
            options.gradient = false;
            options.spectra = true;
            before_ = std::exchange(last_, {now, outputError(model, record, sections, {}, options, progress)});
        }
        return last_.fits;
    }

private:
    struct Place {
        Eigen::VectorXd theta;
        std::vector<SectionFit> fits;

        bool isAt(const Eigen::VectorXd& where) const { return !fits.empty() && theta == where; }
    };
    Place last_, before_;
};

}  // namespace

bool FitOptions::isValid(std::string* reason) const
{
    if (!search.isValid(reason))
        return false;
    if (!(simulationTolerance >= 0.0 && simulationTolerance < 1.0))
        return refuse(reason, "the tolerance of the simulation must lie between 0 (chosen from the noise) and 1");
    if (substeps < 0 || gradientSubsteps < 0 || threads < 1)
        return refuse(reason, "steps a sample and threads are positive");
    return true;
}

bool canCorrect(const Model& model, const Record& record, const std::vector<std::size_t>& sections)
{
    return hasPeriods(record) && residualsOf(record, sections) * parametersOf(model).size() < roomForSlopes;
}

FitSummary fit(Model& model, const Record& record, const std::vector<std::size_t>& sections, const FitOptions& options,
               const Progress& progress)
{
    std::string reason;
    if (!options.isValid(&reason))
        throw Error(Error::Kind::usage, "The fit cannot run: " + reason + ".");
    followOthers(model);
    if (!options.asGiven)
        holdUntold(model, record);
    OutputErrorOptions run;
    run.threads = options.threads;
    run.shared = !options.fed;
    run.sectionsDrift = options.sectionsDrift;
    if (options.fed && hasPeriods(record)) {
        FitSummary summary;
        auto motions = settledMotions(model, record, sections, options.threads);
        std::vector<KnownSlopes> known(sections.size());
        const ErrorOf errorOf = [&](const std::vector<Eigen::Index>& active, bool gradient) {
            run.gradient = gradient;
            return feedbackError(model, record, sections, motions, active, run, progress, nullptr, &known);
        };
        // What the take does not show is expected better from the model that has been found.
        constexpr int mostRounds = 4;
        const int rounds = std::min(mostRounds, options.search.maximumIterations);  // each takes a step
        constexpr double settled = 0.95, moved = 0.99;
        double before = std::numeric_limits<double>::infinity();
        for (int n = 0; n < rounds; ++n) {
            if (n > 0) {
                auto next = shownMotions(model, record, sections, motions, options.threads);
                if (!isNear(next, motions))
                    known.assign(sections.size(), {});
                motions = std::move(next);
            }
            const auto round = search(model, record, sections, errorOf, options, progress);
            if (n > 0 && !round.usable())
                break;
            summary = round;
            // a model that has hardly moved expects what it did before
            if (!(summary.usable() && summary.finalCost < settled * before
                  && summary.finalCost < moved * summary.initialCost))
                break;
            before = summary.finalCost;
        }
        return summary;
    }
    run.substeps = options.substeps > 0 ? options.substeps : substepsFor(model, record, options.simulationTolerance);
    run.gradientSubsteps = options.gradientSubsteps;
    const bool slopesFed = options.fedGradient && hasPeriods(record);
    const auto motions = slopesFed ? settledMotions(model, record, sections, options.threads) : ShownMotions {};
    std::vector<KnownSlopes> known(sections.size());
    PlayedSections played;
    run.slopes = options.corrected && canCorrect(model, record, sections);
    run.spectra = run.slopes;
    auto summary = search(
        model, record, sections,
        [&](const std::vector<Eigen::Index>& active, bool gradient) {
            run.gradient = gradient;
            if (!slopesFed)
                return outputError(model, record, sections, active, run, progress);
            const auto& simulated = played.of(model, record, sections, run, progress);
            return gradient ? feedbackError(model, record, sections, motions, active, run, progress, &simulated, &known)
                            : simulated;
        },
        options, progress, run.slopes);
    summary.substeps = run.substeps;
    return summary;
}

Model startModel(const Record& record)
{
    return startModel(linearResponsesOf(record), record.electrical, record.driver);
}

}  // namespace excursion
