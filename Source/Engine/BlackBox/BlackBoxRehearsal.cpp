// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/BlackBox/BlackBoxRehearsal.h"

#include "Engine/Document/Engineering.h"
#include "Engine/Error.h"
#include "Engine/Signal/Fft.h"
#include "Engine/Signal/Level.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace excursion {
namespace {

constexpr double worthwhile = 3.0;              // dB
constexpr double nothing = -120.0;              // dB
constexpr double plenty = 40.0, enough = 45.0;  // dB; no model is right to more of its distortion

/// Power without the mean.
double variance(const std::vector<double>& values)
{
    double sum = 0.0, square = 0.0;
    for (const double v : values) {
        sum += v;
        square += v * v;
    }
    const auto n = static_cast<double>(values.size());
    return std::max(square / n - sum * sum / (n * n), 0.0);
}

/// The largest magnitude without the mean.
double reach(const std::vector<double>& values)
{
    double mean = 0.0, most = 0.0;
    for (const double v : values)
        mean += v / static_cast<double>(values.size());
    for (const double v : values)
        most = std::max(most, std::abs(v - mean));
    return most;
}

/// Of a period, in bands of a third of an octave; in units that are the same for signals of one length.
std::vector<double> bandPowers(const std::vector<double>& period, double rate, const std::vector<double>& centres)
{
    const auto lines = fft(period);
    std::vector<double> powers;
    for (const double centre : centres) {
        const double perHz = static_cast<double>(period.size()) / rate;
        const auto from = static_cast<std::size_t>(std::ceil(centre * std::exp2(-1.0 / 6.0) * perHz)),
                   to = static_cast<std::size_t>(std::ceil(centre * std::exp2(1.0 / 6.0) * perHz));
        double sum = 0.0;
        for (std::size_t k = std::max<std::size_t>(from, 1); k < std::min(to, lines.size()); ++k)
            sum += std::norm(lines[k]);
        powers.push_back(sum);
    }
    return powers;
}

}  // namespace

BlackBoxRehearsal rehearse(const BlackBox& box, const Region& region, const Rest& rest,
                           const BlackBoxRehearsalOptions& options, const Progress& progress)
{
    const double rate = box.linear.sampleRate;
    const int period = periodFor(box.stimulus, rate);
    const auto input = playedAs(box.stimulus, rate, period, 3);
    const int lead = period;
    BlackBox plain = box;
    plain.R.setZero();

    // y, or y_r, which is that of the box without q, after the first `from` samples; what is played is as long as
    // wanted.
    const auto played = [&](const BlackBox& which, const std::vector<double>& volts, int from) {
        BlackBoxStep step(which, region);
        std::vector<double> x(step.states(), 0.0), z(step.seen() + 1, 0.0), q(step.combinations(), 0.0), out;
        if (&which == &box) {
            std::copy(rest.x.begin(), rest.x.end(), x.begin());
            std::copy(rest.q.begin(), rest.q.end(), q.begin());
        }
        for (int t = 0; t < from + period; ++t) {
            const double u = volts[static_cast<std::size_t>(t) % volts.size()];
            step.see(x.data(), u, z.data());
            step.combinationsAt(z.data(), u, nullptr, q.data());
            const double y = step.advance(x.data(), u, q.data());
            if (t >= from)
                out.push_back(y);
        }
        return out;
    };
    auto bent = played(box, input, lead);
    const auto straight = played(plain, input, lead);
    const double signal = variance(straight);
    for (std::size_t t = 0; t < bent.size(); ++t)
        bent[t] -= straight[t];
    BlackBoxRehearsal best;
    best.beforeDb = decibelsOf(variance(bent) / signal);
    best.apartBefore = reach(bent) / reach(straight);
    best.afterDb = std::numeric_limits<double>::infinity();
    if (best.beforeDb < nothing)
        throw Error(Error::Kind::data, "This model has no distortion to speak of at the level of its fit: there is "
                                       "nothing to correct.");
    const double gain = std::sqrt(signal / variance(input));
    for (const int preview : {16, 32, 64, 128}) {
        for (double depth = 20.0; depth <= 80.0; depth += 10.0) {
            progress.at(std::min(0.95, (std::log2(preview / 16.0) + (depth - 20.0) / 70.0) / 3.0), "rehearsing");
            const double cost = std::pow(gain * std::pow(10.0, -depth / 20.0), 2);
            const auto control = previewControl(box.linear, box.E, box.F, cost, preview);
            if (!control)
                continue;
            BlackBoxRehearsal trial = best;
            trial.design = {*control, preview, options.passes};
            trial.correction = 0.0;
            BlackBoxLinearizer linearizer(box, region, rest, trial.design);
            std::vector<double> left;
            for (int t = -lead; t < period + linearizer.latency(); ++t) {
                const auto sample = linearizer.step(input[static_cast<std::size_t>((t + lead) % period)]);
                if (t < linearizer.latency())
                    continue;
                left.push_back(sample.residual);
                trial.correction = std::max(trial.correction, std::abs(sample.correction));
            }
            trial.afterDb = decibelsOf(variance(left) / signal);
            if (std::isfinite(trial.afterDb) && trial.correction <= box.stimulus.peak && trial.afterDb < best.afterDb)
                best = trial;
            if (best.gainDb() >= enough)
                break;
        }
        // A longer look ahead costs time and latency, and is tried for what it may bring.
        if (best.gainDb() >= plenty || 2 * preview > options.mostPreview)
            break;
    }
    // What is told is measured: the box plays what was corrected, long enough for the mean of what bends it to settle,
    // which the linearizer counts to none of its own.
    std::vector<double> leftOver;
    if (best.gainDb() >= worthwhile) {
        constexpr int settled = 8;
        BlackBoxLinearizer linearizer(box, region, rest, best.design);
        std::vector<double> corrected;
        for (int t = 0; t < (settled + 1) * period + linearizer.latency(); ++t) {
            const auto sample = linearizer.step(input[static_cast<std::size_t>(t % period)]);
            if (t >= linearizer.latency())
                corrected.push_back(sample.input + sample.correction);
        }
        leftOver = played(box, corrected, settled * period);
        for (std::size_t t = 0; t < leftOver.size(); ++t)
            leftOver[t] -= straight[t];
        best.afterDb = decibelsOf(variance(leftOver) / signal);
        best.apartAfter = reach(leftOver) / reach(straight);
    }
    if (!(best.gainDb() >= worthwhile))
        throw Error(Error::Kind::data,
                    "This model cannot be inverted: at the level of its fit its distortion is "
                        + plainText(best.beforeDb, 1) + " dB, and "
                        + (std::isfinite(best.afterDb) ? plainText(best.afterDb, 1) + " dB would be left."
                                                       : "no correction was found that keeps it in bounds."));
    const auto& bands = box.stimulus.frequency;
    const auto whole = bandPowers(straight, rate, bands), before = bandPowers(bent, rate, bands),
               after = bandPowers(leftOver, rate, bands), heard = bandPowers(input, rate, bands);
    const double perPower = 0.5 * period * static_cast<double>(period);
    for (std::size_t k = 0; k < bands.size(); ++k)
        if (heard[k] > 0.1 * box.stimulus.power[k] * perPower) {  // else no line is in it
            best.frequency.push_back(bands[k]);
            best.before.push_back(decibelsOf(before[k] / whole[k]));
            best.after.push_back(decibelsOf(after[k] / whole[k]));
        }
    return best;
}

}  // namespace excursion
