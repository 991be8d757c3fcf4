// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Estimate/MainsHum.h"

#include "Engine/Estimate/Periods.h"
#include "Engine/Numerics/Median.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

namespace excursion {
namespace {

using Complex = std::complex<double>;

constexpr int harmonics = 6;
constexpr double reach = 0.25;  // Hz

double turnOf(double hertz, double sampleRate) { return 2.0 * std::numbers::pi * hertz / sampleRate; }

/// Whether the periods of all channels can be compared. Where nothing settled the first one is another.
bool repeats(const Measurement& take)
{
    if (!take.excitation)
        return false;
    const auto& e = *take.excitation;
    return e.period > 0 && e.periods > 1 && e.settlePeriods > 0 && e.realizations > 0 && !e.levels.empty()
           && std::all_of(take.channels.begin(), take.channels.end(), [&e](const Channel& channel) {
                  return static_cast<long>(channel.samples.size()) >= e.totalSamples();
              });
}

/// A part of a used period, too short for the phase of what is looked for to get away.
struct Piece {
    double middle, length;  ///< samples, of the take
    int period;             ///< p
    Complex sum;            ///< of what differs from the mean, times exp(-j w n) with the w of the mains
    double weight = 0.0;    ///< that of its section: an inverse mean square around this frequency
};

/// sum_n r(n) exp(-j turn (origin + n))
Complex demodulated(std::span<const double> r, double turn, double origin)
{
    Complex sum = 0.0, phase = std::polar(1.0, -turn * origin);
    const Complex step = std::polar(1.0, -turn);
    for (const double value : r) {
        sum += value * phase;
        phase *= step;
    }
    return sum;
}

/// What the used periods differ by from their mean, one section behind the other.
struct Differences {
    std::vector<double> samples;
    std::vector<std::size_t> begins;  ///< of each section's used periods, in the take
};

Differences differencesOf(const Measurement& take, const Channel& channel)
{
    const auto& e = *take.excitation;
    Differences result;
    for (int level = 0; level < static_cast<int>(e.levels.size()); ++level)
        for (int m = 0; m < e.realizations; ++m) {
            const auto used = usedPeriods(take, channel, level, m);
            const auto mean = averagePeriod(take, channel, level, m);
            result.begins.push_back(static_cast<std::size_t>(used.data() - channel.samples.data()));
            for (std::size_t n = 0; n < used.size(); ++n)
                result.samples.push_back(used[n] - mean[n % mean.size()]);
        }
    return result;
}

std::vector<Piece> piecesOf(const Differences& r, const Excitation& e, double sampleRate, double turn)
{
    constexpr double longest = 0.1;  // s
    const auto N = static_cast<std::size_t>(e.period), P = static_cast<std::size_t>(e.periods);
    const auto parts = static_cast<std::size_t>(std::ceil(static_cast<double>(N) / (longest * sampleRate)));
    std::vector<Piece> pieces;
    for (std::size_t s = 0; s < r.begins.size(); ++s)
        for (std::size_t p = 0; p < P; ++p)
            for (std::size_t k = 0; k < parts; ++k) {
                const std::size_t from = p * N + k * N / parts, length = p * N + (k + 1) * N / parts - from;
                const auto begin = static_cast<double>(r.begins[s] + from);
                const std::span part(r.samples.data() + s * P * N + from, length);
                pieces.push_back({begin + 0.5 * static_cast<double>(length), static_cast<double>(length),
                                  static_cast<int>(p), demodulated(part, turn, begin)});
            }
    // What a loudspeaker scatters grows with the level, and hum does not.
    const std::size_t each = P * parts;
    for (std::size_t s = 0; s < r.begins.size(); ++s) {
        const std::span own(pieces.data() + s * each, each);
        double power = 0.0, length = 0.0;
        for (const auto& piece : own) {
            power += std::norm(piece.sum);
            length += piece.length;
        }
        for (auto& piece : own)
            piece.weight = power > 0.0 ? length / power : 0.0;
    }
    return pieces;
}

struct Sinusoid {
    Complex amplitude;
    double explained = 0.0;  ///< weighted sum of squares
};

/// @param off  radians a sample, beside the w that the pieces were made with
Sinusoid sinusoidAt(const std::vector<Piece>& pieces, const Excitation& e, double turn, double off)
{
    std::vector<Complex> left;  // a_p
    for (int p = 0; p < e.periods; ++p) {
        Complex mean = 0.0;
        for (int other = 0; other < e.periods; ++other)
            mean += std::polar(1.0 / e.periods, (turn + off) * e.period * (other - p));
        left.push_back(1.0 - mean);
    }
    Complex sum = 0.0;
    double weight = 0.0, length = 0.0;
    for (const auto& piece : pieces) {
        const auto a = left[static_cast<std::size_t>(piece.period)];
        sum += piece.weight * std::conj(a) * piece.sum * std::polar(1.0, -off * piece.middle);
        weight += piece.weight * piece.length * std::norm(a);
        length += piece.weight * piece.length;
    }
    constexpr double least = 0.005;  // of the hum; what repeats better is not told
    if (!(weight > least * length))
        return {};
    return {2.0 * sum / weight, 2.0 * std::norm(sum) / weight};
}

/// A sinusoid that may be in a channel, at each frequency that is tried.
struct Trial {
    std::size_t channel;
    double turn, perHertz;  ///< radians a sample, of the mains' harmonic; of a Hz of the mains
    std::vector<Piece> pieces;
    double usual = 0.0;  ///< explained, at the median of some lines beside

    Sinusoid at(const Excitation& e, double hertz) const { return sinusoidAt(pieces, e, turn, perHertz * hertz); }
};

constexpr double standsOut = 8.0;  // times what is usual

/// How many times what is usual is explained by what stands out, `hertz` beside the mains.
double explainedBy(const std::vector<Trial>& trials, const Excitation& e, double hertz)
{
    double sum = 0.0;
    for (const auto& trial : trials)
        if (const double times = trial.at(e, hertz).explained / trial.usual; trial.usual > 0.0 && times > standsOut)
            sum += times;
    return sum;
}

}  // namespace

int takeOffHum(Measurement& take)
{
    if (!repeats(take))
        return 0;
    const auto& e = *take.excitation;
    std::vector<Differences> differences;
    for (const auto& channel : take.channels)
        differences.push_back(differencesOf(take, channel));
    const double width = take.sampleRate / static_cast<double>(take.length());  // Hz, of a line of the whole take
    const double coarse = width / 4.0, fine = width / 64.0;
    constexpr double nearest = 3.0, farthest = 12.0;  // of what is usual, in such lines
    std::vector<Trial> best;
    double at = 0.0, most = 35.0;  // times what is usual, which by chance comes to 25
    for (const double mains : {50.0, 60.0}) {
        std::vector<Trial> trials;
        for (int harmonic = 1; harmonic <= harmonics; ++harmonic)
            for (std::size_t c = 0; c < differences.size(); ++c) {
                const double turn = turnOf(harmonic * mains, take.sampleRate);
                Trial trial {c, turn, turnOf(harmonic, take.sampleRate),
                             piecesOf(differences[c], e, take.sampleRate, turn)};
                std::vector<double> explained;
                for (double lines = nearest; lines <= farthest; lines += 0.5)
                    for (const double side : {-1.0, 1.0})
                        explained.push_back(trial.at(e, side * lines * width / harmonic).explained);
                trial.usual = medianOf(std::move(explained));
                trials.push_back(std::move(trial));
            }
        double highest = 0.0, there = 0.0;
        const auto look = [&](double from, double to, double step) {
            for (double hertz = from; hertz <= to; hertz += step)
                if (const double sum = explainedBy(trials, e, hertz); sum > highest) {
                    highest = sum;
                    there = hertz;
                }
        };
        look(-reach, reach, coarse);
        look(there - coarse, there + coarse, fine);
        if (highest > most) {
            most = highest;
            at = there;
            best = std::move(trials);
        }
    }
    int count = 0;
    for (const auto& trial : best) {
        const auto sinusoid = trial.at(e, at);
        if (!(trial.usual > 0.0) || sinusoid.explained < standsOut * trial.usual)
            continue;
        ++count;
        auto phase = sinusoid.amplitude;
        const Complex step = std::polar(1.0, trial.turn + trial.perHertz * at);
        for (auto& sample : take.channels[trial.channel].samples) {
            sample -= phase.real();
            phase *= step;
        }
    }
    return count;
}

}  // namespace excursion
