// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/Drift.h"

#include "Engine/Error.h"
#include "Engine/Loudspeaker/OutputError.h"
#include "Engine/Loudspeaker/Propagate.h"
#include "Engine/Loudspeaker/Resonance.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace excursion {
namespace {

constexpr double copper = 0.0039;   // 1/K
constexpr int mostPasses = 6;       // of fit and laws that follow
constexpr double sameShape = 1e-5;  // by which a base parameter may still move in the last of them

/// The search of the free parameters of a model.
using Search = std::function<SearchSummary(Model&)>;

bool drifts(const std::vector<std::string>& names, const std::string& name)
{
    return std::find(names.begin(), names.end(), name) != names.end();
}

void requireNames(const Model& model, const std::vector<std::string>& names)
{
    std::string known;
    for (const auto& p : model.base().parameters)
        known += (known.empty() ? "" : ", ") + p.name;
    if (names.empty())
        throw Error(Error::Kind::usage, "Name a parameter that may have drifted: " + known + ".");
    for (const auto& name : names)
        if (std::none_of(model.base().parameters.begin(), model.base().parameters.end(),
                         [&name](const Parameter& p) { return p.name == name; }))
            throw Error(Error::Kind::usage,
                        "The base of the model has no parameter \"" + name + "\"; it has " + known + ".");
}

/// By which factor each parameter is to be that of the model before: laws go with what they add to.
Eigen::VectorXd factorsOf(const Model& before, const Model& now, const std::vector<std::string>& names)
{
    Eigen::VectorXd factors = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(parametersOf(before).size()));
    Eigen::Index at = 0;
    for (const auto& component : before.components) {
        const auto law = component.effect->law();
        const bool follows = law && drifts(names, law->base);
        const double factor = follows ? now.baseParameter(law->base).value / before.baseParameter(law->base).value
                                      : 1.0;
        for (const auto& p : component.parameters) {
            if (follows && p.unit == before.baseParameter(law->base).unit)
                factors[at] = factor;
            ++at;
        }
    }
    return factors;
}

/// f0 in Hz and Q by Thiele and Small.
Eigen::VectorXd figuresIn(const Model& model)
{
    const auto cone = coneResonance(model);
    return Eigen::Vector2d(cone.frequency, cone.quality);
}

void tell(Drift& drift, const Model& before, const std::vector<std::string>& names)
{
    for (const auto& p : before.base().parameters)
        if (drifts(names, p.name)) {
            const auto& now = drift.model.baseParameter(p.name);
            drift.parameters.push_back({p.name, p.unit, p.value, p.standardError, now.value, now.standardError});
        }
    const auto was = figuresIn(before), is = figuresIn(drift.model), wasError = standardErrorsOf(before, figuresIn),
               isError = standardErrorsOf(drift.model, figuresIn);
    drift.figures = {{"f0", "Hz", was[0], wasError[0], is[0], isError[0]},
                     {"Q", "1", was[1], wasError[1], is[1], isError[1]}};
    for (const auto& p : drift.parameters)
        if (p.name == "Re") {
            drift.warmer = p.share() / copper;
            const double error = std::hypot(p.beforeError, p.afterError) / (copper * p.before);
            if (std::isfinite(error))
                drift.warmerError = error;
        }
}

Drift follow(Model before, const std::vector<std::string>& names, const Search& search)
{
    requireNames(before, names);
    followOthers(before);  // as a fit would: what is held stays as it is
    Drift drift;
    drift.model = before;
    const auto all = parametersOf(drift.model);
    const auto old = parametersOf(before);
    std::vector<Eigen::Index> moved;
    for (std::size_t k = 0; k < all.size(); ++k) {
        all[k]->free = k < before.base().parameters.size() && drifts(names, all[k]->name);
        if (all[k]->free)
            moved.push_back(static_cast<Eigen::Index>(k));
    }
    Eigen::VectorXd factors = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(all.size()));
    for (int pass = 0; pass < mostPasses; ++pass) {
        static_cast<SearchSummary&>(drift.search) = search(drift.model);
        if (!drift.search.usable())
            throw Error(Error::Kind::numerical, "The fit failed: " + drift.search.message + ".");
        const Eigen::VectorXd last = factors;
        factors = factorsOf(before, drift.model, names);
        for (std::size_t k = 0; k < all.size(); ++k)
            if (!all[k]->free)
                all[k]->value = factors[static_cast<Eigen::Index>(k)] * old[k]->value;
        if ((factors - last).cwiseAbs().maxCoeff() < sameShape)
            break;
    }
    // What was held is as well known as it was, what was fitted as it is now.
    if (before.covariance.size() > 0) {
        Eigen::MatrixXd covariance = factors.asDiagonal() * before.covariance * factors.asDiagonal();
        for (const auto k : moved) {
            covariance.row(k).setZero();
            covariance.col(k).setZero();
        }
        covariance(moved, moved) = Eigen::MatrixXd(drift.model.covariance(moved, moved));
        drift.model.covariance = std::move(covariance);
        drift.model.inverseCurvature.resize(0, 0);
    }
    for (std::size_t k = 0; k < all.size(); ++k) {
        if (!all[k]->free)
            all[k]->standardError = factors[static_cast<Eigen::Index>(k)] * old[k]->standardError;
        all[k]->free = old[k]->free || all[k]->free;
    }
    tell(drift, before, names);
    return drift;
}

}  // namespace

double Drifted::certainty() const { return std::abs(after - before) / std::hypot(beforeError, afterError); }

std::vector<std::string> driftingParameters(const Model& model)
{
    std::vector<std::string> names;
    for (const auto& p : model.base().parameters)
        if (p.name == "Re" || p.name == "Rms" || p.name == "K")
            names.push_back(p.name);
    return names;
}

Drift followDrift(const Model& before, const Record& record, const std::vector<std::string>& drifting,
                  const FitOptions& options, const Progress& progress)
{
    FitSummary last;
    auto asGiven = options;
    asGiven.asGiven = true;
    auto drift = follow(before, drifting, [&](Model& model) {
        last = fit(model, record, estimationSections(record), asGiven, progress);
        return last;
    });
    drift.search = last;
    return drift;
}

Drift followDrift(const Model& before, const std::vector<ResponseTarget>& targets,
                  const std::vector<std::string>& drifting)
{
    return follow(before, drifting, [&](Model& model) { return fitResponse(model, targets); });
}

}  // namespace excursion
