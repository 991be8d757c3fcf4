// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/Separate.h"

#include "Engine/Document/Figures.h"
#include "Engine/Error.h"
#include "Engine/Loudspeaker/OutputError.h"
#include "Engine/Loudspeaker/Simulate.h"
#include "Engine/Signal/Level.h"
#include "Engine/Take/Motion.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

namespace excursion {
namespace {

constexpr double never = -300.0;

/// The loudest section that was fitted.
const Section& loudest(const Record& record)
{
    const auto fitted = estimationSections(record);
    const auto loudness = [&](std::size_t n) { return rmsOf(std::span<const double>(record.sections[n].input)); };
    return record.sections[*std::max_element(fitted.begin(), fitted.end(),
                                             [&](std::size_t m, std::size_t n) { return loudness(m) < loudness(n); })];
}

double differenceDb(std::span<const double> a, std::span<const double> b)
{
    double aa = 0.0, ab = 0.0, bb = 0.0;
    for (std::size_t n = 0; n < a.size(); ++n) {
        aa += a[n] * a[n];
        ab += a[n] * b[n];
        bb += b[n] * b[n];
    }
    return aa > 0.0 && bb > 0.0 ? decibelsOf(std::max(1e-30, 1.0 - ab * ab / (aa * bb))) : never;
}

struct Difference {
    Quantity quantity = Quantity::current;
    double db = never;
};

/// How far they differ in each channel, when the take is played by a factor louder; nothing where one of them runs
/// away.
std::vector<Difference> differences(const Model& a, const Model& b, const Record& record, double factor)
{
    const auto& section = loudest(record);
    auto input = record.drive(section);
    for (auto& u : input)
        u *= factor;
    std::vector<Difference> result;
    try {
        SimulationOptions options;
        options.tolerance = 1e-4;
        const auto first = simulate(a, input, record.sampleRate, options),
                   second = simulate(b, input, record.sampleRate, options);
        for (const auto& channel : first.channels) {
            const auto* other = second.find(channel.quantity);
            if (!other || channel.quantity == first.input().quantity)
                continue;
            const std::size_t window = std::min(section.window, channel.samples.size());
            result.push_back({channel.quantity, differenceDb(std::span(channel.samples).last(window),
                                                             std::span(other->samples).last(window))});
        }
    } catch (const Error&) {
        return {};
    }
    return result;
}

}  // namespace

std::string whatParts(const Model& a, const Model& b, const Record& record)
{
    constexpr double worthIt = 6.0, faintest = -70.0, louder = 2.0;
    const auto measured = [&](Quantity q) {
        // One motion of the cone is as good as another.
        return std::any_of(record.channels.begin(), record.channels.end(), [q](Quantity channel) {
            return channel == q || (integrationsToDisplacement(channel) && integrationsToDisplacement(q));
        });
    };
    const auto larger = [](const Difference& x, const Difference& y) { return x.db < y.db; };
    const auto now = differences(a, b, record, 1.0), then = differences(a, b, record, louder);
    Difference there, elsewhere, loud;
    for (const auto& d : now) {
        // Of the motions, the displacement stands for all.
        if (!measured(d.quantity) && (d.quantity == Quantity::displacement || !integrationsToDisplacement(d.quantity)))
            elsewhere = std::max(elsewhere, d, larger);
        if (std::find(record.channels.begin(), record.channels.end(), d.quantity) != record.channels.end())
            there = std::max(there, d, larger);
    }
    for (const auto& d : then)
        if (std::find(record.channels.begin(), record.channels.end(), d.quantity) != record.channels.end())
            loud = std::max(loud, d, larger);
    if (there.db == never)
        return "Measure again with less noise, a louder level or one more channel.";
    const double needed = std::max(there.db + worthIt, faintest);
    const auto by = [](const Difference& d) {
        return figure(d.db, "%.0f") + " dB of the " + std::string(name(d.quantity));
    };
    const auto further = "measure the " + std::string(name(elsewhere.quantity)) + ", too (the two differ by "
                         + by(elsewhere) + ")";
    const auto louder6 = "measure 6 dB louder (then they differ by " + by(loud) + ")";
    std::string what;
    if (elsewhere.db > needed && loud.db > needed)
        what = elsewhere.db > loud.db ? further + " or " + louder6 : louder6 + " or " + further;
    else if (elsewhere.db > needed || loud.db > needed)
        what = elsewhere.db > needed ? further : louder6;
    if (!what.empty()) {
        what.front() = 'M';
        return what + "; in what was measured they differ by " + by(there) + ".";
    }
    return "No further channel and no louder level would tell the two apart by much; less noise would: they differ by "
           + by(there) + ".";
}

}  // namespace excursion
