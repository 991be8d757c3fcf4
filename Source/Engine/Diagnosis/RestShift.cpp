// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/RestShift.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace excursion {
namespace {

/// Means over one section, m.
struct Means {
    double time, measured, model, deviation, rms;

    double beside() const { return measured - model; }
};

std::vector<Means> meansOf(const Record& record, const std::vector<SectionFit>& fits, std::size_t channel)
{
    std::vector<std::size_t> order(record.sections.size());
    std::iota(order.begin(), order.end(), std::size_t {0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return record.sections[a].middle < record.sections[b].middle;
    });
    std::vector<Means> means;
    for (const auto n : order) {
        const auto& section = record.sections[n];
        const auto N = static_cast<double>(section.window);
        const auto& lines = section.measured[channel];
        double power = 0.0;
        for (std::size_t k = 1; k < lines.size(); ++k)
            power += 2.0 * std::norm(lines[k] / N);
        means.push_back({section.middle, lines.front().real() / N, fits[n].predicted[channel].front().real() / N,
                         section.deviation[channel].front() / N, std::sqrt(power)});
    }
    return means;
}

}  // namespace

std::optional<RestShift> restShift(const Record& record, const std::vector<SectionFit>& fits)
{
    constexpr std::size_t fewest = 3;
    const auto channel = record.channelIndex(Quantity::displacement);
    if (!channel || !hasPeriods(record) || !record.noiseKnown || record.sections.size() < fewest
        || std::any_of(fits.begin(), fits.end(), [](const SectionFit& fit) { return !fit.finite; }))
        return std::nullopt;
    const auto means = meansOf(record, fits, *channel);
    const auto stepAfter = [&](std::size_t n) { return std::abs(means[n + 1].beside() - means[n].beside()); };
    std::size_t at = 0;
    for (std::size_t n = 1; n + 1 < means.size(); ++n)
        if (stepAfter(n) > stepAfter(at))
            at = n;
    double others = 0.0, explained = 0.0, rms = 0.0;
    for (std::size_t n = 0; n < means.size(); ++n) {
        if (n != at && n + 1 < means.size())
            others = std::max(others, stepAfter(n));
        explained = std::max(explained, std::abs(means[n].model));
        rms = std::max(rms, means[n].rms);
    }
    const auto &here = means[at], &next = means[at + 1];
    const double step = stepAfter(at);
    constexpr double sure = 6.0, far = 3.0, worthAWord = 0.01, seen = 0.5;
    if (!(step > sure * std::hypot(here.deviation, next.deviation) && step > far * others && step > explained
          && step > worthAWord * rms && std::abs(next.measured - here.measured) > seen * step))
        return std::nullopt;
    return RestShift {step, here.time, next.time};
}

}  // namespace excursion
