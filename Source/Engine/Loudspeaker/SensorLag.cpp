// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/SensorLag.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace excursion {
namespace {

/// In the order of the path's parameters (Radiation.cpp).
constexpr std::array lagging {Quantity::current, Quantity::displacement, Quantity::velocity, Quantity::acceleration};
constexpr Eigen::Index firstLag = 2;

}  // namespace

std::optional<Eigen::Index> lagPlace(Quantity quantity)
{
    const auto found = std::find(lagging.begin(), lagging.end(), quantity);
    if (found == lagging.end())
        return std::nullopt;
    return firstLag + (found - lagging.begin());
}

double lagOf(const Model& model, Quantity quantity)
{
    const auto place = lagPlace(quantity);
    return place ? model.path.parameters[static_cast<std::size_t>(*place)].value : 0.0;
}

Model withoutLags(Model model)
{
    for (const auto quantity : lagging)
        model.path.parameters[static_cast<std::size_t>(*lagPlace(quantity))].value = 0.0;
    return model;
}

void freeLags(Model& model, const Record& record)
{
    constexpr double turn = 0.05, most = 10.0;  // rad; of the prior
    for (const auto quantity : lagging) {
        auto& p = model.path.parameters[static_cast<std::size_t>(*lagPlace(quantity))];
        p.free = hasPeriods(record) && record.noiseKnown && record.channelIndex(quantity) && record.bandLow > 0.0;
        if (!p.free)
            continue;
        // Displacement and velocity fall off with frequency.
        const bool falls = quantity == Quantity::displacement || quantity == Quantity::velocity;
        const double highest = !falls ? record.bandHigh : std::sqrt(record.bandLow * record.bandHigh);
        p.prior = turn / (2.0 * std::numbers::pi * highest);
        p.lower = -most * p.prior;
        p.upper = most * p.prior;
    }
}

void lag(std::vector<std::complex<double>>& spectrum, double step, double tau)
{
    if (tau == 0.0)
        return;
    for (std::size_t k = 0; k < spectrum.size(); ++k)
        spectrum[k] *= std::polar(1.0, -step * static_cast<double>(k) * tau);
}

std::vector<std::complex<double>> lagSlope(std::vector<std::complex<double>> seen, double step)
{
    for (std::size_t k = 0; k < seen.size(); ++k)
        seen[k] *= std::complex<double>(0.0, -step * static_cast<double>(k));
    return seen;
}

std::vector<Parameter> toldOfPath(const Model& model)
{
    auto told = model.path.parameters;
    std::erase_if(told, [&](const Parameter& p) { return !p.free && p.value == 0.0 && std::isfinite(p.prior); });
    return told;
}

}  // namespace excursion
