// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Check/PeriodCheck.h"

#include "Engine/Check/Hum.h"
#include "Engine/Check/PeriodShift.h"
#include "Engine/Document/Engineering.h"
#include "Engine/Signal/Level.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace excursion {
namespace {

/// Powers of one period of one channel at one level, on each line.
struct Powers {
    std::vector<double> mean;   ///< |Ybar|^2 over realizations, all lines
    std::vector<double> noise;  ///< of one period
};

Powers powersOf(const AveragedPeriods& averages, const Channel& channel, int level)
{
    const Excitation& e = averages.excitation();
    Powers powers;
    powers.mean.assign(static_cast<std::size_t>(e.period / 2 + 1), 0.0);
    powers.noise = powers.mean;
    for (int m = 0; m < e.realizations; ++m) {
        const auto& averaged = averages.spectrum(channel, level, m);
        for (std::size_t k = 0; k < powers.mean.size(); ++k) {
            powers.mean[k] += std::norm(averaged.mean[k]) / e.realizations;
            if (e.periods > 1)
                powers.noise[k] += averaged.variance[k] * e.periods / e.realizations;
        }
    }
    return powers;
}

struct SignalAndNoise {
    double signal = 0.0, noise = 0.0;
    /// Not below -20 dB, where the estimate of the signal is noise itself.
    double db() const { return decibelsOf(std::max(signal, 0.01 * noise) / std::max(noise, 1e-30 * signal)); }
};

SignalAndNoise between(const Powers& powers, const std::vector<int>& lines, int periods, int low, int high)
{
    SignalAndNoise result;
    for (const int k : lines)
        if (k >= low && k <= high)
            result.signal += powers.mean[static_cast<std::size_t>(k)]
                             - powers.noise[static_cast<std::size_t>(k)] / periods;
    for (int k = low; k <= high; ++k)
        result.noise += powers.noise[static_cast<std::size_t>(k)];
    return result;
}

/// Power by which the first used period differs from the later ones beyond what noise explains, over the signal's.
/// Needs three periods: with two, settling and noise look the same.
std::optional<double> settling(const AveragedPeriods& averages, const Channel& channel, int level)
{
    const Excitation& e = averages.excitation();
    if (e.periods < 3)
        return std::nullopt;
    double difference = 0.0, expected = 0.0, signal = 0.0;
    const double later = e.periods - 1.0;
    for (int m = 0; m < e.realizations; ++m) {
        const auto spectra = periodSpectra(averages.take(), channel, level, m);
        for (std::size_t k = 1; k < spectra.front().size(); ++k) {
            std::complex<double> mean = 0.0;
            for (std::size_t p = 1; p < spectra.size(); ++p)
                mean += spectra[p][k] / later;
            double scatter = 0.0;
            for (std::size_t p = 1; p < spectra.size(); ++p)
                scatter += std::norm(spectra[p][k] - mean) / (later - 1.0);
            difference += std::norm(spectra.front()[k] - mean);
            expected += scatter * (1.0 + 1.0 / later);
            signal += std::norm(mean);
        }
    }
    const double excess = difference - expected;
    if (excess < 0.5 * expected || !(signal > 0.0))
        return -300.0;
    return decibelsOf(excess / signal);
}

/// Whether a change of gain makes a fair part of a jump.
bool isOfGain(const PeriodJump& jump)
{
    constexpr double fair = 0.25;  // of the power
    return std::pow(std::pow(10.0, jump.gainDb / 20.0) - 1.0, 2) > fair * std::pow(10.0, jump.db / 10.0);
}

}  // namespace

std::optional<double> signalToNoise(const AveragedPeriods& averages, const Channel& channel, int level)
{
    const Excitation& e = averages.excitation();
    const auto& lines = averages.lines();
    if (e.periods < 2)
        return std::nullopt;
    return between(powersOf(averages, channel, level), lines, e.periods, lines.front(), lines.back()).db();
}

bool checkPeriods(const AveragedPeriods& averages, const Channel& channel, ChannelFigures& figures,
                  std::vector<Problem>& problems)
{
    const auto& take = averages.take();
    const Excitation& e = averages.excitation();
    const auto& lines = averages.lines();
    const std::string who(name(channel.quantity));
    const int loudest = e.loudest();
    if (e.periods < 2)
        return true;

    const auto powers = powersOf(averages, channel, loudest);
    double mean = 0.0, noise = 0.0;
    for (const int k : lines) {
        mean += powers.mean[static_cast<std::size_t>(k)];
        noise += powers.noise[static_cast<std::size_t>(k)] / e.periods;
    }
    const double snr = between(powers, lines, e.periods, lines.front(), lines.back()).db();
    figures.snrDb = snr;
    // Noise alone gives mean = noise within a few percent.
    if (mean < 3.0 * noise) {
        problems.push_back(
            {"channel-dead", channel.quantity, snr, "dB", true,
             "The " + who + " channel holds nothing but noise: connect its sensor, or remove the channel."});
        return false;
    }
    const double spacing = take.sampleRate / e.period;
    for (double low = 15.625; low < lines.back() * spacing; low *= 2.0) {
        const int from = std::max(lines.front(), static_cast<int>(std::ceil(low / spacing)));
        const int to = std::min(lines.back(), static_cast<int>(std::ceil(2.0 * low / spacing)) - 1);
        const auto first = std::lower_bound(lines.begin(), lines.end(), from);
        if (first != lines.end() && *first <= to)
            figures.bands.push_back({low, 2.0 * low, between(powers, lines, e.periods, from, to).db()});
    }
    if (snr < 20.0)
        problems.push_back({"low-snr", channel.quantity, snr, "dB", false,
                            "The " + who + " channel has only " + plainText(snr, 0)
                                + " dB of signal to noise at the loudest level; play louder or average more periods."});

    // Above the band and its products a sensor may hiss as it likes: nothing is compared there.
    const auto end = std::min(powers.mean.size(), 2 * static_cast<std::size_t>(lines.back()) + 1);
    double all = 0.0, scatter = 0.0;
    for (std::size_t k = 1; k < end; ++k) {
        all += powers.mean[k];
        scatter += powers.noise[k];
    }
    figures.repeatabilityDb = decibelsOf(scatter / all);
    if (*figures.repeatabilityDb > -20.0)
        problems.push_back(
            {"poor-repeatability", channel.quantity, *figures.repeatabilityDb, "dB", *figures.repeatabilityDb > -6.0,
             "The periods of the " + who + " channel scatter by " + plainText(*figures.repeatabilityDb, 0)
                 + " dB of the signal; look for a loose contact, wind or a neighbour's noise."});

    figures.settlingDb = settling(averages, channel, loudest);
    if (figures.settlingDb && *figures.settlingDb > -60.0)
        problems.push_back({"not-settled", channel.quantity, *figures.settlingDb, "dB",
                            *figures.settlingDb > -20.0 && changedShare(averages, channel, loudest) < changedFrom,
                            "The " + who + " channel has not settled in its first used period, by "
                                + plainText(*figures.settlingDb, 0)
                                + " dB of the signal; play one more settling period."});

    if (const auto hum = findHum(averages, channel))
        problems.push_back({"hum", channel.quantity, hum->db, "dB", hum->db > -40.0 && hum->aboveNoise > 6.0,
                            "The " + who + " channel hums at " + plainText(hum->mains, 0) + " Hz and harmonics, "
                                + plainText(hum->db, 0)
                                + " dB of its signal; break the ground loop or shield the cable."});
    return true;
}

void checkClocks(const AveragedPeriods& averages, const std::vector<bool>& alive, std::vector<ChannelFigures>& figures,
                 std::vector<Problem>& problems)
{
    const auto& take = averages.take();
    const Excitation& e = averages.excitation();
    const int top = averages.lines().back();
    const int loudest = e.loudest();
    struct Drift {
        std::size_t channel;
        PeriodShift shift;
        bool drifts;
    };
    std::vector<Drift> judged;
    std::vector<std::pair<std::size_t, PeriodJump>> jumps;
    for (std::size_t c = 0; c < take.channels.size(); ++c) {
        if (!alive[c])
            continue;
        for (const auto& jump : periodJumps(averages, take.channels[c]))
            jumps.emplace_back(c, jump);
        const auto shift = periodShift(averages, take.channels[c], loudest);
        // A channel that cannot tell 50 ppm has no say.
        if (!shift || shift->standardError * 1e6 / e.period > 50.0)
            continue;
        const double ppm = shift->samples * 1e6 / e.period;
        if (shift->steady)
            figures[c].driftPpm = ppm;
        judged.push_back({c, *shift,
                          std::abs(ppm) > 0.5 && std::abs(shift->samples) > 6.0 * shift->standardError
                              && shift->explained > 0.6 && shift->steady});
    }

    // Samples that are lost break the other channels as much; of a rest that moves they show how the cone swings in.
    const auto sameTime = [](const PeriodJump& a, const PeriodJump& b) {
        return a.level == b.level && a.realization == b.realization && std::abs(a.period - b.period) <= 1;
    };
    constexpr double asMuch = 10.0;  // dB
    std::vector<std::pair<std::size_t, PeriodJump>> rests;
    for (const auto& own : jumps)
        if (own.second.moved != 0.0 && std::none_of(jumps.begin(), jumps.end(), [&](const auto& other) {
                const auto& [c, jump] = other;
                const auto quantity = take.channels[c].quantity;
                return c != own.first && sameTime(jump, own.second)
                       && (quantity == Quantity::voltage || quantity == Quantity::force
                           || jump.db > own.second.db - asMuch);
            }))
            rests.push_back(own);
    if (!rests.empty()) {
        const auto& [c, jump] = *std::max_element(
            rests.begin(), rests.end(), [](const auto& a, const auto& b) { return a.second.moved < b.second.moved; });
        const auto& unit = take.channels[c].unit;
        problems.push_back({"rest-jump", take.channels[c].quantity, jump.moved, unit, false,
                            "The rest position of the cone jumps by " + nominal(jump.moved, unit) + " at level "
                                + std::to_string(jump.level) + ", realization " + std::to_string(jump.realization)
                                + ", around used period " + std::to_string(jump.period)
                                + ": the suspension snaps over, or the sensor was knocked."});
    }
    std::erase_if(jumps, [&](const auto& jump) {
        return std::any_of(rests.begin(), rests.end(),
                           [&](const auto& rest) { return sameTime(rest.second, jump.second); });
    });

    // A system that changes shows in every channel that answers; one channel by itself has changed its gain.
    const auto withoutCompany = [&](const std::pair<std::size_t, PeriodJump>& own) {
        return std::count(alive.begin(), alive.end(), true) > 2
               && std::none_of(jumps.begin(), jumps.end(), [&own](const auto& other) {
                      return other.first != own.first && other.second.change && other.second.level == own.second.level
                             && other.second.realization == own.second.realization
                             && std::abs(other.second.period - own.second.period) <= 1;
                  });
    };
    std::map<std::size_t, PeriodJump> worstOf;  // of each channel
    for (const auto& own : jumps)
        if (own.second.change && withoutCompany(own))
            if (const auto [known, isFirst] = worstOf.insert(own); !isFirst && own.second.db > known->second.db)
                known->second = own.second;
    for (const auto& [c, jump] : worstOf) {
        const auto quantity = take.channels[c].quantity;
        const std::string who(name(quantity)), place = "level " + std::to_string(jump.level) + ", realization "
                                                       + std::to_string(jump.realization) + ", after used period "
                                                       + std::to_string(jump.period);
        problems.push_back(
            {"gain-jump", quantity, isOfGain(jump) ? jump.gainDb : jump.db, "dB", jump.db > -30.0,
             isOfGain(jump)
                 ? "The gain of the " + who + " channel jumps by " + plainText(jump.gainDb, 2) + " dB at " + place
                       + ": look for a loose contact, an automatic gain or a switched range; record again."
                 : "At " + place + ", what changes in the " + who + " channel is " + plainText(-jump.db, 0)
                       + " dB below its signal, and its gain stays: the sensor, or what it sees, has "
                         "moved; record again."});
    }
    std::erase_if(jumps, [](const auto& jump) { return jump.second.change; });

    // What all jump over together is the recorder's; it is told once.
    if (!jumps.empty()) {
        const auto worst = *std::max_element(jumps.begin(), jumps.end(),
                                             [](const auto& a, const auto& b) { return a.second.db < b.second.db; });
        std::vector<std::size_t> who;
        for (const auto& [c, jump] : jumps)
            if (std::find(who.begin(), who.end(), c) == who.end())
                who.push_back(c);
        const bool common = who.size() > 1 && who.size() >= judged.size();
        for (const auto c : who) {
            const auto own = *std::max_element(jumps.begin(), jumps.end(), [c](const auto& a, const auto& b) {
                return (a.first == c ? a.second.db : -1e9) < (b.first == c ? b.second.db : -1e9);
            });
            const auto& jump = (common ? worst : own).second;
            const auto quantity = take.channels[c].quantity;
            problems.push_back(
                {"dropout", common ? std::nullopt : std::optional(quantity), jump.db, "dB", jump.db > -30.0,
                 (common ? std::string("All channels break") : "The " + std::string(name(quantity)) + " channel breaks")
                     + " the period at level " + std::to_string(jump.level) + ", realization "
                     + std::to_string(jump.realization) + ", after used period " + std::to_string(jump.period) + ", by "
                     + plainText(jump.db, 0) + " dB: samples were lost or something knocked; record again."});
            if (common)
                break;
        }
    }

    // All drift together when every channel, to its own accuracy, runs as those do that drift for certain.
    double shared = 0.0, weights = 0.0;
    std::size_t drifting = 0;
    for (const auto& drift : judged)
        if (drift.drifts) {
            const double weight = 1.0 / (drift.shift.standardError * drift.shift.standardError);
            shared += weight * drift.shift.samples;
            weights += weight;
            ++drifting;
        }
    shared /= std::max(weights, 1e-300);
    const bool common = drifting > 1 && std::all_of(judged.begin(), judged.end(), [shared](const Drift& d) {
                            return !d.shift.steady
                                   || std::abs(d.shift.samples - shared)
                                          < 6.0 * d.shift.standardError + 0.1 * std::abs(shared);
                        });
    for (const auto& drift : judged) {
        if (!drift.drifts)
            continue;
        const auto quantity = take.channels[drift.channel].quantity;
        const double ppm = drift.shift.samples * 1e6 / e.period;
        const double turned = std::abs(drift.shift.samples) * e.periods * 2.0 * std::numbers::pi * top / e.period;
        problems.push_back(
            {"clock-drift", common ? std::nullopt : std::optional(quantity), ppm, "ppm", turned > 0.02,
             (common ? std::string("All channels run") : "The " + std::string(name(quantity)) + " channel runs")
                 + " against the excitation by " + plainText(ppm, 1)
                 + " ppm: player and recorder are on different clocks; use one device or lock their clocks."});
        if (common)
            break;
    }
}

}  // namespace excursion
