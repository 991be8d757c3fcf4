// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/FitResponse.h"

#include "Engine/Numerics/Median.h"
#include "Engine/Signal/Delay.h"
#include "Engine/Signal/Fft.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

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

/// The sections that are asked, each with the spectrum of its input, and the bands that they are averaged in.
struct Asked {
    struct One {
        const Section* section;
        std::vector<Complex> input;
    };
    const Record& record;
    std::vector<One> sections;
    double low, high;  ///< Hz
    int pointsPerOctave;

    /// The lines of a section that tell something.
    template <class Use>
    void eachLine(const Section& section, const Use& use) const
    {
        const auto within = [&](std::size_t k) {
            if (const double f = record.frequency(section, k); f >= low && f <= high)
                use(k, f);
        };
        if (!section.excited.empty())
            for (const int k : section.excited)
                within(static_cast<std::size_t>(k));
        else
            for (std::size_t k = 1; k < section.window / 2; ++k)
                within(k);
    }

    /// @param delay  s, by which a channel is made earlier
    std::vector<Cell> cells(std::size_t channel, double delay) const
    {
        const int bands = std::max(4, static_cast<int>(std::ceil(std::log2(high / low) * pointsPerOctave)));
        std::vector<Cell> grid(static_cast<std::size_t>(bands) + 1);
        for (const auto& one : sections)
            eachLine(*one.section, [&](std::size_t k, double f) {
                const auto output = one.section->measured[channel][k], input = one.input[k];
                const double deviation = one.section->deviation[channel][k], power = std::norm(input);
                auto& cell = grid[static_cast<std::size_t>(std::log2(f / low) * pointsPerOctave)];
                cell.cross += output * std::conj(input) * std::polar(1.0, omega * f * delay);
                cell.input += power;
                cell.output += std::norm(output);
                cell.noise += deviation * deviation * power;
                cell.weightedFrequency += f * power;
                ++cell.count;
            });
        return grid;
    }
};

/// The power of the output that the means of the bands explain.
double explained(const std::vector<Cell>& grid)
{
    double sum = 0.0;
    for (const auto& cell : grid)
        sum += cell.input > 0.0 ? std::norm(cell.cross) / cell.input : 0.0;
    return sum;
}

/// ResponseTarget::delayPeriod of the lines of a section.
double delayPeriodOf(const Asked& asked, const Section& section)
{
    int apart = 0;
    for (std::size_t k = 1; k < section.excited.size(); ++k)
        apart = std::gcd(apart, section.excited[k] - section.excited[k - 1]);
    return apart > 0 ? static_cast<double>(section.window) / (apart * asked.record.sampleRate)
                     : std::numeric_limits<double>::infinity();
}

/// By how many seconds the sound of a section is late; 0 where nothing tells.
double timeOfFlight(const Asked& asked, const Asked::One& one, std::size_t channel)
{
    constexpr std::size_t fewest = 64;  // samples
    const auto& section = *one.section;
    if (section.window < fewest)
        return 0.0;
    const auto input = std::span(section.input).last(section.window);
    const auto output = inverseFft(section.measured[channel], section.window);
    const auto isSilent = [](double value) { return value == 0.0; };
    if (std::all_of(output.begin(), output.end(), isSilent) || std::all_of(input.begin(), input.end(), isSilent))
        return 0.0;
    const double rate = asked.record.sampleRate;
    DelayOptions options;
    options.period = section.periodic ? static_cast<int>(section.window) : 0;
    options.lowest = asked.low / rate;
    options.highest = std::min(0.5, asked.high / rate);
    const double late = estimateDelay(input, output, options).samples / rate;
    if (!std::isfinite(late))
        return 0.0;
    const double repeats = delayPeriodOf(asked, section);
    return std::isfinite(repeats) ? late - std::round(late / repeats) * repeats : late;
}

/// The section with the most power at the lines that are asked.
const Asked::One& loudestOf(const Asked& asked)
{
    std::vector<double> power;
    for (const auto& one : asked.sections) {
        double sum = 0.0;
        asked.eachLine(*one.section, [&](std::size_t k, double) { sum += std::norm(one.input[k]); });
        power.push_back(sum);
    }
    return asked.sections[static_cast<std::size_t>(std::max_element(power.begin(), power.end()) - power.begin())];
}

}  // namespace

std::vector<ResponseTarget> responsesOf(const Record& record, int level, int pointsPerOctave)
{
    Asked asked {record, {}, std::max(record.bandLow * 0.99, 1e-3), record.bandHigh * 1.01, pointsPerOctave};
    for (const auto& section : record.sections)
        if (!section.validation && (level < 0 || section.level < 0 || section.level == level))
            asked.sections.push_back({&section, fft(std::span(section.input).last(section.window))});
    std::vector<ResponseTarget> targets;
    for (std::size_t c = 0; c < record.channels.size(); ++c) {
        auto grid = asked.cells(c, 0.0);
        double delay = 0.0;
        if (record.channels[c] == Quantity::pressure && !asked.sections.empty()) {
            // A time of flight turns the phase within a band, where the mean of a far microphone's response would lie,
            // or vanish. It is believed where more is explained without it.
            const double late = timeOfFlight(asked, loudestOf(asked), c);
            if (auto earlier = asked.cells(c, late); explained(earlier) > explained(grid)) {
                grid = std::move(earlier);
                delay = late;
            }
        }
        double totalInput = 0.0;
        int lines = 0;
        for (const auto& cell : grid) {
            totalInput += cell.input;
            lines += cell.count;
        }
        ResponseTarget target;
        target.quantity = record.channels[c];
        if (!asked.sections.empty())
            target.delayPeriod = delayPeriodOf(asked, *asked.sections.front().section);
        for (const auto& cell : grid) {
            // A cell with next to no input power says nothing.
            if (cell.count == 0 || !(cell.input > 1e-7 * totalInput * cell.count / std::max(lines, 1)))
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
