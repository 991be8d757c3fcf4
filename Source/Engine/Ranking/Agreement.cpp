// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Ranking/Agreement.h"

#include "Engine/Diagnosis/Improve.h"
#include "Engine/Document/Words.h"
#include "Engine/Error.h"
#include "Engine/Estimate/Periods.h"
#include "Engine/Loudspeaker/Catalogue.h"

#include <algorithm>

namespace excursion {
namespace {

/// What each used period of a channel differs by from the average, in place; 0 elsewhere.
std::vector<double> scatterOf(const Measurement& take, const Channel& channel)
{
    std::vector<double> scatter(channel.samples.size(), 0.0);
    if (!take.hasPeriods() || take.excitation->periods < 2)
        return scatter;
    const auto& excitation = *take.excitation;
    for (int level = 0; level < static_cast<int>(excitation.levels.size()); ++level)
        for (int r = 0; r < excitation.realizations; ++r) {
            const auto mean = averagePeriod(take, channel, level, r);
            for (int p = 0; p < excitation.periods; ++p) {
                const auto period = onePeriod(take, channel, level, r, p);
                const auto at = period.data() - channel.samples.data();
                for (std::size_t t = 0; t < mean.size(); ++t)
                    scatter[static_cast<std::size_t>(at) + t] = period[t] - mean[t];
            }
        }
    return scatter;
}

double errorOf(const Rung& rung, Quantity output)
{
    for (const auto& channel : rung.comparison.channels)
        if (channel.quantity == output)
            return channel.total.db;
    return rung.comparison.channels.front().total.db;
}

}  // namespace

Agreement agreement(const PreparedTake& given, Quantity output,
                    const std::function<Eigen::MatrixXd(const Eigen::MatrixXd&)>& play, const Progress& progress)
{
    auto take = given.measurement();
    const auto* explained = take.find(output);
    if (!explained || explained == &take.input())
        throw Error(Error::Kind::data, "The take has no such channel beside its input.");
    const auto& u = take.input().samples;
    const auto y = play(Eigen::Map<const Eigen::VectorXd>(u.data(), static_cast<Eigen::Index>(u.size())));
    if (!y.allFinite())
        throw Error(Error::Kind::numerical, "The model runs away on this take, so there is nothing to agree with.");
    auto scatter = scatterOf(take, *explained);
    for (std::size_t t = 0; t < scatter.size(); ++t)
        scatter[t] += y(static_cast<Eigen::Index>(t), 0);
    Channel played = *explained;
    played.samples = std::move(scatter);
    played.fullScale = std::max(played.fullScale, 1.1 * y.cwiseAbs().maxCoeff());
    take.channels = {take.input(), played};

    Agreement found;
    found.ladder = improve(std::move(take), {}, progress);
    if (found.ladder.rungs.empty())
        throw Error(Error::Kind::data, found.ladder.sentence);
    found.effects = found.ladder.model().effectIds();
    found.baseDb = errorOf(found.ladder.rungs.front(), output);
    found.leftDb = errorOf(found.ladder.rungs.back(), output);
    const auto laws = joined(
        found.effects, [&](const auto& id) { return effectNamed(id).title(); }, " and ");
    found.sentence = laws.empty() ? "No law of the catalogue is found in this model: " + found.ladder.sentence
                                  : "This model moves as a driver with " + laws + " does.";
    return found;
}

}  // namespace excursion
