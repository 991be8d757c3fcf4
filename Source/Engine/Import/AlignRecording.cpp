// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Import/AlignRecording.h"

#include "Engine/Document/Figures.h"
#include "Engine/Error.h"
#include "Engine/Import/FindPlan.h"
#include "Engine/Import/PeriodDelays.h"
#include "Engine/Signal/Fft.h"
#include "Engine/Signal/Resample.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace excursion {
namespace {

constexpr double silence = 1e-6;      // rms of full scale
constexpr double lateStart = 8.0;     // samples that the beginning may lack: it settles
constexpr std::size_t earlyEnd = 8;   // and the end: what is periodic tells them
constexpr double mostScatter = 0.25;  // samples rms of the periods about a steady clock
constexpr double leastShare = 0.8;    // of the periods within the recording that must follow the plan
constexpr double leastAnswer = 0.6;   // of the energy of a response to sweeps, in the time of an impulse response

[[noreturn]] void refuse(const std::string& source, const std::string& why)
{
    throw Error(Error::Kind::data, "'" + source + "' " + why);
}

double rmsWithoutMean(std::span<const double> x)
{
    if (x.empty())
        return 0.0;
    const double mean = std::accumulate(x.begin(), x.end(), 0.0) / static_cast<double>(x.size());
    double power = 0.0;
    for (const double v : x)
        power += (v - mean) * (v - mean);
    return std::sqrt(power / static_cast<double>(x.size()));
}

/// One attempt to lay the plan beside a recording.
class Aligner {
public:
    Aligner(const Measurement& plan, const PlanPeriods& periods, const std::vector<Witness>& witnesses, double rate,
            const std::string& source)
        : plan_(plan),
          periods_(periods),
          witnesses_(witnesses),
          rate_(rate),
          ratio_(rate / plan.sampleRate),
          source_(source)
    {
    }

    Alignment align()
    {
        requireBand();
        const auto place = find();
        requireWhole(place);
        result_.clock = {place.start * ratio_, place.step * ratio_};
        countRealizations();
        refine();
        chooseWitness();
        countRealizations();
        if (periods_.sweeps)
            requireAnswer();
        return result_;
    }

private:
    const std::vector<double>& played() const { return plan_.input().samples; }
    double seconds(double planSample) const { return planSample / plan_.sampleRate; }

    void requireBand() const
    {
        const double highest = periods_.lines.back() * plan_.sampleRate / static_cast<double>(periods_.length);
        if (highest > 0.49 * rate_)
            refuse(source_, "is sampled at " + figure(rate_, "%.0f")
                                + " Hz, which cannot hold what the plan plays up to " + frequencyText(highest)
                                + "; record at " + figure(plan_.sampleRate, "%.0f") + " Hz.");
    }

    PlanPlace find()
    {
        bool sound = false;
        PlanPlace best;
        for (std::size_t w = 0; w < witnesses_.size(); ++w) {
            const auto samples = witnesses_[w].samples;
            if (rmsWithoutMean(samples) < silence)
                continue;
            sound = true;
            auto place = ratio_ == 1.0 ? findPlan(played(), periods_, samples)
                                       : findPlan(played(), periods_, resampled(samples, ratio_));
            if (place.found) {
                result_.witness = w;
                return place;
            }
            if (place.seen() > best.seen())
                best = place;
        }
        const auto length = figure(static_cast<double>(witnesses_.front().samples.size()) / rate_, "%.2f");
        if (!sound)
            refuse(source_, "is silent on " + witnesses_.front().label
                                + (witnesses_.size() > 1 ? " and the others" : "")
                                + "; check the cables, the inputs and --map.");
        if (static_cast<double>(witnesses_.front().samples.size()) / ratio_ < static_cast<double>(periods_.length))
            refuse(source_, "is only " + length + " s long, less than one " + (periods_.sweeps ? "sweep" : "period")
                                + " of the plan; record all of it.");
        refuse(source_, "does not hold the plan: what was played was not found in " + witnesses_.front().label
                            + (witnesses_.size() > 1 ? " nor in the others" : "")
                            + "; check that the plan is the one that was played, and --map.");
    }

    void requireWhole(const PlanPlace& place) const
    {
        for (const auto& s : place.sightings)
            if (s.jump != 0.0)
                gap(s.jump, s.at / plan_.sampleRate);
        if (place.start < -lateStart)
            refuse(source_, "begins " + figure(seconds(-place.start), "%.2f")
                                + " s after the plan does; start the recorder before the player.");
        const auto within = place.inside();
        if (static_cast<double>(place.seen()) < leastShare * static_cast<double>(within)) {
            const auto first = std::find_if(place.sightings.begin(), place.sightings.end(),
                                            [](const Sighting& s) { return s.inside && !s.seen; });
            refuse(source_, "follows the plan in only " + std::to_string(place.seen()) + " of " + std::to_string(within)
                                + (periods_.sweeps ? " sweeps, and not at " : " periods, and not at ")
                                + figure(first->at / plan_.sampleRate, "%.2f")
                                + " s; either the plan is not the one that was played, or something interrupted it.");
        }
    }

    /// Another sweep than the plan's is answered at the wrong times, and so is noise: at all times.
    void requireAnswer() const
    {
        const auto response = delaysOf(result_.witness, false).response;
        std::vector<std::complex<double>> spectrum(periods_.length / 2 + 1);
        for (std::size_t i = 0; i < response.size(); ++i)
            spectrum[static_cast<std::size_t>(periods_.lines[i])] = response[i];
        const auto h = inverseFft(spectrum, periods_.length);
        const auto ahead = periods_.length / 200, behind = periods_.length / 10;
        double inTime = 0.0, all = 0.0;
        for (std::size_t n = 0; n < h.size(); ++n) {
            all += h[n] * h[n];
            inTime += n < behind || n >= h.size() - ahead ? h[n] * h[n] : 0.0;
        }
        if (!(inTime >= leastAnswer * all))
            refuse(source_, "does not answer the plan's sweeps: only " + figure(100.0 * inTime / all, "%.0f") + " % of "
                                + witnesses_[result_.witness].label
                                + " comes when an impulse response would; either another sweep was played, or noise "
                                  "buries it.");
    }

    /// @param jump  samples of the plan by which what comes later is late
    [[noreturn]] void gap(double jump, double recordedSeconds) const
    {
        const double samples = std::abs(jump) * ratio_;
        const auto count = figure(samples, samples < 0.6 ? "%.1f" : "%.0f");
        refuse(source_, (jump < 0 ? "lacks about " : "has about ") + count
                            + (jump < 0 ? " samples near " : " samples too many near ")
                            + figure(recordedSeconds, "%.1f")
                            + " s: a block was lost or repeated while recording; record again with larger buffers.");
    }

    void countRealizations()
    {
        excursion::countRealizations(result_, plan_, witnesses_.front().samples.size(), source_);
    }

    std::size_t samplesRecorded() const
    {
        return result_.realizations * static_cast<std::size_t>(plan_.excitation->samplesPerRealization());
    }

    std::vector<double> read(std::size_t witness) const
    {
        return onPlanClock(witnesses_[witness].samples, result_.clock, rate_, plan_.sampleRate, samplesRecorded());
    }

    PeriodDelays delaysOf(std::size_t witness, bool byLevel) const
    {
        std::vector<std::size_t> used;
        for (std::size_t p = 0; p < periods_.periods.size(); ++p)
            if (periods_.periods[p].used && periods_.periods[p].block < result_.realizations)
                used.push_back(p);
        return periodDelays(periods_, read(witness), used, byLevel,
                            static_cast<std::size_t>(plan_.excitation->realizations));
    }

    void refine()
    {
        const double length = static_cast<double>(samplesRecorded());
        bool byLevel = false;
        ClockFit fit;
        for (int pass = 0; pass < 5; ++pass) {
            const auto delays = delaysOf(result_.witness, byLevel);
            fit = fitClock(delays.periods);
            const bool wasByLevel = byLevel;
            byLevel = delays.likeness < 0.99 && (!periods_.sweeps || plan_.excitation->realizations > 1);
            const double shift = delays.delay + fit.offset;
            result_.clock.start += shift * result_.clock.step;
            result_.clock.step *= 1 + fit.drift;
            result_.startError = std::hypot(delays.delayError, fit.offsetError);
            if (wasByLevel == byLevel && pass > 0 && std::abs(shift) < 1e-3 && std::abs(fit.drift) * length < 1e-3)
                break;
        }
        if (fit.jump != 0.0)
            gap(fit.jump, result_.clock.start / rate_ + seconds(fit.jumpTime));
        if (fit.scatter > mostScatter)
            refuse(source_,
                   "does not run on a steady clock: its periods lie " + figure(fit.scatter, "%.2f")
                       + " samples (rms) off one; samples were lost, or the recorder's clock wanders. Record again.");
        const double drift = result_.clock.step / ratio_ - 1;
        if (periods_.sweeps && result_.realizations < 2) {
            result_.driftUnknown = result_.synchronous = true;
            result_.driftPpm = 0.0;
            result_.driftError = std::numeric_limits<double>::infinity();
            result_.clock.step = ratio_;
            return;
        }
        result_.driftPpm = 1e6 * drift;
        result_.driftError = 1e6 * fit.driftError;
        result_.scatter = fit.scatter;
        if (std::abs(drift) < 3 * fit.driftError || std::abs(drift) * length < 0.005) {
            result_.synchronous = true;
            result_.clock.start += drift * ratio_ * length / 2;  // the middle stays where it is
            result_.clock.step = ratio_;
        }
    }

    void chooseWitness()
    {
        double best = 0.0, delay = 0.0, error = 0.0;
        for (std::size_t w = 0; w < witnesses_.size(); ++w) {
            if (rmsWithoutMean(witnesses_[w].samples) < silence)
                continue;
            const auto delays = delaysOf(w, false);
            if (delays.likeness > best + 0.003) {
                best = delays.likeness;
                delay = delays.delay;
                error = delays.delayError;
                result_.witness = w;
            }
        }
        result_.likeness = best;
        result_.clock.start += delay * result_.clock.step;
        result_.startError = std::hypot(
            error, result_.synchronous ? 0.0 : 1e-6 * result_.driftError * static_cast<double>(samplesRecorded()));
        const double whole = std::round(result_.clock.start);
        if (result_.synchronous && ratio_ == 1.0
            && std::abs(result_.clock.start - whole) < std::max(0.002, 3 * result_.startError))
            result_.clock.start = whole;  // copied, not interpolated
    }

    const Measurement& plan_;
    const PlanPeriods& periods_;
    const std::vector<Witness>& witnesses_;
    double rate_, ratio_;
    std::string source_;
    Alignment result_;
};

}  // namespace

Alignment alignRecording(const Measurement& plan, const PlanPeriods& periods, const std::vector<Witness>& witnesses,
                         double recordedRate, const std::string& source)
{
    if (witnesses.empty())
        throw Error(Error::Kind::usage,
                    "No channel of '" + source + "' is mapped, so it cannot be laid beside the plan.");
    return Aligner(plan, periods, witnesses, recordedRate, source).align();
}

void countRealizations(Alignment& alignment, const Measurement& plan, std::size_t recordedSamples,
                       const std::string& source)
{
    const auto& clock = alignment.clock;
    const double available = std::floor((static_cast<double>(recordedSamples) - 1 - clock.start) / clock.step) + 1
                             + static_cast<double>(earlyEnd);
    const auto block = static_cast<double>(plan.excitation->samplesPerRealization());
    const auto all = plan.excitation->levels.size() * static_cast<std::size_t>(plan.excitation->realizations);
    alignment.realizations = std::min(all, static_cast<std::size_t>(std::max(0.0, std::floor(available / block))));
    alignment.missing = static_cast<std::size_t>(
        std::max(0.0, static_cast<double>(alignment.realizations) * block + static_cast<double>(earlyEnd) - available));
    if (alignment.realizations == 0)
        refuse(source, "ends " + figure(std::max(0.0, available) / plan.sampleRate, "%.2f")
                           + " s after the plan begins, before its first realization of "
                           + figure(block / plan.sampleRate, "%.2f") + " s is over; record all of it.");
}

}  // namespace excursion
