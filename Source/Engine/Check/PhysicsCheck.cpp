// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Check/PhysicsCheck.h"

#include "Engine/Check/PeriodCheck.h"
#include "Engine/Document/Engineering.h"
#include "Engine/Estimate/EstimateFrf.h"
#include "Engine/Take/Motion.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace excursion {
namespace {

constexpr double smallestFault = 0.25;  ///< samples

/// The response of one channel to another where the loudspeaker is the most linear, and at the loudest level.
class Responses {
public:
    explicit Responses(const AveragedPeriods& averages) : averages_(averages), take_(averages.take()) {}

    /// The verdict on `output` against `input`.
    PhysicalDelay judge(Quantity output, Quantity input, const std::function<PhysicalDelay(const Frf&)>& law) const
    {
        auto verdict = confirmed(output, input, law);
        if (!verdict.clear || verdict.seconds > 0.0)
            return verdict;
        // An early channel holds the begin of the next realization at the end of each: make it late, and look again.
        const auto samples = static_cast<std::size_t>(std::ceil(-verdict.seconds * take_.sampleRate)) + 8;
        Measurement later = take_;
        for (auto& channel : later.channels)
            if (channel.quantity == output && channel.samples.size() > samples)
                std::rotate(channel.samples.begin(), channel.samples.end() - static_cast<std::ptrdiff_t>(samples),
                            channel.samples.end());
        const AveragedPeriods averages(later);
        const auto precise = Responses(averages).confirmed(output, input, law);
        if (precise.clear) {
            verdict = precise;
            verdict.seconds -= static_cast<double>(samples) / take_.sampleRate;
        }
        return verdict;
    }

    Frf at(Quantity output, Quantity input, int level) const
    {
        WelchOptions options;
        options.segment = segmentFor(take_.length(), 16, 16384, 1024);
        if (!take_.hasPeriods() && !options.isValid(take_.length()))
            return {};
        return estimateFrf(take_, output, input, level, options);
    }

    /// Quietest level with 30 dB of signal to noise on both channels.
    int quietest(Quantity output, Quantity input) const
    {
        const int loudest = this->loudest();
        for (int level = 0; level < loudest; ++level) {
            const auto a = signalToNoise(averages_, *take_.find(output), level);
            const auto b = signalToNoise(averages_, *take_.find(input), level);
            if (a && b && *a > 30.0 && *b > 30.0)
                return level;
        }
        return loudest;
    }
    int loudest() const { return take_.hasPeriods() ? take_.excitation->loudest() : 0; }

private:
    /// The verdict at the quiet level; an accusation stands only when the loudest level repeats it.
    PhysicalDelay confirmed(Quantity output, Quantity input, const std::function<PhysicalDelay(const Frf&)>& law) const
    {
        const int level = take_.hasPeriods() ? quietest(output, input) : 0;
        auto verdict = law(at(output, input, level));
        if ((verdict.clear || verdict.inverted) && level != loudest()) {
            const auto loud = law(at(output, input, loudest()));
            verdict.inverted = verdict.inverted && loud.inverted;
            verdict.clear = verdict.clear
                            && std::abs(loud.seconds - verdict.seconds)
                                   < 0.1 * std::abs(verdict.seconds) + smallestFault / take_.sampleRate;
        }
        verdict.clear = verdict.clear && std::abs(verdict.seconds) * take_.sampleRate > smallestFault;
        return verdict;
    }

    const AveragedPeriods& averages_;
    const Measurement& take_;
};

Problem delayProblem(Quantity channel, double samples, double sampleRate)
{
    const double time = std::abs(samples) / sampleRate;
    return {"channel-delay",
            channel,
            samples,
            "samples",
            true,
            "The " + std::string(name(channel)) + " channel is " + plainText(std::abs(samples), 2) + " samples ("
                + engineering(time, "s", 3) + ") " + (samples > 0.0 ? "late" : "early")
                + " against what the physics allows; "
                + (samples > 0.0 ? "import it with that latency behind its full scale (CHANNEL=QUANTITY:FULLSCALE@"
                                       + plainText(1e3 * time, 4) + "ms), or write it into the calibration."
                                 : "the others have a latency that is to be taken off when they are imported.")};
}

Problem polarityProblem(Quantity channel, bool fatal)
{
    return {"polarity",
            channel,
            -1.0,
            "",
            fatal,
            "The " + std::string(name(channel)) + " channel has its sign reversed; swap its wires or negate it."};
}

}  // namespace

void checkPhysics(const AveragedPeriods& averages, const std::vector<bool>& alive, std::vector<ChannelFigures>& figures,
                  std::vector<Problem>& problems)
{
    const auto& take = averages.take();
    const Responses responses(averages);
    const auto living = [&](Quantity q) {
        for (std::size_t c = 0; c < take.channels.size(); ++c)
            if (take.channels[c].quantity == q && alive[c])
                return true;
        return false;
    };
    const auto figuresOf = [&](Quantity q) -> ChannelFigures& {
        return *std::find_if(figures.begin(), figures.end(), [q](const auto& f) { return f.quantity == q; });
    };
    const Quantity input = take.input().quantity;
    if (!living(input))
        return;

    PhysicalDelay current;
    const bool hasCurrent = input == Quantity::voltage && living(Quantity::current);
    if (hasCurrent) {
        current = responses.judge(Quantity::current, input, currentDelay);
        figuresOf(Quantity::current).delay = current;
    }
    const double currentLate = current.clear ? current.seconds * take.sampleRate : 0.0;

    const Quantity reference = hasCurrent ? Quantity::current : input;
    const MotionReference drive = reference == Quantity::voltage ? MotionReference::voltage : MotionReference::force;
    struct Motion {
        Quantity quantity;
        PhysicalDelay delay;
    };
    std::vector<Motion> motions;
    for (const auto& channel : take.channels)
        if (isMotion(channel.quantity) && living(channel.quantity)) {
            const auto quantity = channel.quantity;
            motions.push_back({quantity, responses.judge(quantity, reference, [=](const Frf& frf) {
                                   return motionDelay(frf, quantity, drive);
                               })});
            figuresOf(quantity).delay = motions.back().delay;
            figuresOf(quantity).delayReference = reference;
        }

    // The voltage alone is off when some motion agrees with the current, closely enough to exclude that the current is.
    const bool motionSidesWithCurrent = std::any_of(motions.begin(), motions.end(), [&](const Motion& m) {
        const double samples = m.delay.seconds * take.sampleRate, error = m.delay.standardError * take.sampleRate;
        return m.delay.conclusive && !m.delay.doubtful && 5.0 * error < std::abs(currentLate)
               && std::abs(samples) < 0.3 * std::abs(currentLate);
    });
    if (current.clear)
        problems.push_back(motionSidesWithCurrent ? delayProblem(input, -currentLate, take.sampleRate)
                                                  : delayProblem(Quantity::current, currentLate, take.sampleRate));
    for (const auto& motion : motions) {
        if (!motion.delay.clear)
            continue;
        const double measured = motion.delay.seconds * take.sampleRate;
        const double late = measured + (motionSidesWithCurrent ? 0.0 : currentLate);
        const double doubt = 5.0 * motion.delay.standardError * take.sampleRate + 0.05 * std::abs(measured);
        if (std::abs(late) > smallestFault + doubt)
            problems.push_back(delayProblem(motion.quantity, late, take.sampleRate));
    }

    const bool motionSharesSign = std::any_of(motions.begin(), motions.end(),
                                              [](const Motion& m) { return m.delay.conclusive && !m.delay.inverted; });
    const bool inputInverted = current.inverted && motionSharesSign;
    const bool currentInverted = current.inverted && !inputInverted;
    if (inputInverted)
        problems.push_back(polarityProblem(input, true));
    if (currentInverted)
        problems.push_back(polarityProblem(Quantity::current, true));
    for (const auto& motion : motions)
        if (motion.delay.conclusive && motion.delay.inverted != currentInverted)
            problems.push_back(polarityProblem(motion.quantity, true));

    if (living(Quantity::pressure) && !motions.empty()) {
        const auto& motion = motions.front();
        const bool motionIsSound = motion.delay.inverted == currentInverted;
        if (motionIsSound
            && pressureIsInverted(responses.at(Quantity::pressure, motion.quantity, responses.loudest()),
                                  motion.quantity))
            problems.push_back(polarityProblem(Quantity::pressure, false));
    }
}

}  // namespace excursion
