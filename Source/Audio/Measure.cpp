// SPDX-License-Identifier: GPL-3.0-or-later
#include "Audio/Measure.h"

#include "Engine/Document/Figures.h"
#include "Engine/Error.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

namespace excursion::audio {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto pollEvery = std::chrono::milliseconds(10);
constexpr double stopPatience = 0.5;  // s for the fade, beside the latency
constexpr double leastSweeps = 10.0;  // of a rise: 4 dB from one to the next
constexpr double leastCycles = 8.0;   // of its lowest note while a quick sweep rises by a factor of e
constexpr auto reportEvery = std::chrono::milliseconds(100);

std::string inputText(const WatchedInput& watched)
{
    return "input " + std::to_string(watched.input + 1) + " ("
           + (watched.quantity ? std::string(name(*watched.quantity)) : std::string("loopback")) + ")";
}

/// "at 3.2 s of the rise, 6.1 dB below full level".
std::string momentOf(const Ending& ending)
{
    const auto seconds = figure(ending.seconds, "%.1f");
    switch (ending.stage) {
    case Stage::listening: return "in silence, before anything was played";
    case Stage::rising:
        return ending.gain < 1.0 ? "in the rise, " + figure(-20.0 * std::log10(ending.gain)) + " dB below full level"
                                 : std::string("at the end of the rise, at full level");
    case Stage::playing: return "at " + seconds + " s of the plan";
    case Stage::trailing: return "after the plan had been played";
    default: return "in silence, before the plan was played";
    }
}

/// One run of the procedure. Only a device that answers is stopped, others are left to themselves.
class Run {
public:
    Run(Stream& stream, Procedure& procedure) : stream_(stream), procedure_(procedure) { stream_.start(procedure_); }
    ~Run()
    {
        if (open_)
            stream_.abandon();
    }
    Run(const Run&) = delete;
    Run& operator=(const Run&) = delete;

    /// @return false when the device is gone
    bool wait(const MeasureOptions& options, int attempt, std::vector<std::vector<float>>& channels)
    {
        const auto begun = Clock::now();
        auto moved = begun, reported = begun - reportEvery;
        auto frames = procedure_.frames();
        double patience = options.patience;
        bool stopped = false;
        while (!procedure_.ended()) {
            std::this_thread::sleep_for(pollEvery);
            procedure_.readRecorded(channels);
            const auto now = Clock::now();
            if (const auto present = procedure_.frames(); present != frames) {
                frames = present;
                moved = now;
            }
            if (!stopped && options.stop.stop_requested()) {
                stopped = true;
                procedure_.stop();
                patience = std::min(patience, stopPatience + 2.0 * options.stream.latency);
                moved = now;
            }
            if (!procedure_.ended() && (!stream_.running() || now - moved > std::chrono::duration<double>(patience)))
                return false;
            if (options.report && now - reported >= reportEvery) {
                reported = now;
                Status status {procedure_.stage(),
                               procedure_.fraction(),
                               std::chrono::duration<double>(now - begun).count(),
                               attempt,
                               {}};
                for (std::size_t k = 0; k < procedure_.options().inputs.size(); ++k)
                    status.meters.push_back(procedure_.meter(k));
                options.report(status);
            }
        }
        procedure_.readRecorded(channels);
        open_ = false;
        stream_.stop();
        return true;
    }

private:
    Stream& stream_;
    Procedure& procedure_;
    bool open_ = true;
};

}  // namespace

std::string sentenceOf(const Ending& ending, const ProcedureOptions& options)
{
    const auto& watched = options.inputs[std::min(ending.watched, options.inputs.size() - 1)];
    switch (ending.kind) {
    case Ending::Kind::limit: {
        const auto quantity = std::string(name(watched.quantity.value()));
        const auto unit = std::string(siUnit(*watched.quantity));
        return "The " + quantity + " reached " + figure(ending.value, "%.4g") + " " + unit + " " + momentOf(ending)
               + ", beyond its limit of " + figure(watched.limit.value(), "%.4g") + " " + unit
               + "; take lower levels or another limit.";
    }
    case Ending::Kind::clipping:
        return "The " + inputText(watched) + " clips " + momentOf(ending)
               + "; lower the gain of that input, or the levels of the plan.";
    case Ending::Kind::unheard:
        return "Nothing of what is played arrives at the inputs, though the rise has come to "
               + figure(-20.0 * std::log10(std::max(ending.gain, 1e-9)))
               + " dB below full level: look at the amplifier, the cables, and which output and inputs are used.";
    case Ending::Kind::unseen:
        if (ending.stage == Stage::playing)
            return "The " + inputText(watched) + " has a limit and fell silent " + momentOf(ending)
                   + ": look at its sensor and cable.";
        return "The " + inputText(watched)
               + " has a limit and does not answer what is played, though the rise has come to "
               + figure(-20.0 * std::log10(std::max(ending.gain, 1e-9)))
               + " dB below full level: look at its sensor and cable, or take the limit off.";
    case Ending::Kind::noInput: return "The inputs of the device gave nothing, " + momentOf(ending) + ".";
    case Ending::Kind::frozen:
        return "No input has moved any more from " + figure(ending.seconds, "%.1f")
               + " s of the plan on: the device has lost its connection, or its cables have.";
    case Ending::Kind::broken: return "Samples were lost " + momentOf(ending) + " (xrun).";
    case Ending::Kind::overrun:
        return "The computer did not take the recorded samples away in time, " + momentOf(ending) + ".";
    case Ending::Kind::complete:
    case Ending::Kind::stopped: break;
    }
    return "";
}

ProcedureOptions procedureFor(const Measurement& plan, const std::optional<SweepExcitation>& sweep, double fullScale)
{
    ProcedureOptions options;
    options.sampleRate = plan.sampleRate;
    const auto& volts = plan.input().samples;
    const auto played = [fullScale](double v) { return static_cast<float>(v / fullScale); };
    std::transform(volts.begin(), volts.end(), std::back_inserter(options.sound), played);
    const auto loudest = std::max_element(volts.begin(), volts.end(),
                                          [](double a, double b) { return std::abs(a) < std::abs(b); });
    const double peak = loudest != volts.end() ? std::abs(*loudest) : 0.0;
    if (!(peak <= fullScale) || !(peak > 0.0))
        throw Error(Error::Kind::data, "The plan peaks at " + figure(peak / fullScale, "%.4g")
                                           + " of the output's full scale; what can be played has more than 0 and at "
                                             "most 1.");
    if (sweep) {
        auto quick = *sweep;
        // slow enough for a resonance to build up, with fades that hide no more of the band than the plan's do
        quick.seconds = std::min(quick.seconds, leastCycles * std::log(quick.bandHigh / quick.bandLow) / quick.bandLow);
        const double share = quick.seconds / sweep->seconds;
        quick.fadeIn *= share;
        quick.fadeOut *= share;
        const auto once = quick.sweep(plan.sampleRate, quick.levels.size() - 1).samples();
        std::transform(once.begin(), once.end(), std::back_inserter(options.loudest), played);
        options.rise = std::max(options.rise, leastSweeps * static_cast<double>(once.size()) / plan.sampleRate);
    } else {
        const auto period = std::min(volts.size(), static_cast<std::size_t>(plan.excitation.value().period));
        const auto place = static_cast<std::size_t>(loudest - volts.begin()) / period * period,
                   begin = std::min(place, volts.size() - period);
        options.loudest.assign(options.sound.begin() + static_cast<std::ptrdiff_t>(begin),
                               options.sound.begin() + static_cast<std::ptrdiff_t>(begin + period));
        options.repeats = true;
    }
    return options;
}

Measured measure(System& system, const Device& device, const MeasureOptions& options)
{
    Measured result;
    std::string lost;
    bool risen = false;  // the limits have been met, or not
    std::vector<double> heard;
    for (int attempt = 1;; ++attempt) {
        if (attempt > options.attempts)
            throw Error(Error::Kind::input,
                        lost + " It was so in " + std::to_string(options.attempts)
                            + " attempts: close other programs, or let the device have more latency.");
        auto procedureOptions = options.procedure;
        if (risen) {
            procedureOptions.rise = 0.0;
            procedureOptions.heard = heard;
        }
        constexpr double converters = 0.5;  // s, beside the device's latency, either way
        procedureOptions.latency = std::max(procedureOptions.latency, 2.0 * options.stream.latency + converters);
        auto streamOptions = options.stream;
        streamOptions.sampleRate = procedureOptions.sampleRate;
        streamOptions.inputs = procedureOptions.recorded;
        streamOptions.outputs = 1 + *std::max_element(procedureOptions.outputs.begin(), procedureOptions.outputs.end());
        Procedure procedure(procedureOptions);
        const auto stream = system.open(device, streamOptions);
        result.channels.assign(static_cast<std::size_t>(procedureOptions.recorded), {});
        const auto expected = procedureOptions.sound.size()
                              + static_cast<std::size_t>((procedureOptions.pause + procedureOptions.tail + 0.1)
                                                         * procedureOptions.sampleRate);
        for (auto& channel : result.channels)
            channel.reserve(expected);
        Run run(*stream, procedure);
        const bool there = run.wait(options, attempt, result.channels);
        if (options.stop.stop_requested() && !(there && procedure.ending().kind == Ending::Kind::complete))
            throw Error(Error::Kind::cancelled, there ? "The measurement was stopped; nothing was written."
                                                      : "The measurement was stopped, without a fade as '" + device.name
                                                            + "' answers no longer; nothing was written.");
        if (!there)
            throw Error(Error::Kind::input, "'" + device.name + "' is gone: it was "
                                                + std::string(name(procedure.stage()))
                                                + " and delivers no sound any more. Nothing was written; connect it "
                                                  "again and repeat the measurement.");
        const auto& ending = procedure.ending();
        for (std::size_t k = 0; !risen && isRecorded(ending.stage) && k < procedure.heard().size(); ++k)
            if (procedure.heard()[k] < 1.1)
                result.remarks.push_back("The " + inputText(procedureOptions.inputs[k])
                                         + " is no louder at full level than in silence: is it connected?");
        if (ending.kind == Ending::Kind::broken || ending.kind == Ending::Kind::overrun
            || ending.kind == Ending::Kind::noInput) {
            lost = sentenceOf(ending, procedureOptions);
            if (!risen && isRecorded(ending.stage)) {
                risen = true;
                heard = procedure.heard();
            }
            result.remarks.push_back(lost + " All of it was played again.");
            continue;
        }
        if (ending.kind != Ending::Kind::complete)
            throw Error(ending.kind == Ending::Kind::frozen ? Error::Kind::input : Error::Kind::data,
                        sentenceOf(ending, procedureOptions));
        result.attempts = attempt;
        return result;
    }
}

}  // namespace excursion::audio
