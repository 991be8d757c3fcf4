// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Take/SweepExcitation.h"

#include "Engine/Error.h"
#include "Engine/Take/ExcitationPlan.h"
#include "Engine/Validity.h"

#include <cmath>
#include <numbers>

namespace excursion {
namespace {

ExponentialSweepOptions sweepOptions(const SweepExcitation& e, double sampleRate, double level)
{
    ExponentialSweepOptions options;
    options.sampleRate = sampleRate;
    options.bandLow = e.bandLow;
    options.bandHigh = e.bandHigh;
    options.seconds = e.seconds;
    options.peak = std::numbers::sqrt2 * level;
    options.fadeIn = e.fadeIn;
    options.fadeOut = e.fadeOut;
    return options;
}

}  // namespace

bool SweepExcitation::isValid(double sampleRate, std::string* reason) const
{
    if (!sweepOptions(*this, sampleRate, 1.0).isValid(reason))
        return false;
    if (!(silence >= 0.0 && silence <= 60.0))
        return refuse(reason, "The silence behind a sweep must be 0 to 60 s.");
    if (levels.empty() || levels.size() > 1000)
        return refuse(reason, "Sweeps need 1 to 1000 levels.");
    for (std::size_t i = 0; i < levels.size(); ++i)
        if (!(std::isfinite(levels[i]) && levels[i] > 0.0 && (i == 0 || levels[i] > levels[i - 1])))
            return refuse(reason, "The levels of sweeps must be positive numbers of V rms that ascend.");
    if (repeats < 1 || repeats > 1000)
        return refuse(reason, "A sweep is played 1 to 1000 times at each level.");
    const double samples = (seconds + silence) * sampleRate * repeats * static_cast<double>(levels.size());
    if (samples > 500e6)
        return refuse(reason, "Sweeps must not be longer than 500 million samples; take shorter ones, fewer repeats or "
                              "fewer levels.");
    return true;
}

ExponentialSweep SweepExcitation::sweep(double sampleRate, std::size_t level) const
{
    return ExponentialSweep(sweepOptions(*this, sampleRate, levels.at(level)));
}

long SweepExcitation::sweepSamples(double sampleRate) const
{
    return static_cast<long>(std::ceil(sweep(sampleRate, 0).seconds() * sampleRate));
}

long SweepExcitation::blockSamples(double sampleRate) const
{
    return sweepSamples(sampleRate) + std::lround(silence * sampleRate);
}

long SweepExcitation::totalSamples(double sampleRate) const
{
    return blockSamples(sampleRate) * repeats * static_cast<long>(levels.size());
}

Measurement planSweep(const SweepExcitation& excitation, double sampleRate)
{
    std::string reason;
    if (!excitation.isValid(sampleRate, &reason))
        throw Error(Error::Kind::usage, reason);
    const auto block = static_cast<std::size_t>(excitation.blockSamples(sampleRate));
    Channel voltage;
    voltage.samples.reserve(static_cast<std::size_t>(excitation.totalSamples(sampleRate)));
    for (std::size_t level = 0; level < excitation.levels.size(); ++level) {
        auto once = excitation.sweep(sampleRate, level).samples();
        once.resize(block, 0.0);
        for (int r = 0; r < excitation.repeats; ++r)
            voltage.samples.insert(voltage.samples.end(), once.begin(), once.end());
    }
    voltage.fullScale = roundFullScale(voltage.samples);
    Measurement plan;
    plan.sampleRate = sampleRate;
    plan.channels.push_back(std::move(voltage));
    return plan;
}

}  // namespace excursion
