// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/LawDegrees.h"

#include "Engine/Diagnosis/QuickFit.h"
#include "Engine/Diagnosis/RaiseDegrees.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <limits>

namespace excursion {
namespace {

/// What laws of a higher degree leave less, in units of the cost, and what their coefficients must bring.
struct Gain {
    double cost = 0.0;
    double price = 0.0;
    double coefficients = 0.0;
    double unit = 1.0;  ///< of the cost: the residuals' variance

    bool pays() const { return cost > price; }
};

/// None where the higher one runs away; where only the lower one does it gains without end.
std::optional<Gain> gainOf(const Model& higher, const Model& lower, const Record& record,
                           const std::vector<std::size_t>& sections, const FitOptions& options)
{
    const auto now = quickSum(lower, record, sections, options), then = quickSum(higher, record, sections, options);
    if (!then)
        return std::nullopt;
    const double unit = std::max(1.0, then->cost / std::max(1.0, then->rows)),
                 more = static_cast<double>(freeParameters(higher).size())
                        - static_cast<double>(freeParameters(lower).size());
    const double without = now ? now->cost : std::numeric_limits<double>::infinity();
    return Gain {without - then->cost, priceOfCoefficient * unit * more, more, unit};
}

}  // namespace

bool speaksAgainst(const Model& higher, const Model& lower, const Record& record, const FitOptions& options)
{
    const auto unseen = validationSections(record);
    const auto gain = gainOf(higher, lower, record, unseen, options);
    return gain ? gain->cost < -gain->price : quickSum(lower, record, unseen, options).has_value();
}

std::optional<FitSummary> raiseAsItPays(Model& model, const Record& record, const std::vector<std::size_t>& sections,
                                        const FitOptions& options, const ScoreOptions& score, double share,
                                        const Progress& progress)
{
    std::optional<FitSummary> last;
    constexpr int mostRaises = 3;
    for (int n = 0; n < mostRaises; ++n) {
        auto higher = model;
        if (raiseDegrees(higher, record, score, share, degreesAtOnce, progress.silent()).empty())
            break;
        const auto part = progress.part(static_cast<double>(n) / mostRaises, (n + 1.0) / mostRaises);
        const auto next = fitFed(higher, record, sections, options, part);
        if (!next.usable())
            break;
        // What the slopes of fed laws promise need not come.
        if (const auto gain = gainOf(higher, model, record, sections, options); !gain || !gain->pays())
            break;
        if (speaksAgainst(higher, model, record, options))
            break;
        model = std::move(higher);
        last = next;
    }
    return last;
}

Model withLowerLaw(const Model& model, std::size_t k, int by)
{
    const auto highest = highestCoefficients(model, k, by);
    auto lower = withDegree(model, k, model.components[k].operatingRange.degree - by);
    const auto all = parametersOf(model);
    std::vector<Eigen::Index> rest;
    for (Eigen::Index j = 0; j < static_cast<Eigen::Index>(all.size()); ++j)
        if (std::find(highest.begin(), highest.end(), j) == highest.end())
            rest.push_back(j);
    const auto& C = inverseCurvature(model);
    std::vector<Eigen::Index> told = highest;
    std::erase_if(told, [&](Eigen::Index j) { return C(j, j) == 0.0; });
    const Eigen::VectorXd theta = parameterVector(model);
    const Eigen::MatrixXd C_rb = C(rest, told);
    const Eigen::LDLT<Eigen::MatrixXd> C_bb(Eigen::MatrixXd(C(told, told)));
    // theta_r - follows theta_b
    const Eigen::MatrixXd follows = C_bb.solve(C_rb.transpose()).transpose();
    const Eigen::VectorXd moved = Eigen::VectorXd(theta(rest)) - follows * Eigen::VectorXd(theta(told));
    constexpr double leastShare = 1e-12;  // below which a variance is of rounding
    const auto keepAbove = [&](Eigen::MatrixXd& variance, const Eigen::MatrixXd& before) {
        for (Eigen::Index j = 0; j < variance.rows(); ++j)
            variance(j, j) = std::max(
                variance(j, j),
                leastShare * before(rest[static_cast<std::size_t>(j)], rest[static_cast<std::size_t>(j)]));
    };
    const auto& S = model.covariance;
    const Eigen::MatrixXd shared = S(rest, told) * follows.transpose();
    lower.covariance = Eigen::MatrixXd(S(rest, rest)) - shared - shared.transpose()
                       + follows * Eigen::MatrixXd(S(told, told)) * follows.transpose();
    lower.inverseCurvature = Eigen::MatrixXd(C(rest, rest)) - follows * C_rb.transpose();
    keepAbove(lower.covariance, S);
    keepAbove(lower.inverseCurvature, C);
    const auto left = parametersOf(lower);
    for (std::size_t j = 0; j < left.size(); ++j) {
        const auto row = static_cast<Eigen::Index>(j);
        auto& p = *left[j];
        const auto& before = *all[static_cast<std::size_t>(rest[j])];
        p.free = before.free;
        p.standardError = before.standardError;
        if (!p.free || lower.inverseCurvature(row, row) == 0.0)  // not told by the fit
            continue;
        p.value = std::clamp(moved[row], p.lower, p.upper);
        p.standardError = before.standardError * std::sqrt(lower.covariance(row, row) / S(rest[j], rest[j]));
    }
    tellHosts(lower);
    return lower;
}

void lowerAsUnseenTells(Model& model, FitSummary& summary, const Record& record,
                        const std::vector<std::size_t>& sections, FitOptions options, const Progress& progress)
{
    options.fedGradient = true;  // costs of simulations
    options.substeps = summary.substeps;
    const auto held = validationSections(record);
    const auto leaves = [&](const Model& which, const std::vector<std::size_t>& of) {
        return quickSum(which, record, of, options);
    };
    constexpr double times = 1.1;
    auto seen = leaves(model, sections), unseen = leaves(model, held);
    const auto isLeftWithMore = [&] {  // or runs away
        return !unseen || unseen->cost / unseen->rows > times * std::max(1.0, seen->cost / seen->rows);
    };
    while (record.noiseKnown && seen && model.covariance.size() > 0 && isLeftWithMore()) {
        std::optional<Model> best;
        NormalEquations bestSeen, bestUnseen;
        double most = unseen ? 0.0 : -std::numeric_limits<double>::infinity();  // less that both leave
        for (std::size_t k = 1; k < model.components.size(); ++k) {
            const auto& component = model.components[k];
            if (!component.effect->law() || component.operatingRange.degree - degreesAtOnce < OperatingRange {}.degree
                || !std::isfinite(worthOfHighest(model, k)))
                continue;
            progress.at(0.0, "");
            auto lower = withLowerLaw(model, k);
            const auto unseenThen = leaves(lower, held);
            if (!unseenThen || (unseen && !(unseenThen->cost < unseen->cost)))
                continue;
            const auto then = leaves(lower, sections);
            if (!then)
                continue;
            const double less = (unseen ? unseen->cost : 0.0) - unseenThen->cost + seen->cost - then->cost;
            if (!(less > most))
                continue;
            most = less;
            best = std::move(lower);
            bestSeen = *then;
            bestUnseen = *unseenThen;
        }
        if (!best)
            break;
        const double freedom = summary.finalCost / summary.chiSquaredPerValue
                               + static_cast<double>(freeParameters(model).size())
                               - static_cast<double>(freeParameters(*best).size());
        summary.finalCost += bestSeen.cost - seen->cost;
        summary.chiSquaredPerValue = summary.finalCost / freedom;
        model = std::move(*best);
        seen = std::move(bestSeen);
        unseen = std::move(bestUnseen);
    }
}

void lowerAsItPays(Model& model, FitSummary& summary, const Record& record, const std::vector<std::size_t>& sections,
                   FitOptions options)
{
    options.fedGradient = true;  // costs of simulations
    options.substeps = summary.substeps;
    std::vector<std::size_t> refused;
    const auto next = [&]() -> std::optional<std::size_t> {
        for (const auto k : tooHigh(model))
            if (std::find(refused.begin(), refused.end(), k) == refused.end())
                return k;
        return std::nullopt;
    };
    while (const auto k = next()) {
        auto lower = withLowerLaw(model, *k);
        const auto gain = gainOf(model, lower, record, sections, options);
        constexpr double unforeseen = 1.0;  // of the unit
        if (!gain || gain->pays() || gain->cost > (worthOfHighest(model, *k) + unforeseen) * gain->unit) {
            refused.push_back(*k);
            continue;
        }
        const double freedom = summary.finalCost / summary.chiSquaredPerValue + gain->coefficients;
        summary.finalCost += gain->cost;
        summary.chiSquaredPerValue = summary.finalCost / freedom;
        model = std::move(lower);
    }
}

}  // namespace excursion
