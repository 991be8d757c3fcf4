// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Estimate/HoldOut.h"

#include "Engine/Signal/Fft.h"
#include "Engine/Take/Motion.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

namespace excursion {
namespace {

using Spectrum = std::vector<std::complex<double>>;

/// A signal that tells how far something goes, integrated so often.
struct Motion {
    std::size_t place;  ///< among the channels; their number: the input
    int integrations;
};

std::vector<Motion> motionsOf(const std::vector<Quantity>& channels)
{
    std::vector<Motion> motions;
    for (std::size_t c = 0; c < channels.size(); ++c)
        // The pressure of a piston follows the acceleration.
        if (const auto n = integrationsToDisplacement(channels[c] == Quantity::pressure ? Quantity::acceleration
                                                                                        : channels[c])) {
            motions.push_back({c, *n});      // displacement
            motions.push_back({c, *n - 1});  // velocity
        } else if (channels[c] == Quantity::current) {
            motions.push_back({c, 0});
        }
    motions.push_back({channels.size(), motions.empty() ? 1 : 0});
    return motions;
}

/// Peaks upwards and downwards, in any unit.
struct Peaks {
    std::vector<double> up, down;

    /// Of `length` samples integrated n times between two lines.
    void add(Spectrum spectrum, std::size_t length, std::size_t first, std::size_t last, int integrations)
    {
        for (std::size_t k = 0; k < spectrum.size(); ++k)
            spectrum[k] = k >= first && k <= last
                              ? spectrum[k] * std::pow(std::complex<double>(0.0, static_cast<double>(k)), -integrations)
                              : 0.0;
        const auto samples = inverseFft(spectrum, length);
        const auto [low, high] = std::minmax_element(samples.begin(), samples.end());
        up.push_back(*high);
        down.push_back(-*low);
    }

    /// Lets `farthest` grow to each peak over the largest of the others.
    void tell(std::vector<double>& farthest) const
    {
        farthest.resize(up.size(), 0.0);
        for (const auto* peaks : {&up, &down})
            for (std::size_t n = 0; n < peaks->size(); ++n) {
                double others = 0.0;
                for (std::size_t m = 0; m < peaks->size(); ++m)
                    others = m == n ? others : std::max(others, (*peaks)[m]);
                if (others > 0.0)
                    farthest[n] = std::max(farthest[n], (*peaks)[n] / others);
            }
    }
};

}  // namespace

int leastReaching(const AveragedPeriods& averages)
{
    const auto& take = averages.take();
    const auto& e = averages.excitation();
    std::vector<const Channel*> channels;
    std::vector<Quantity> quantities;
    for (const auto& channel : take.channels)
        if (&channel != &take.input()) {
            channels.push_back(&channel);
            quantities.push_back(channel.quantity);
        }
    channels.push_back(&take.input());
    std::vector<double> farthest;
    for (const auto& [place, integrations] : motionsOf(quantities)) {
        Peaks peaks;
        for (int realization = 0; realization < e.realizations; ++realization)
            peaks.add(fft(averages.inTime(*channels[place], e.loudest(), realization)),
                      static_cast<std::size_t>(e.period), static_cast<std::size_t>(e.lines.front()),
                      static_cast<std::size_t>(e.lines.back()), integrations);
        peaks.tell(farthest);
    }
    return static_cast<int>(std::min_element(farthest.begin(), farthest.end()) - farthest.begin());
}

void holdOutWindows(Record& record)
{
    auto& sections = record.sections;
    if (sections.size() < 2)
        return;
    std::vector<double> farthest;
    for (const auto& [place, integrations] : motionsOf(record.channels)) {
        Peaks peaks;
        for (const auto& section : sections) {
            const double spacing = record.frequency(section, 1);
            peaks.add(place < record.channels.size() ? section.measured[place]
                                                     : fft(std::span(section.input).last(section.window)),
                      section.window, static_cast<std::size_t>(std::ceil(record.bandLow / spacing)),
                      static_cast<std::size_t>(record.bandHigh / spacing), integrations);
        }
        peaks.tell(farthest);
    }
    const auto lesser = [&](const Section& a, const Section& b) {
        return farthest[static_cast<std::size_t>(&a - sections.data())]
               < farthest[static_cast<std::size_t>(&b - sections.data())];
    };
    if (sections.size() == 2)
        sections[lesser(sections[0], sections[1]) ? 0 : 1].validation = true;
    for (std::size_t n = 0; n + 3 <= sections.size(); n += 3) {
        std::size_t order[] {n, n + 1, n + 2};
        std::sort(std::begin(order), std::end(order),
                  [&](std::size_t a, std::size_t b) { return lesser(sections[a], sections[b]); });
        sections[order[1]].validation = true;
    }
}

}  // namespace excursion
