// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Check/TakeCheck.h"

#include "Engine/Check/Labels.h"
#include "Engine/Check/Overload.h"
#include "Engine/Check/PeriodCheck.h"
#include "Engine/Check/PhysicsCheck.h"
#include "Engine/Check/SoundPath.h"
#include "Engine/Check/WaveformCheck.h"
#include "Engine/Document/Figures.h"
#include "Engine/Error.h"
#include "Engine/Estimate/Welch.h"
#include "Engine/Signal/Level.h"
#include "Engine/Take/Motion.h"

#include <algorithm>

namespace excursion {
namespace {

/// Without periods: a channel that has nothing in common with the input is dead.
bool isCoherent(const Measurement& take, const Channel& channel, std::vector<Problem>& problems)
{
    const Channel& input = take.input();
    if (&channel == &input)
        return true;
    WelchOptions options;
    options.segment = segmentFor(input.samples.size(), 32, 4096);
    if (!options.isValid(input.samples.size()))
        return true;
    const auto spectra = welch(input.samples, channel.samples, take.sampleRate, options);
    double coherent = 0.0, all = 0.0;
    for (std::size_t i = 0; i < spectra.coherence.size(); ++i) {
        coherent += spectra.coherence[i] * spectra.outputPower[i];
        all += spectra.outputPower[i];
    }
    // Pure noise is coherent by 1/n with anything.
    if (!(all > 0.0) || coherent / all > 4.0 / spectra.effectiveAverages)
        return true;
    problems.push_back(
        {"channel-dead", channel.quantity, coherent / all, "", true,
         "The " + std::string(name(channel.quantity))
             + " channel has nothing in common with the input: connect its sensor, or remove the channel."});
    return false;
}

bool followsCone(Quantity q) { return isMotion(q) || q == Quantity::pressure; }

/// Sensors that bend; one that clips is told as that.
void checkOverload(const AveragedPeriods& averages, const std::vector<bool>& alive, std::vector<Problem>& problems)
{
    constexpr double fatalFrom = -50.0;
    const auto& take = averages.take();
    for (std::size_t c = 0; c < take.channels.size(); ++c) {
        const auto quantity = take.channels[c].quantity;
        const bool clips = std::any_of(problems.begin(), problems.end(), [quantity](const Problem& p) {
            return p.kind == "clipping" && p.channel == quantity;
        });
        if (!alive[c] || clips || quantity == take.input().quantity)
            continue;
        std::optional<Overload> overload;
        for (std::size_t other = 0; other < take.channels.size() && !overload; ++other)
            if (other != c && alive[other] && followsCone(quantity) && followsCone(take.channels[other].quantity))
                overload = findOverload(averages, take.channels[c], take.channels[other]);
        const bool mayBeTheMotor = !overload && quantity == Quantity::displacement;
        const bool inputLives = alive[static_cast<std::size_t>(&take.input() - take.channels.data())];
        if (!overload && inputLives)  // the other channel may be too noisy to tell
            overload = findOverload(averages, take.channels[c], take.input());
        if (overload)
            problems.push_back(
                {"overload", quantity, overload->compression, "dB", overload->db > fatalFrom && !mayBeTheMotor,
                 "The " + std::string(name(quantity)) + " channel bends at level " + std::to_string(overload->level)
                     + ": its largest values come out " + figure(overload->compression) + " dB too small, by "
                     + figure(overload->db, "%.0f")
                     + " dB of distortion that is a function of its own value alone; use a larger range or play more "
                       "quietly."
                     + (mayBeTheMotor ? " A force factor that falls on one side looks much the same." : "")});
    }
}

/// A channel that drifts, breaks or hums does not repeat either and seems unsettled: only the cause is told.
void dropConsequences(CheckReport& report)
{
    auto& problems = report.problems;
    const auto sizeOf = [&](const Problem& jump) {  // dB of the channel's signal
        for (const auto& figures : report.channels)
            if (figures.quantity == jump.channel)
                return decibelsOf(jump.value * jump.value / (figures.rms * figures.rms));
        return -300.0;
    };
    const auto causes = problems;
    std::erase_if(problems, [&](const Problem& p) {
        if (p.kind != "not-settled" && p.kind != "poor-repeatability" && p.kind != "low-snr" && p.kind != "hum")
            return false;
        return std::any_of(causes.begin(), causes.end(), [&](const Problem& cause) {
            if (cause.kind == "rest-jump")  // it shows in every channel that answers
                return p.kind == "low-snr" || (p.kind != "hum" && p.value < sizeOf(cause));
            return (cause.kind == "clock-drift" || cause.kind == "dropout" || cause.kind == "gain-jump"
                    || (cause.kind == "hum" && p.kind != "hum"))
                   && cause.fatal && (!cause.channel || cause.channel == p.channel);
        });
    });
}

void addAssumptions(const std::vector<std::string>& remarks, std::vector<Problem>& problems)
{
    for (const auto& remark : remarks)
        problems.push_back({"assumption", std::nullopt, 0.0, "", false, remark});
}

}  // namespace

CheckReport check(const AveragedPeriods& averages)
{
    const auto& take = averages.take();
    take.input();  // throws when there is none
    if (take.length() == 0)
        throw Error(Error::Kind::data, "The take has no samples.");
    CheckReport report;
    report.channels.resize(take.channels.size());
    auto& problems = report.problems;

    std::vector<bool> alive;
    for (std::size_t c = 0; c < take.channels.size(); ++c)
        alive.push_back(checkWaveform(averages, take.channels[c], report.channels[c], problems));

    if (take.input().assumed)
        problems.push_back({"assumption", take.input().quantity, 0.0, "", false,
                            "The " + std::string(name(take.input().quantity))
                                + " was not measured but is what was meant to be played: what the amplifier adds will "
                                  "be taken for the loudspeaker's, and levels "
                                  "are as right as the gain that was given."});

    if (take.excitation && take.excitation->lines.empty() && take.excitation->settlePeriods > 0
        && take.excitation->totalSamples() <= static_cast<long>(take.length()))
        problems.push_back({"excitation", take.input().quantity, static_cast<double>(take.excitation->period),
                            "samples", true,
                            "The take states a period of " + std::to_string(take.excitation->period)
                                + " samples, but nothing repeats in the " + std::string(name(take.input().quantity))
                                + ": correct the excitation in measurement.json, or leave it out for a signal that "
                                  "does not repeat."});

    const bool described = take.hasPeriods() && take.excitation->period > 1;
    const long missing = described ? take.excitation->totalSamples() - static_cast<long>(take.length()) : 0;
    if (missing > 0) {
        problems.push_back({"dropout", std::nullopt, static_cast<double>(missing), "samples", true,
                            "The record is " + std::to_string(missing)
                                + " samples shorter than its excitation: it was stopped early or samples were lost; "
                                  "record again."});
    } else {
        for (std::size_t c = 0; c < take.channels.size(); ++c)
            if (alive[c])
                alive[c] = described && take.excitation->periods > 1
                               ? checkPeriods(averages, take.channels[c], report.channels[c], problems)
                               : isCoherent(take, take.channels[c], problems);
        bool labelled = true;
        if (described) {
            checkClocks(averages, alive, report.channels, problems);
            labelled = checkLabels(take, alive, problems);
            if (labelled)
                checkOverload(averages, alive, problems);
        }

        dropConsequences(report);

        // On a channel that drifts a delay has no meaning.
        auto judgeable = alive;
        for (std::size_t c = 0; c < take.channels.size(); ++c)
            for (const auto& p : problems)
                if (p.kind == "clock-drift" && p.fatal && p.channel == take.channels[c].quantity)
                    judgeable[c] = false;
        if (labelled)
            checkPhysics(averages, judgeable, report.channels, problems);
        if (labelled && report.fitForUse())
            checkSoundPath(averages, alive, report);
    }
    std::stable_sort(problems.begin(), problems.end(),
                     [](const Problem& a, const Problem& b) { return a.fatal && !b.fatal; });
    addAssumptions(take.remarks, problems);
    return report;
}

CheckReport check(const Measurement& take) { return check(AveragedPeriods(take)); }

CheckReport check(const Spectra& spectra)
{
    CheckReport report;
    addAssumptions(spectra.remarks, report.problems);
    return report;
}

}  // namespace excursion
