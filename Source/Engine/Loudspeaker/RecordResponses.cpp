// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/FitResponse.h"

#include "Engine/Numerics/Median.h"
#include "Engine/Signal/Delay.h"
#include "Engine/Signal/Fft.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace excursion {
namespace {

using Complex = std::complex<double>;

constexpr double omega = 2.0 * std::numbers::pi;  // times Hz

struct Cell {
    Complex cross {};
    double input = 0.0, output = 0.0, weightedFrequency = 0.0, noise = 0.0;
    int count = 0;
};

/// Whether two responses, the second of them the better known one, nowhere differ by more than the deviation of the
/// first: of neighbouring points the half may by chance be off by three times its square once in a thousand times.
bool agree(const ResponseTarget& rough, const ResponseTarget& exact)
{
    if (rough.quantity != exact.quantity || rough.value.size() != exact.value.size())
        return false;
    constexpr double chance = 3.0;
    constexpr std::size_t neighbours = 6;
    std::vector<double> apart;
    for (std::size_t k = 0; k < rough.value.size(); ++k)
        apart.push_back(std::norm(rough.value[k] - exact.value[k]) / (rough.deviation[k] * rough.deviation[k]));
    for (std::size_t k = 0; k < apart.size(); k += neighbours) {
        const auto first = apart.begin() + static_cast<std::ptrdiff_t>(k);
        const auto count = static_cast<std::ptrdiff_t>(std::min(neighbours, apart.size() - k));
        if (medianOf(std::vector<double>(first, first + count)) > chance)
            return false;
    }
    return true;
}

/// By how many seconds the sound is late. It turns the phase within a band, where a mean over the lines of a far
/// microphone's response would lie, or vanish. 0 for the other channels.
double timeOfFlight(const Record& record, std::size_t channel, const Section& section)
{
    constexpr std::size_t fewest = 64;  // samples
    if (record.channels[channel] != Quantity::pressure || section.window < fewest)
        return 0.0;
    const auto input = std::span(section.input).last(section.window);
    const auto output = inverseFft(section.measured[channel], section.window);
    if (std::all_of(output.begin(), output.end(), [](double y) { return y == 0.0; })
        || std::all_of(input.begin(), input.end(), [](double u) { return u == 0.0; }))
        return 0.0;
    DelayOptions options;
    options.period = section.periodic ? static_cast<int>(section.window) : 0;
    return estimateDelay(input, output, options).samples / record.sampleRate;
}

}  // namespace

std::vector<ResponseTarget> responsesOf(const Record& record, int level, int pointsPerOctave)
{
    std::vector<ResponseTarget> targets;
    const double low = std::max(record.bandLow * 0.99, 1e-3);
    const int cells = std::max(4,
                               static_cast<int>(std::ceil(std::log2(record.bandHigh * 1.01 / low) * pointsPerOctave)));
    std::vector<std::pair<const Section*, std::vector<Complex>>> used;  // with the spectrum of the input
    for (const auto& section : record.sections)
        if (!section.validation && (level < 0 || section.level < 0 || section.level == level))
            used.emplace_back(&section, fft(std::span(section.input).last(section.window)));
    for (std::size_t c = 0; c < record.channels.size(); ++c) {
        const double delay = used.empty() ? 0.0 : timeOfFlight(record, c, *used.back().first);
        std::vector<Cell> grid(static_cast<std::size_t>(cells) + 1);
        double totalInput = 0.0;
        std::size_t lines = 0;
        for (const auto& one : used) {
            const auto& section = *one.first;
            const auto& U = one.second;
            const auto add = [&](std::size_t k) {
                const double f = record.frequency(section, k);
                if (f < low || f > record.bandHigh * 1.01)
                    return;
                auto& cell = grid[static_cast<std::size_t>(std::log2(f / low) * pointsPerOctave)];
                cell.cross += section.measured[c][k] * std::conj(U[k]) * std::polar(1.0, omega * f * delay);
                cell.input += std::norm(U[k]);
                cell.output += std::norm(section.measured[c][k]);
                cell.noise += section.deviation[c][k] * section.deviation[c][k] * std::norm(U[k]);
                cell.weightedFrequency += f * std::norm(U[k]);
                ++cell.count;
                totalInput += std::norm(U[k]);
                ++lines;
            };
            if (!section.excited.empty())
                for (const int k : section.excited)
                    add(static_cast<std::size_t>(k));
            else
                for (std::size_t k = 1; k < section.window / 2; ++k)
                    add(k);
        }
        ResponseTarget target;
        target.quantity = record.channels[c];
        for (const auto& cell : grid) {
            // A cell with next to no input power says nothing.
            if (cell.count == 0
                || cell.input < 1e-7 * totalInput * cell.count / static_cast<double>(std::max<std::size_t>(lines, 1)))
                continue;
            const double f = cell.weightedFrequency / cell.input;
            const Complex G = cell.cross / cell.input * std::polar(1.0, -omega * f * delay);
            const double left = std::max(0.0, cell.output - std::norm(cell.cross) / cell.input);
            // One line alone tells nothing of its noise.
            const double scatter = cell.count > 1 ? left / (cell.count - 1) / cell.input : 0.0,
                         variance = std::max(scatter, cell.noise / (cell.input * cell.input));
            target.frequency.push_back(f);
            target.value.push_back(G);
            // A third of a percent besides: the linear model is a start, not a truth.
            target.deviation.push_back(std::sqrt(variance + 1e-5 * std::norm(G)));
        }
        if (target.frequency.size() >= 3)
            targets.push_back(std::move(target));
    }
    return targets;
}

std::vector<ResponseTarget> linearResponsesOf(const Record& record, int pointsPerOctave)
{
    auto all = responsesOf(record, -1, pointsPerOctave);
    if (record.levels.size() < 2)
        return all;
    auto quiet = responsesOf(record, 0, pointsPerOctave);
    if (quiet.size() < record.channels.size())
        return all;
    for (std::size_t c = 0; c < quiet.size(); ++c)
        if (c < all.size() && agree(quiet[c], all[c]))
            quiet[c] = std::move(all[c]);
    return quiet;
}

}  // namespace excursion
