// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/FitResponse.h"

#include "Engine/Loudspeaker/PistonBand.h"
#include "Engine/Loudspeaker/SmallSignal.h"
#include "Engine/Numerics/Median.h"
#include "Engine/Signal/Fft.h"
#include "Engine/Signal/Level.h"
#include "Engine/Take/Motion.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

using Complex = std::complex<double>;

struct Cell {
    Complex cross {};
    double input = 0.0, output = 0.0, weightedFrequency = 0.0, noise = 0.0;
    int count = 0;
};

/// Octaves that a point stands for: half the way to either neighbour.
double octavesAt(const std::vector<double>& frequency, std::size_t k)
{
    const std::size_t before = k > 0 ? k - 1 : k, after = std::min(k + 1, frequency.size() - 1);
    return std::log2(frequency[after] / frequency[before])
           / static_cast<double>(std::max<std::size_t>(1, after - before));
}

/// An impedance counts by its relative error, at the bottom between resonance and inductance as much as on the peak; a
/// motion fades into noise away from resonance and counts by its error against the whole curve's rms. Every octave
/// counts alike, however many points it has.
void weigh(ResponseTarget& target)
{
    // of a motion, against an impedance: the cone is touched by light at one point only
    constexpr double trust = 0.25;
    const std::size_t points = target.value.size();
    double power = 0.0, octaves = 0.0;
    for (std::size_t k = 0; k < points; ++k) {
        power += octavesAt(target.frequency, k) * std::norm(target.value[k]);
        octaves += octavesAt(target.frequency, k);
    }
    const double rms = std::sqrt(power / octaves), perPoint = octaves / static_cast<double>(points);
    target.deviation.resize(points);
    for (std::size_t k = 0; k < points; ++k) {
        const double scale = target.impedance            ? std::max(std::abs(target.value[k]), 1e-6 * rms)
                             : isMotion(target.quantity) ? rms / trust
                                                         : rms;
        target.deviation[k] = scale * std::sqrt(perPoint / octavesAt(target.frequency, k));
    }
}

/// Points that were measured: programs fill the ends of a curve, where the instrument gave nothing, with copies of the
/// first and of the last value.
std::pair<std::size_t, std::size_t> measuredRange(const std::vector<Complex>& value)
{
    constexpr std::size_t fewest = 3;
    std::size_t first = 0, last = value.size();
    while (first + 1 < value.size() && value[first + 1] == value.front())
        ++first;
    while (last > first + 1 && value[last - 2] == value.back())
        --last;
    // Two equal neighbours happen; a constant curve is what it is.
    if (first + 1 < fewest)
        first = 0;
    if (value.size() - last + 1 < fewest)
        last = value.size();
    return last - first < fewest ? std::pair {std::size_t {0}, value.size()} : std::pair {first, last};
}

/// The points between the ends at which the excitation has died away: there apparent power (or the input's own, without
/// a current) lies 20 dB below the median of the octave further in, and little but noise was measured.
std::pair<std::size_t, std::size_t> drivenRange(const Spectra& spectra, const Spectra::Channel& input)
{
    const auto* current = spectra.find(Quantity::current);
    const std::size_t points = spectra.frequency.size();
    std::vector<double> amplitude(points);  // root of the power
    for (std::size_t k = 0; k < points; ++k)
        amplitude[k] = std::sqrt(std::abs(input.values[k]) * std::abs((current ? *current : input).values[k]));
    const auto fallen = [&](std::size_t from, std::size_t to, double value) {
        return value < 0.1
                           * medianOf({amplitude.begin() + static_cast<std::ptrdiff_t>(from),
                                       amplitude.begin() + static_cast<std::ptrdiff_t>(to)});
    };
    std::size_t first = 0, last = points;
    const auto octaveAbove = [&](std::size_t k) {
        return static_cast<std::size_t>(
            std::upper_bound(spectra.frequency.begin(), spectra.frequency.end(), 2.0 * spectra.frequency[k])
            - spectra.frequency.begin());
    };
    const auto octaveBelow = [&](std::size_t k) {
        return static_cast<std::size_t>(
            std::lower_bound(spectra.frequency.begin(), spectra.frequency.end(), 0.5 * spectra.frequency[k])
            - spectra.frequency.begin());
    };
    const std::size_t above = points > 0 ? octaveAbove(0) : 0, below = points > 0 ? octaveBelow(points - 1) : 0;
    while (first + 1 < above && fallen(first, above, amplitude[first]))
        ++first;
    while (last > below + 2 && fallen(below, last, amplitude[last - 1]))
        --last;
    return {first, last};
}

/// Cuts measured motion where the cone no longer moves as one piece, as no driver model claims to know the motion of
/// one point of it.
void keepRigid(std::vector<ResponseTarget>& targets)
{
    const auto current = std::find_if(targets.begin(), targets.end(), [](const auto& t) { return t.impedance; });
    if (current == targets.end())
        return;
    for (auto& target : targets) {
        // Both stand on the same bands, unless one of them was padded.
        if (!isMotion(target.quantity) || target.frequency.size() != current->frequency.size())
            continue;
        const double limit = pistonLimit(*current, target);
        const auto count = static_cast<std::size_t>(
            std::upper_bound(target.frequency.begin(), target.frequency.end(), limit) - target.frequency.begin());
        target.frequency.resize(count);
        target.value.resize(count);
        target.deviation.resize(count);
    }
}

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
                cell.cross += section.measured[c][k] * std::conj(U[k]);
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
            const Complex G = cell.cross / cell.input;
            const double left = std::max(0.0, cell.output - std::norm(cell.cross) / cell.input);
            // One line alone tells nothing of its noise.
            const double scatter = cell.count > 1 ? left / (cell.count - 1) / cell.input : 0.0,
                         variance = std::max(scatter, cell.noise / (cell.input * cell.input));
            target.frequency.push_back(cell.weightedFrequency / cell.input);
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

ResponseTarget thinned(const ResponseTarget& dense, int pointsPerOctave)
{
    ResponseTarget thin;
    thin.quantity = dense.quantity;
    thin.impedance = dense.impedance;
    const std::size_t points = dense.frequency.size();
    for (std::size_t k = 0; k < points;) {
        const double band = std::floor(std::log2(dense.frequency[k]) * pointsPerOctave);
        Complex value = 0.0;
        double frequency = 0.0, power = 0.0, variance = 0.0;
        const std::size_t begin = k;
        for (; k < points && std::floor(std::log2(dense.frequency[k]) * pointsPerOctave) == band; ++k) {
            value += dense.value[k];
            power += std::norm(dense.value[k]);
            frequency += dense.frequency[k];
            variance += dense.deviation[k] * dense.deviation[k];
        }
        const double count = static_cast<double>(k - begin);
        // A time of flight turns the phase within a band: there a mean would lie.
        const bool turns = std::norm(value / count) < 0.98 * power / count;
        const std::size_t middle = begin + (k - begin) / 2;
        thin.value.push_back(turns ? dense.value[middle] : value / count);
        thin.frequency.push_back(turns ? dense.frequency[middle] : frequency / count);
        thin.deviation.push_back(std::sqrt(variance / count));
    }
    return thin.frequency.size() < 3 ? dense : thin;
}

std::vector<ResponseTarget> thinned(const std::vector<ResponseTarget>& dense, int pointsPerOctave)
{
    std::vector<ResponseTarget> thin;
    for (const auto& target : dense)
        thin.push_back(thinned(target, pointsPerOctave));
    return thin;
}

std::vector<ResponseTarget> responsesOf(const Spectra& spectra, int pointsPerOctave)
{
    const auto* voltage = spectra.find(Quantity::voltage);
    const auto* input = voltage ? voltage : spectra.find(Quantity::force);
    if (!input)
        throw Error(
            Error::Kind::data,
            "The frequency response names no voltage and no force, so it is not known what it is a response to.");
    std::vector<ResponseTarget> targets;
    const auto [firstDriven, lastDriven] = drivenRange(spectra, *input);
    for (const auto& channel : spectra.channels) {
        if (&channel == input)
            continue;
        ResponseTarget all;
        all.quantity = channel.quantity;
        all.impedance = channel.quantity == Quantity::current;
        for (std::size_t k = firstDriven; k < lastDriven; ++k) {
            if (spectra.frequency[k] <= 0.0)
                continue;
            const Complex value = all.impedance ? input->values[k] / channel.values[k]
                                                : channel.values[k] / input->values[k];
            if (!std::isfinite(std::norm(value)))
                throw Error(Error::Kind::data, "The frequency response is zero where it is divided by, at "
                                                   + std::to_string(spectra.frequency[k]) + " Hz.");
            all.frequency.push_back(spectra.frequency[k]);
            all.value.push_back(value);
        }
        const auto [first, last] = measuredRange(all.value);
        ResponseTarget target;
        target.quantity = all.quantity;
        target.impedance = all.impedance;
        for (std::size_t k = first; k < last; ++k) {
            target.frequency.push_back(all.frequency[k]);
            target.value.push_back(all.value[k]);
            target.deviation.push_back(1.0);
        }
        if (target.frequency.size() < 3)
            throw Error(Error::Kind::data, "The frequency response has " + std::to_string(target.frequency.size())
                                               + " points of " + std::string(name(channel.quantity))
                                               + ", expected at least 3.");
        targets.push_back(thinned(target, pointsPerOctave));
    }
    if (targets.empty())
        throw Error(Error::Kind::data,
                    "The frequency response holds only what drives the loudspeaker; a fit needs at least one of "
                    "current, displacement, velocity, acceleration or pressure.");
    keepRigid(targets);
    for (auto& target : targets)
        weigh(target);
    return targets;
}

double responseErrorDb(const Model& model, const ResponseTarget& target)
{
    const auto response = respond(model, {target.quantity}, target.frequency).front();
    double error = 0.0, power = 0.0;
    for (std::size_t f = 0; f < target.frequency.size(); ++f) {
        const Complex value = target.impedance ? 1.0 / response.value[f] : response.value[f];
        const double weight = 1.0 / (target.deviation[f] * target.deviation[f]);
        error += weight * std::norm(value - target.value[f]);
        power += weight * std::norm(target.value[f]);
    }
    return decibelsOf(error / power);
}

double responseErrorDb(const Model& model, const std::vector<ResponseTarget>& targets)
{
    double sum = 0.0;
    for (const auto& target : targets)
        sum += responseErrorDb(model, target);
    return sum / static_cast<double>(targets.size());
}

}  // namespace excursion
