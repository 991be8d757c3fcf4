// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/Pnlss/PnlssFit.h"

#include "Engine/Error.h"
#include "Engine/Polynomial/Pnlss/Recursion.h"
#include "Engine/Polynomial/Pnlss/ResidualTest.h"
#include "Engine/Polynomial/Pnlss/SimulationError.h"
#include "Engine/Signal/Level.h"
#include "Engine/Validity.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace excursion {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double infinity = std::numeric_limits<double>::infinity();

/// A way through the parameters: where it has come to, and the best model on it.
struct Way {
    VectorXd values;
    double damping = 1.0, judgedDb = infinity;
    int iterations = 0;    // by simulation of the whole records
    bool atNoise = false;  // as far as the residual tells; where it is judged
    PnlssFit fit;

    bool isBetterThan(const Way& other) const
    {
        if (other.values.size() == 0 || atNoise != other.atNoise)
            return other.values.size() == 0 || atNoise;
        return judgedDb < other.judgedDb;
    }
};

/// The ways of one fit.
class Fitting {
public:
    Fitting(const std::vector<PnlssStart>& starts, const std::vector<InputOutputRecord>& estimation,
            const std::vector<InputOutputRecord>& validation, const PnlssFitOptions& options, const Progress& progress)
        : start_(starts.front().model),
          estimation_(estimation),
          validation_(validation),
          options_(options),
          problem_(estimation, options, start_)
    {
        const double all = options.maximumIterations,
                     guided = static_cast<double>(guidedIterations() * static_cast<int>(options.guideGains.size()));
        const double most = options.search == PnlssSearch::plain    ? all
                            : options.search == PnlssSearch::guided ? all + guided
                            : options.search == PnlssSearch::grown
                                ? 2.0 * all
                                : all + static_cast<double>(starts.size()) * (1.5 * all + guided);
        searching_.costTolerance = options.costTolerance;
        if (options.judgeResidual)
            searching_.costTolerance = std::max(options.costTolerance, 0.1 / samplesJudged());
        searching_.rankTolerance = options.rankTolerance;
        searching_.begun = [this, most, &progress] {
            progress.at(std::min(iterations_++ / most, 1.0), "fitting the polynomial model");
        };
    }

    bool isFree() const { return problem_.parameters() > 0; }

    /// As far as the first simulation of the whole records.
    Way led(const PnlssStart& start, PnlssSearch search, int iterations)
    {
        Way way;
        way.values = problem_.valuesOf(start.model, start.initialStates);
        way.fit.model = start.model;
        way.fit.end(Termination::startUndefined);
        way.fit.estimationDb = way.fit.validationDb = infinity;
        searching_.accepted = {};
        if (search == PnlssSearch::guided)
            guide(way);
        else if (search == PnlssSearch::grown)
            grow(way, iterations);
        way.damping = 1.0;
        return way;
    }

    /// Whether it sets out from another place than the plain way.
    bool leadsElsewhere(const Way& way, const PnlssStart& start) const
    {
        return way.values != problem_.valuesOf(start.model, start.initialStates);
    }

    /// Whether there is nothing left to be found by another way: the error is at the noise, and not much larger on the
    /// validation records. The model with the least error on these may stand early on the way, as they go where the
    /// others do not: a sweep's end, the loudest bars. Where it is not at the noise and the end of the way is, the end
    /// is taken, unless on the validation records it is worse than no model.
    bool isEnough(Way& way) const
    {
        if (way.judgedDb <= options_.enoughDb)
            return true;
        if (!options_.judgeResidual || !std::isfinite(way.fit.estimationDb))
            return false;
        way.atNoise = isAtNoise(way.fit);
        if (!way.atNoise) {
            PnlssFit end = way.fit;
            keep(end, way.values);
            if (end.estimationDb >= way.fit.estimationDb || end.validationDb > 0.0 || !isAtNoise(end))
                return false;
            way.atNoise = true;
            way.judgedDb = validation_.empty() ? end.estimationDb : end.validationDb;
            way.fit = std::move(end);
        }
        return validation_.empty() || holds(way.fit);
    }

    /// On by simulation, until the way has this many iterations.
    Way simulated(Way way, int iterations)
    {
        problem_.guide(0.0, way.values);
        if (problem_.holdBack(way.values)) {
            if (!way.fit.history.empty())
                way.fit.history.pop_back();  // the search tells of its start
            searching_.accepted = [&](const VectorXd& values, double cost) { judge(way, values, cost); };
            const auto summary = go(problem_, way, iterations - way.iterations);
            const double first = way.iterations > 0 ? way.fit.initialCost : summary.initialCost;
            static_cast<SearchSummary&>(way.fit) = summary;
            way.fit.initialCost = first;
            way.iterations += summary.iterations;
            way.fit.stable = isStable(way.fit.model.linear) && std::isfinite(way.fit.estimationDb);
        }
        way.fit.iterations = iterations_;
        return way;
    }

private:
    double samplesJudged() const
    {
        double count = 0.0;
        for (const auto& record : estimation_)
            count += static_cast<double>((record.output.rows() - record.skip) * record.output.cols());
        return count;
    }

    int guidedIterations() const { return std::max(3, options_.maximumIterations / 28); }

    /// Through all gains, a few iterations each: a stage only has to lead to the next.
    void guide(Way& way)
    {
        for (const double gain : options_.guideGains) {
            problem_.guide(gain, way.values);
            way.damping = 1.0;
            if (problem_.holdBack(way.values))
                go(problem_, way, guidedIterations());
        }
    }

    void grow(Way& way, int iterations)
    {
        std::vector<InputOutputRecord> parts;
        for (const auto& record : estimation_) {
            const auto rows = record.skip + (record.input.rows() - record.skip + 3) / 4;
            parts.push_back({record.input.topRows(rows), record.output.topRows(rows), record.skip, false});
        }
        auto evenly = options_;
        evenly.lineWeights.resize(0);
        SimulationError part(parts, evenly, start_);
        if (part.holdBack(way.values))
            go(part, way, iterations);
    }

    SearchResult go(SimulationError& problem, Way& way, int iterations)
    {
        searching_.damping.last = way.damping;
        searching_.maximumIterations = iterations;
        auto summary = search(problem, way.values, searching_);
        way.values = summary.values;
        way.damping = summary.damping;
        return summary;
    }

    void judge(Way& way, const VectorXd& values, double cost)
    {
        auto& fit = way.fit;
        fit.history.push_back(decibelsOf(cost));
        auto here = fit;
        keep(here, values);
        const double judgedDb = validation_.empty() ? decibelsOf(cost) : here.validationDb;
        if (judgedDb < way.judgedDb) {
            way.judgedDb = judgedDb;
            fit = std::move(here);
        }
    }

    /// The model at these values, and its errors.
    void keep(PnlssFit& fit, const VectorXd& values) const
    {
        fit.model = problem_.modelAt(values);
        fit.initialStates = problem_.initialStates(values);
        fit.estimationDb = relativeErrorDb(fit.model, estimation_, fit.initialStates);
        fit.validationDb = validation_.empty()
                               ? std::numeric_limits<double>::quiet_NaN()
                               : relativeErrorDb(fit.model, validation_, validationStates(fit.initialStates));
        fit.untold.reset();
    }

    bool isAtNoise(PnlssFit& fit) const
    {
        if (!fit.untold)
            fit.untold = untoldNoise(fit.model, estimation_, fit.initialStates);
        // As many coefficients as samples leave nothing of any record, and that is no noise.
        if (fit.estimationDb <= exactDb)
            return validation_.empty() ? 2.0 * static_cast<double>(problem_.parameters()) < samplesJudged()
                                       : holds(fit);
        return fit.untold && fit.untold->reachedBy(fit.estimationDb).value_or(false);
    }

    /// What was not fitted is explained as well.
    bool holds(const PnlssFit& fit) const
    {
        return isHeld(fit.estimationDb, estimation_, fit.validationDb, validation_);
    }

    std::vector<VectorXd> validationStates(const std::vector<VectorXd>& estimated) const
    {
        std::vector<VectorXd> states;
        for (const auto& record : validation_)
            states.push_back(record.startsAs >= 0 && !estimated.empty()
                                 ? estimated[static_cast<std::size_t>(record.startsAs)]
                                 : VectorXd::Zero(start_.linear.order()));
        return states;
    }

    const Pnlss& start_;
    const std::vector<InputOutputRecord>&estimation_, &validation_;
    const PnlssFitOptions& options_;
    SimulationError problem_;
    SearchOptions searching_;
    int iterations_ = 0;
};

void requireStart(const PnlssStart& start, const Pnlss& structure, const std::vector<InputOutputRecord>& estimation)
{
    std::string reason;
    const auto n = structure.linear.order();
    if (!start.model.isValid(&reason))
        throw Error(Error::Kind::usage, "The model cannot be fitted: " + reason + ".");
    if (start.model.linear.order() != n || start.model.linear.inputs() != structure.linear.inputs()
        || start.model.linear.outputs() != structure.linear.outputs() || start.model.terms() != structure.terms()
        || start.model.exponents != structure.exponents || (start.model.free != structure.free).any())
        throw Error(Error::Kind::usage, "The starts of a fit must be models of one structure.");
    if (!start.initialStates.empty() && start.initialStates.size() != estimation.size())
        throw Error(Error::Kind::usage, "A start needs one initial state a record, or none.");
    for (const auto& state : start.initialStates)
        if (state.size() != n || !state.allFinite())
            throw Error(Error::Kind::usage, "An initial state of a start does not fit the model.");
}

}  // namespace

double relativeErrorDb(const Pnlss& model, const std::vector<InputOutputRecord>& records,
                       const std::vector<VectorXd>& initialStates)
{
    const Recursion recursion(model, false);
    MatrixXd states;
    std::vector<MatrixXd> outputs(records.size());
    for (std::size_t k = 0; k < records.size(); ++k) {
        const VectorXd initial = k < initialStates.size() ? initialStates[k] : VectorXd::Zero(model.linear.order());
        if (!recursion.run(model, records[k].input, initial, 1e100, states, outputs[k]))
            return infinity;
    }
    return outputErrorDb(outputs, records);
}

PnlssFit fitPnlss(const Pnlss& start, const std::vector<InputOutputRecord>& estimation,
                  const std::vector<InputOutputRecord>& validation, const PnlssFitOptions& options,
                  const Progress& progress)
{
    return fitPnlss(std::vector<PnlssStart> {{start, {}}}, estimation, validation, options, progress);
}

PnlssFit fitPnlss(const std::vector<PnlssStart>& starts, const std::vector<InputOutputRecord>& estimation,
                  const std::vector<InputOutputRecord>& validation, const PnlssFitOptions& options,
                  const Progress& progress)
{
    std::string reason = "there is no start";
    if (starts.empty() || !options.isValid(&reason))
        throw Error(Error::Kind::usage, "The model cannot be fitted: " + reason + ".");
    for (const auto& start : starts)
        requireStart(start, starts.front().model, estimation);
    const auto& structure = starts.front().model;
    requireFitting(estimation, validation, structure.linear.inputs(), structure.linear.outputs());
    for (const auto& record : estimation)
        if (options.lineWeights.size() != 0
            && (!record.periodic || (record.input.rows() - record.skip) / 2 + 1 != options.lineWeights.size()))
            throw Error(Error::Kind::data,
                        "Weights of the spectrum need periodic records, and as many numbers as a record has lines.");
    for (const auto& record : validation)
        if (record.startsAs >= static_cast<int>(estimation.size()))
            throw Error(Error::Kind::usage, "A validation record begins as an estimation record that does not exist.");
    Fitting fitting(starts, estimation, validation, options, progress);
    if (!fitting.isFree())
        throw Error(Error::Kind::usage, "The model cannot be fitted: nothing of it is free.");
    const int all = options.maximumIterations, half = (all + 1) / 2;
    const bool any = options.search == PnlssSearch::any;
    Way best;
    bool enough = false;
    const auto go = [&](const PnlssStart& start, PnlssSearch search) {
        auto way = fitting.led(start, search, any ? half : all);
        if ((any && search != PnlssSearch::plain && !fitting.leadsElsewhere(way, start)))
            return;
        way = fitting.simulated(std::move(way), any ? half : all);
        enough = fitting.isEnough(way);
        if (way.isBetterThan(best))
            best = std::move(way);
    };
    for (const auto& start : starts)
        for (const auto search :
             any ? std::vector {PnlssSearch::plain, PnlssSearch::guided} : std::vector {options.search})
            if (!enough)
                go(start, search);
    if (any)
        for (const auto& start : starts)
            if (!enough)
                go(start, PnlssSearch::grown);
    if (any && !best.fit.converged() && best.iterations < all)
        best = fitting.simulated(std::move(best), all);
    fitting.isEnough(best);  // tells what is left of the one that is returned
    return best.fit;
}

}  // namespace excursion
