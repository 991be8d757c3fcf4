// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/Vote.h"

#include "Engine/Numerics/LeastSquares.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>

namespace excursion {
namespace {

/// How much more of each level would be explained if these strengths, which a step d has set for all levels, had values
/// of their own there.
double gainByLevel(const Sums& sums, const Eigen::VectorXd& d, const std::vector<Eigen::Index>& strengths)
{
    double gain = 0.0;
    for (const auto& [level, whole] : sums.byLevel) {
        auto own = whole;
        own.g += own.N * d;
        const auto e = gaussNewtonStep(own, strengths);
        gain -= 2.0 * own.g.dot(e) + e.dot(own.N * e);
    }
    return gain;
}

}  // namespace

Vote voteOn(const Sums& sums, const std::vector<Eigen::Index>& together, std::vector<Eigen::Index> strengths,
            const Eigen::VectorXd& away, bool noiseKnown)
{
    std::vector<Eigen::Index> rest;
    std::sort(strengths.begin(), strengths.end());
    std::set_difference(together.begin(), together.end(), strengths.begin(), strengths.end(), std::back_inserter(rest));
    auto gone = sums.estimation;
    gone.g += gone.N * away;
    const Eigen::VectorXd without = away + gaussNewtonStep(gone, rest),
                          all = gaussNewtonStep(sums.estimation, together);
    constexpr double fewestRows = 300.0;  // half a decibel of so many is what no chance gives
    double uniqueDb = -std::numeric_limits<double>::infinity();
    for (std::size_t c = 0; c < sums.byChannel.size(); ++c) {
        const auto& channel = sums.byChannel[c];
        const double rows = noiseKnown ? channel.rows : 0.0,
                     sure = sums.power[c].overNoise() <= ErrorPower::most ? 0.0 : sureNoise * rows;
        const double floor = std::max({rows - sure, std::min(rows, fewestRows), 1e-300});
        const auto left = [&](const Eigen::VectorXd& d) { return std::max(predictedCost(channel, d) - sure, floor); };
        uniqueDb = std::max(uniqueDb, 10.0 * std::log10(left(without) / left(all)));
    }
    const double explained = predictedCost(sums.estimation, without) - predictedCost(sums.estimation, all);
    const double byLevel = gainByLevel(sums, all, strengths);
    const double inconsistency = sums.byLevel.size() > 1 ? byLevel / std::max(explained, 1e-300)
                                                         : std::numeric_limits<double>::quiet_NaN();
    return {uniqueDb, inconsistency, byLevel};
}

std::map<std::string, Vote> votesOf(const Model& model, const Record& record, const ScoreOptions& options,
                                    const Progress& progress)
{
    const auto active = freeParameters(model);
    const auto sums = sumsOf(model, record, trialSections(record, 2), active, options, progress);
    std::map<std::string, Vote> votes;
    if (!sums.finite)
        return votes;
    std::vector<Eigen::Index> together(active.size());
    std::iota(together.begin(), together.end(), Eigen::Index {0});
    auto whole = model;
    const auto parameters = parametersOf(whole);
    for (std::size_t k = 1; k < model.components.size(); ++k) {
        const auto strengths = strengthPlaces(model, k, active);
        Eigen::VectorXd away = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(active.size()));
        for (const auto place : strengths)
            away[place] = -parameters[static_cast<std::size_t>(active[static_cast<std::size_t>(place)])]->value;
        votes[model.components[k].effect->id()] = voteOn(sums, together, strengths, away, record.noiseKnown);
    }
    return votes;
}

}  // namespace excursion
