// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/Sums.h"

#include "Engine/Loudspeaker/FeedbackError.h"

#include <algorithm>

namespace excursion {

std::vector<std::size_t> trialSections(const Record& record, int realizations)
{
    constexpr std::size_t windows = 6;  // without levels, for each realization that is asked
    const auto fitted = estimationSections(record);
    std::map<int, int> taken;
    std::vector<std::size_t> sections;
    if (const auto most = windows * static_cast<std::size_t>(realizations);
        record.levels.empty() && fitted.size() > most) {
        for (std::size_t k = 0; k < most; ++k)
            sections.push_back(fitted[(2 * k + 1) * fitted.size() / (2 * most)]);
        return sections;
    }
    for (const auto n : fitted) {
        const int level = record.sections[n].level;
        if (level >= 0 && taken[level]++ >= realizations)
            continue;
        sections.push_back(n);
    }
    return sections;
}

OutputErrorOptions ScoreOptions::run() const
{
    OutputErrorOptions run;
    run.substeps = substeps;
    run.played = played;
    run.threads = threads;
    return run;
}

Sums sumsOf(const Model& model, const Record& record, std::vector<std::size_t> sections,
            const std::vector<Eigen::Index>& active, const ScoreOptions& options, const Progress& progress)
{
    Sums sums;
    sums.byChannel.resize(record.channels.size());
    sums.power.resize(record.channels.size());
    const auto held = validationSections(record);
    for (const auto n : held)
        if (std::find(sections.begin(), sections.end(), n) == sections.end())
            sections.push_back(n);
    const auto fits = quickError(model, record, sections, active, options.run(), progress);
    for (std::size_t k = 0; k < fits.size(); ++k) {
        const auto n = sections[k];
        if (!fits[k].finite) {
            sums.finite = false;
            return sums;
        }
        const bool validates = std::find(held.begin(), held.end(), n) != held.end();
        for (std::size_t c = 0; c < record.channels.size(); ++c) {
            if (!record.sections[n].validation) {
                sums.estimation.add(fits[k].channels[c]);
                sums.byLevel[record.sections[n].level].add(fits[k].channels[c]);
            }
            if (validates) {
                sums.validation.add(fits[k].channels[c]);
                sums.byChannel[c].add(fits[k].channels[c]);
                sums.power[c].add(fits[k].power[c]);
            }
        }
    }
    addPrior(model, active, sums.estimation);
    return sums;
}

double predictedCost(const NormalEquations& e, const Eigen::VectorXd& d)
{
    return std::max(0.0, e.cost + 2.0 * e.g.dot(d) + d.dot(e.N * d));
}

std::vector<Eigen::Index> strengthPlaces(const Model& model, std::size_t k, const std::vector<Eigen::Index>& active)
{
    const auto first = firstParameterOf(model, k);
    std::vector<Eigen::Index> positions;
    for (std::size_t j = 0; j < model.components[k].parameters.size(); ++j)
        if (const auto& p = model.components[k].parameters[j]; p.strength && p.free) {
            const auto index = first + static_cast<Eigen::Index>(j);
            positions.push_back(std::lower_bound(active.begin(), active.end(), index) - active.begin());
        }
    return positions;
}

}  // namespace excursion
