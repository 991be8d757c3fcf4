// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/SectionMoves.h"

#include "Engine/Document/Figures.h"

#include <algorithm>
#include <cmath>

namespace excursion {

SectionMoves movesOf(const std::vector<SectionFit>& fits)
{
    const auto range = [&](double SectionDrift::Amount::*part) {
        const auto [least, most] = std::minmax_element(
            fits.begin(), fits.end(),
            [&](const SectionFit& a, const SectionFit& b) { return a.drift.*part < b.drift.*part; });
        return fits.empty() ? 0.0 : most->drift.*part - least->drift.*part;
    };
    return {range(&SectionDrift::Amount::stiffness), range(&SectionDrift::Amount::resistance)};
}

std::vector<double> wanderByMoves(const Model& model, const Record& record, const OutputErrorOptions& options)
{
    const auto loudest = std::max_element(record.levels.begin(), record.levels.end()) - record.levels.begin();
    std::vector<std::size_t> sections;
    for (std::size_t s = 0; s < record.sections.size(); ++s)
        if (record.sections[s].level == loudest)
            sections.push_back(s);
    const auto fits = outputError(model, record, sections, {}, options);
    std::vector<double> shares(record.channels.size(), 0.0);
    if (std::any_of(fits.begin(), fits.end(), [](const SectionFit& fit) { return !fit.finite; }))
        return shares;
    for (std::size_t c = 0; c < record.channels.size(); ++c) {
        double scatter = 0.0, power = 0.0;
        for (std::size_t n = 0; n < fits.size(); ++n) {
            const auto& section = record.sections[sections[n]];
            const double periods = std::round(2.0 * (section.end - section.middle) * record.sampleRate
                                              / static_cast<double>(section.window));
            // The mean of so many periods of an even change by one has this variance.
            scatter += (periods + 1.0) / 12.0 * fits[n].drift.onTheWay[c];
            for (const int k : section.excited)
                power += std::norm(section.measured[c][static_cast<std::size_t>(k)]);
        }
        shares[c] = power > 0.0 ? scatter / power : 0.0;
    }
    return shares;
}

std::string told(const SectionMoves& moves)
{
    const auto percent = [](double share) { return figure(100.0 * share, "%.2g") + " %"; };
    return "Between the sections of the take the stiffness moves by " + percent(moves.stiffness)
           + (moves.resistance > 0.0 ? " and the resistance by " + percent(moves.resistance) : "")
           + ", as where a suspension is worked or a coil warms. The comparison follows that.";
}

}  // namespace excursion
