// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/FitResponse.h"

#include "Engine/Loudspeaker/PistonBand.h"
#include "Engine/Loudspeaker/SmallSignal.h"
#include "Engine/Numerics/Median.h"
#include "Engine/Signal/Level.h"
#include "Engine/Take/Motion.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

using Complex = std::complex<double>;

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

}  // namespace

ResponseTarget thinned(const ResponseTarget& dense, int pointsPerOctave)
{
    ResponseTarget thin;
    thin.quantity = dense.quantity;
    thin.impedance = dense.impedance;
    thin.delayPeriod = dense.delayPeriod;
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
