// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/SectionMoves.h"

#include "Engine/Document/Figures.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace excursion {

namespace {

constexpr double smallStiffness = 0.03, smallResistance = 0.005;

/// How far a parameter goes in all, and how far it gets.
struct Way {
    double gone = 0.0, there = 0.0;
};

Way wayOf(const std::vector<SectionFit>& fits, double SectionDrift::Amount::*part, double unit)
{
    Way way;
    for (std::size_t s = 1; s < fits.size(); ++s)
        way.gone += std::abs(fits[s].drift.*part - fits[s - 1].drift.*part) / unit;
    if (!fits.empty())
        way.there = std::abs(fits.back().drift.*part - fits.front().drift.*part) / unit;
    return way;
}

/// Whether what moves most does so in one direction, as what is worked or warms does, and what wanders does not.
bool oneWay(const std::vector<SectionFit>& fits)
{
    constexpr double most = 1.5;  // times the way there
    const auto stiffness = wayOf(fits, &SectionDrift::Amount::stiffness, smallStiffness),
               resistance = wayOf(fits, &SectionDrift::Amount::resistance, smallResistance);
    const auto& way = stiffness.gone > resistance.gone ? stiffness : resistance;
    return way.gone < most * way.there;
}

}  // namespace

bool SectionMoves::areSmall() const { return stiffness < smallStiffness && resistance < smallResistance; }

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
    std::vector<double> shares(record.channels.size(), 0.0);
    std::vector<std::size_t> every(record.sections.size());
    std::iota(every.begin(), every.end(), std::size_t {0});
    const auto fits = outputError(model, record, every, {}, options);
    if (std::any_of(fits.begin(), fits.end(), [](const SectionFit& fit) { return !fit.finite; }) || !oneWay(fits))
        return shares;
    const auto loudest = std::max_element(record.levels.begin(), record.levels.end()) - record.levels.begin();
    for (std::size_t c = 0; c < shares.size(); ++c) {
        double scatter = 0.0, power = 0.0;
        for (std::size_t s = 0; s < fits.size(); ++s) {
            const auto& section = record.sections[s];
            if (section.level != loudest)
                continue;
            const double periods = std::round(2.0 * (section.end - section.middle) * record.sampleRate
                                              / static_cast<double>(section.window));
            // The mean of so many periods of an even change by one has this variance.
            scatter += (periods + 1.0) / 12.0 * fits[s].drift.onTheWay[c];
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
