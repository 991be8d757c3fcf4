// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/RaiseDegrees.h"

#include "Engine/Loudspeaker/Curve.h"
#include "Engine/Numerics/LeastSquares.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <limits>

namespace excursion {

namespace {

/// While much is missing a law of a higher degree takes the place of what is missing, and holds it with coefficients
/// that every later fit has to carry.
constexpr int highestFarOff = 18;

}  // namespace

std::vector<std::string> raiseDegrees(Model& model, const Record& record, const ScoreOptions& options, double share,
                                      int by, const Progress& progress)
{
    std::vector<std::string> raised;
    // All laws with room are raised at once; then each is judged on its own columns.
    Model higher = model;
    std::vector<std::size_t> candidates;
    for (std::size_t k = 1; k < model.components.size(); ++k)
        if (const int degree = model.components[k].operatingRange.degree + by;
            model.components[k].effect->law() && degree <= curve::maximumDegree) {
            higher = withDegree(std::move(higher), k, degree);
            candidates.push_back(k);
        }
    if (candidates.empty())
        return raised;
    const auto active = freeParameters(higher);
    const auto sums = sumsOf(higher, record, estimationSections(record), active, options, progress);
    if (!sums.finite)
        return raised;
    std::vector<Eigen::Index> old;
    std::vector<std::vector<Eigen::Index>> added(higher.components.size());
    Eigen::Index position = 0;
    const auto visit = [&](const Parameter& p, bool isNew, std::size_t k) {
        if (p.free)
            (isNew ? added[k] : old).push_back(position++);
    };
    for (std::size_t k = 0; k < higher.components.size(); ++k)
        for (const auto& p : higher.components[k].parameters) {
            const auto& before = model.components[k].parameters;
            const bool isNew = std::none_of(before.begin(), before.end(),
                                            [&](const Parameter& b) { return b.name == p.name; });
            visit(p, isNew, k);
        }
    for (const auto& p : higher.path.parameters)
        visit(p, false, 0);
    const double now = predictedCost(sums.estimation, gaussNewtonStep(sums.estimation, old));
    const double unit = std::max(1.0, now / std::max(1.0, sums.estimation.rows));
    const double price = priceOfCoefficient * unit;
    // Far above the noise, or where it is not known, what is left may be no noise at all: then it must also fall by a
    // share that is worth it.
    const double least = record.noiseKnown && unit < nearNoise ? share * now : 0.02 * now;
    // What slopes promise of the old parameters has not come true yet.
    const bool isNear = record.noiseKnown && sums.estimation.cost < nearNoise * std::max(1.0, sums.estimation.rows);
    Model result = model;
    for (const auto k : candidates) {
        const int degree = model.components[k].operatingRange.degree + by;
        if (degree > highestFarOff && !isNear)
            continue;
        auto use = old;
        use.insert(use.end(), added[k].begin(), added[k].end());
        std::sort(use.begin(), use.end());
        const double then = predictedCost(sums.estimation, gaussNewtonStep(sums.estimation, use));
        if (now - then > std::max(least, price * static_cast<double>(added[k].size()))) {
            result = withDegree(std::move(result), k, degree);
            raised.push_back(model.components[k].effect->id());
        }
    }
    model = std::move(result);
    return raised;
}

std::vector<Eigen::Index> highestCoefficients(const Model& model, std::size_t k, int by)
{
    const auto first = firstParameterOf(model, k);
    const auto& component = model.components[k];
    const auto lower = withDegree(model, k, component.operatingRange.degree - by).components[k].parameters;
    std::vector<Eigen::Index> highest;
    for (std::size_t j = 0; j < component.parameters.size(); ++j)
        if (std::none_of(lower.begin(), lower.end(),
                         [&](const Parameter& p) { return p.name == component.parameters[j].name; }))
            highest.push_back(first + static_cast<Eigen::Index>(j));
    return highest;
}

double worthOfHighest(const Model& model, std::size_t k, int by)
{
    auto highest = highestCoefficients(model, k, by);
    const auto& bends = inverseCurvature(model);
    std::erase_if(highest, [&](Eigen::Index j) { return bends(j, j) == 0.0; });  // not told by the fit
    if (highest.empty())
        return std::numeric_limits<double>::infinity();
    const Eigen::VectorXd theta = parameterVector(model)(highest);
    const Eigen::MatrixXd C = bends(highest, highest);
    return theta.dot(C.ldlt().solve(theta));
}

std::vector<std::size_t> tooHigh(const Model& model, int by)
{
    std::vector<std::size_t> result;
    if (model.covariance.size() == 0)
        return result;
    for (std::size_t k = 1; k < model.components.size(); ++k) {
        const auto& component = model.components[k];
        if (!component.effect->law() || component.operatingRange.degree - by < OperatingRange {}.degree)
            continue;
        const auto coefficients = static_cast<double>(highestCoefficients(model, k, by).size());
        if (worthOfHighest(model, k, by) <= priceOfCoefficient * coefficients)
            result.push_back(k);
    }
    return result;
}

}  // namespace excursion
