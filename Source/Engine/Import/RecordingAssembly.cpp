// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Import/RecordingAssembly.h"

#include "Engine/Check/Clipping.h"
#include "Engine/Check/TakeCheck.h"
#include "Engine/Document/Figures.h"
#include "Engine/Error.h"
#include "Engine/Signal/Level.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

namespace excursion {
namespace {

constexpr double plainLikeness = 0.97;  // of a response to a gain and a delay, from which on it tells the time

std::string labelOf(const AssignedChannel& a, const std::vector<RecordingSource>& sources)
{
    return "channel " + std::to_string(a.channel + 1) + " of '" + sources[a.file].path.string() + "' ("
           + (a.quantity ? std::string(name(*a.quantity)) : std::string("loopback")) + ")";
}

/// How well a channel tells the time of what was played: the less lies between, the better.
int trust(const AssignedChannel& a)
{
    if (!a.quantity)
        return 0;
    static constexpr Quantity order[] {Quantity::voltage,     Quantity::current,  Quantity::acceleration,
                                       Quantity::pressure,    Quantity::velocity, Quantity::force,
                                       Quantity::displacement};
    return 1 + static_cast<int>(std::find(std::begin(order), std::end(order), *a.quantity) - std::begin(order));
}

/// Samples that were clipped cannot be seen as such once they are resampled.
void requireUnclipped(const AssignedChannel& a, const std::vector<RecordingSource>& sources, double begin, double end)
{
    const auto& x = sources[a.file].sound.channels[a.channel];
    const auto size = static_cast<double>(x.size());
    Channel part;
    part.samples.assign(x.begin() + static_cast<std::ptrdiff_t>(std::clamp(begin, 0.0, size)),
                        x.begin() + static_cast<std::ptrdiff_t>(std::clamp(end, 0.0, size)));
    // A converter's limit shows in single samples, where a top is one or two samples wide; 16 bits end at 0.99997.
    constexpr double limit = 0.9999;
    const auto atLimit = std::count_if(part.samples.begin(), part.samples.end(),
                                       [](double sample) { return std::abs(sample) >= limit; });
    const bool beyond = std::any_of(part.samples.begin(), part.samples.end(), [](double sample) {
        return std::abs(sample) > 1.0;
    });  // floats in a unit of their own
    if (const auto clipped = std::max(beyond ? 0L : static_cast<long>(atLimit), clippedSamples(part)); clipped > 0)
        throw Error(Error::Kind::data,
                    labelOf(a, sources) + " clips: " + std::to_string(clipped)
                        + " samples stand at its limit; lower the gain of that input and record again.");
}

double levelOf(const std::vector<double>& x, const Excitation& e, std::size_t level)
{
    const auto N = static_cast<std::size_t>(e.period), block = static_cast<std::size_t>(e.samplesPerRealization());
    double power = 0.0;
    for (std::size_t m = 0; m < static_cast<std::size_t>(e.realizations); ++m) {
        const auto end = (level * static_cast<std::size_t>(e.realizations) + m + 1) * block;
        const auto length = N * static_cast<std::size_t>(e.periods);
        const double rms = rmsOf(std::span(x).subspan(end - length, length));
        power += rms * rms / e.realizations;
    }
    return std::sqrt(power);
}

/// Files on the clock of a plan, one take.
class Assembly {
public:
    Assembly(const RecordingOptions& options, const std::vector<RecordingSource>& sources,
             const std::vector<AssignedChannel>& assigned)
        : options_(options),
          sources_(sources),
          assigned_(assigned),
          plan_(withPeriods(options)),
          periods_(periodsOf(plan_))
    {
        periods_.sweeps = options.sweep.has_value();
    }

    ImportedRecording build(const Progress& progress)
    {
        requireInput(assigned_, options_.gain);
        result_.take.sampleRate = plan_.sampleRate;
        result_.take.excitation = plan_.excitation;
        result_.take.excitation->lines = periods_.lines;
        result_.take.driver = plan_.driver;
        for (std::size_t f = 0; f < sources_.size(); ++f) {
            progress.at(0.6 * static_cast<double>(f) / static_cast<double>(sources_.size()), "looking for the plan");
            align(f);
        }
        shorten();
        result_.take.channels.resize(assigned_.size());
        for (std::size_t f = 0; f < sources_.size(); ++f) {
            progress.at(0.6 + 0.4 * static_cast<double>(f) / static_cast<double>(sources_.size()),
                        "reading on the plan's clock");
            read(f);
        }
        std::erase_if(result_.take.channels, [](const Channel& c) { return c.samples.empty(); });  // loopbacks
        setLevels();
        if (periods_.sweeps)
            describeSweeps();
        return std::move(result_);
    }

private:
    bool recorded(Quantity quantity) const
    {
        return std::any_of(assigned_.begin(), assigned_.end(),
                           [quantity](const AssignedChannel& a) { return a.quantity == quantity; });
    }

    void align(std::size_t file)
    {
        const auto& source = sources_[file];
        std::vector<const AssignedChannel*> own;
        for (const auto& a : assigned_)
            if (a.file == file)
                own.push_back(&a);
        if (own.empty())
            throw Error(Error::Kind::usage, "No channel of '" + source.path.string()
                                                + "' is mapped; leave the file out, or map what it holds.");
        std::stable_sort(own.begin(), own.end(), [](const auto* a, const auto* b) { return trust(*a) < trust(*b); });
        if (!own.front()->quantity)
            own.resize(1);  // a loopback is the time
        std::vector<Witness> witnesses;
        for (const auto* a : own)
            witnesses.push_back({source.sound.channels[a->channel], labelOf(*a, sources_)});
        ImportedFile done;
        done.name = source.path.string();
        done.sampleRate = source.sound.sampleRate;
        done.seconds = static_cast<double>(source.sound.channels.front().size()) / done.sampleRate;
        done.alignment = alignRecording(plan_, periods_, witnesses, done.sampleRate, done.name);
        const auto* witness = own[done.alignment.witness];
        done.witness = witnesses[done.alignment.witness].label;
        const bool hasVoltage = own.front()->quantity == Quantity::voltage;
        if (witness->quantity && !hasVoltage)
            settleTime(*witness, done);
        else if (witness->quantity && done.alignment.likeness < plainLikeness)
            result_.remarks.push_back("Neither the voltage in '" + done.name
                                      + "' nor another channel is much like what was played: its time is that of "
                                      + done.witness + ", as far as its response is that of a delay.");
        else if (witness->quantity && *witness->quantity != Quantity::voltage)
            result_.remarks.push_back(
                done.witness
                + " is more like what was played than the voltage: they may be exchanged, see 'excursion check'.");
        if (witness->latency != 0.0) {  // the file's time was as late as its witness
            auto& clock = done.alignment.clock;
            clock.start -= witness->latency * plan_.sampleRate * clock.step;
            countRealizations(done.alignment, plan_, witnesses.front().samples.size(), done.name);
        }
        if (done.alignment.scatter > 0.05)
            result_.remarks.push_back("The clock of '" + done.name + "' wanders by "
                                      + figure(done.alignment.scatter, "%.2f")
                                      + " samples (rms) about a steady one, which is left in.");
        if (done.alignment.driftUnknown)
            result_.remarks.push_back(
                "One sweep cannot tell a clock's drift from a phase that goes with frequency: '" + done.name
                + "' was taken at its nominal rate. Where player and recorder are not one device, play two levels or "
                  "repeats, which tell it.");
        result_.files.push_back(std::move(done));
    }

    /// The time of a file that was told by what a loudspeaker had passed: what physics allows no loudspeaker to delay,
    /// as `check` has it, is taken off.
    void settleTime(const AssignedChannel& witness, ImportedFile& done)
    {
        auto& alignment = done.alignment;
        const auto& samples = sources_[witness.file].sound.channels[witness.channel];
        Measurement pair;
        pair.sampleRate = plan_.sampleRate;
        const auto excitation = shortened(*result_.take.excitation, alignment.realizations);
        const auto length = static_cast<std::size_t>(excitation.totalSamples());
        if (!periods_.sweeps)
            pair.excitation = excitation;
        const auto& played = plan_.input().samples;
        pair.channels.push_back(
            {Quantity::voltage, "V", 1.0, {played.begin(), played.begin() + static_cast<std::ptrdiff_t>(length)}});
        pair.channels.push_back({*witness.quantity, std::string(siUnit(*witness.quantity)), std::abs(witness.factor),
                                 onPlanClock(samples, alignment.clock, done.sampleRate, plan_.sampleRate, length)});
        for (double& x : pair.channels.back().samples)
            x *= witness.factor;
        const auto delay = check(pair).channels.back().delay;
        const bool clear = delay && delay->clear;
        std::string told = "The time of '" + done.name + "' is that of " + done.witness
                           + ", in which a loudspeaker lies between what was played and what was recorded";
        if (clear) {
            alignment.clock.start += delay->seconds * plan_.sampleRate * alignment.clock.step;
            alignment.startError = std::hypot(alignment.startError, delay->standardError * plan_.sampleRate);
            countRealizations(alignment, plan_, samples.size(), done.name);
            told += "; it was put right by " + figure(delay->seconds * plan_.sampleRate, "%.2f")
                    + " samples, which no loudspeaker can make";
        }
        result_.remarks.push_back(told
                                  + ". Against the voltage its channels may still be late or early by part of a sample"
                                  + (*witness.quantity == Quantity::pressure ? ", and the time of flight is lost" : "")
                                  + ": a loopback or the voltage in the same file would tell.");
    }

    /// What is left of an excitation of which so many realizations are complete.
    static Excitation shortened(Excitation e, std::size_t complete)
    {
        const auto realizations = static_cast<std::size_t>(e.realizations), levels = complete / realizations;
        if (levels == 0) {
            e.levels.resize(1);
            e.realizations = static_cast<int>(complete);
        } else if (levels < e.levels.size()) {
            e.levels.resize(levels);
        }
        return e;
    }

    static Measurement withPeriods(const RecordingOptions& options)
    {
        auto plan = *options.plan;
        if (options.sweep)
            plan.excitation = periodsOfSweeps(*options.sweep, plan.sampleRate);
        return plan;
    }

    /// What is left of the sweeps, and a take that has no periods.
    void describeSweeps()
    {
        result_.sweep = options_.sweep;
        const auto& e = *result_.take.excitation;
        result_.sweep->levels = e.levels;
        result_.sweep->repeats = e.realizations;
        result_.take.excitation.reset();
    }

    /// All files to the end of the one that ends first.
    void shorten()
    {
        auto& e = *result_.take.excitation;
        const auto all = e.levels.size() * static_cast<std::size_t>(e.realizations);
        std::size_t complete = all, shortest = 0;
        for (std::size_t f = 0; f < result_.files.size(); ++f)
            if (result_.files[f].alignment.realizations < complete) {
                complete = result_.files[f].alignment.realizations;
                shortest = f;
            }
        if (complete < all) {
            e = shortened(e, complete);
            result_.remarks.push_back(
                "'" + result_.files[shortest].name + "' ends before the plan does: " + std::to_string(complete) + " of "
                + std::to_string(all) + " realizations are complete, of which the take keeps "
                + std::to_string(e.levels.size()) + " level" + (e.levels.size() == 1 ? "" : "s") + " with "
                + std::to_string(e.realizations) + " realization" + (e.realizations == 1 ? "" : "s") + " each.");
        }
        length_ = static_cast<std::size_t>(e.totalSamples());
        const auto blocks = e.levels.size() * static_cast<std::size_t>(e.realizations);
        for (std::size_t p = 0; p < periods_.periods.size(); ++p)
            if (periods_.periods[p].used && periods_.periods[p].block < blocks)
                used_.push_back(p);
    }

    void read(std::size_t file)
    {
        auto& done = result_.files[file];
        const auto& alignment = done.alignment;
        const auto& sound = sources_[file].sound;
        for (const auto& a : assigned_)
            if (a.file == file && !a.quantity) {
                const auto loop = onPlanClock(sound.channels[a.channel], alignment.clock, sound.sampleRate,
                                              plan_.sampleRate, length_);
                done.loopback = interfaceResponse(periods_, loop, used_, plan_.sampleRate);
            }
        for (std::size_t i = 0; i < assigned_.size(); ++i) {
            const auto& a = assigned_[i];
            if (a.file != file || !a.quantity)
                continue;
            requireUnclipped(a, sources_, alignment.clock.start, alignment.clock.at(static_cast<double>(length_)));
            auto& channel = result_.take.channels[i];
            channel.quantity = *a.quantity;
            channel.unit = siUnit(*a.quantity);
            channel.fullScale = std::abs(a.factor);
            channel.samples = onPlanClock(sound.channels[a.channel], alignment.clock, sound.sampleRate,
                                          plan_.sampleRate, length_, responseOf(a, done));
            const bool toTheEnd = alignment.realizations
                                      * static_cast<std::size_t>(plan_.excitation->samplesPerRealization())
                                  == length_;
            if (toTheEnd && !periods_.sweeps)  // the steady state of the period before
                for (auto n = length_ - std::min(alignment.missing, length_); n < length_; ++n)
                    channel.samples[n] = channel.samples[n - periods_.length];
            for (double& x : channel.samples)
                x *= a.factor;
        }
    }

    ResponseFunction responseOf(const AssignedChannel& a, const ImportedFile& done) const
    {
        std::vector<ResponseCurve> curves;
        if (done.loopback && done.loopback->curve)
            curves.push_back(*done.loopback->curve);
        if (!a.curve.empty())
            curves.push_back(readMicrophoneCurve(a.curve, a.referenceFrequency));
        if (curves.empty() && a.latency == 0.0)
            return {};
        return [curves, latency = a.latency](double frequency) {
            auto product = std::polar(1.0, -2.0 * std::numbers::pi * frequency * latency);
            for (const auto& curve : curves)
                product *= curve(frequency);
            return product;
        };
    }

    void setLevels()
    {
        auto& take = result_.take;
        auto& e = *take.excitation;
        const auto& played = plan_.input();
        if (!recorded(Quantity::voltage)) {
            Channel voltage;
            voltage.fullScale = options_.gain;
            voltage.assumed = true;
            voltage.samples.assign(played.samples.begin(),
                                   played.samples.begin() + static_cast<std::ptrdiff_t>(length_));
            for (double& u : voltage.samples)
                u *= options_.gain / played.fullScale;
            take.channels.insert(take.channels.begin(), std::move(voltage));
            result_.remarks.push_back("The voltage was not recorded: it is the plan's at "
                                      + figure(options_.gain, "%.4g")
                                      + " V for a played sample of 1.0, and marked as assumed.");
        }
        const auto& voltage = take.find(Quantity::voltage)->samples;
        std::vector<double> levels;
        for (std::size_t k = 0; k < e.levels.size(); ++k)
            levels.push_back(periods_.sweeps ? e.levels[k] * levelOf(voltage, e, k) / levelOf(played.samples, e, k)
                                             : levelOf(voltage, e, k));
        const double ratio = levels.back() / e.levels.back();
        if (recorded(Quantity::voltage) && (ratio < 0.98 || ratio > 1.02))
            result_.remarks.push_back("The recorded voltage is " + figure(ratio, "%.3g")
                                      + " times the plan's; the take's levels are what was recorded.");
        const bool ascend = std::adjacent_find(levels.begin(), levels.end(), std::greater_equal<>()) == levels.end();
        if (levels.front() > 0 && ascend)
            e.levels = levels;
    }

    const RecordingOptions& options_;
    const std::vector<RecordingSource>& sources_;
    const std::vector<AssignedChannel>& assigned_;
    Measurement plan_;
    PlanPeriods periods_;
    std::vector<std::size_t> used_;
    std::size_t length_ = 0;
    ImportedRecording result_;
};

}  // namespace

ImportedRecording assembleRecording(const RecordingOptions& options, const std::vector<RecordingSource>& sources,
                                    const std::vector<AssignedChannel>& assigned, const Progress& progress)
{
    return Assembly(options, sources, assigned).build(progress);
}

}  // namespace excursion
