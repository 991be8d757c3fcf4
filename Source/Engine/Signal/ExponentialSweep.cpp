// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Signal/ExponentialSweep.h"

#include "Engine/Error.h"
#include "Engine/Validity.h"

#include <cmath>
#include <numbers>

namespace excursion {
namespace {

constexpr double pi = std::numbers::pi;

/// From 0 at 0 to 1 at `length`, where both its slopes are 0.
double raisedCosine(double time, double length)
{
    return time >= length ? 1.0 : 0.5 - 0.5 * std::cos(pi * time / length);
}

}  // namespace

bool ExponentialSweepOptions::isValid(std::string* reason) const
{
    if (!(std::isfinite(sampleRate) && sampleRate > 0))
        return refuse(reason, "The sample rate of a sweep must be a positive number of Hz.");
    if (!(std::isfinite(bandLow) && std::isfinite(bandHigh) && bandLow > 0 && bandHigh > bandLow))
        return refuse(reason, "A sweep must go from a frequency above 0 Hz up to a higher one.");
    if (bandHigh >= sampleRate / 2)
        return refuse(reason, "A sweep must end below half the sample rate.");
    if (!(std::isfinite(peak) && peak > 0))
        return refuse(reason, "The peak of a sweep must be a positive number of V.");
    if (!(std::isfinite(seconds) && seconds * bandLow >= std::log(bandHigh / bandLow)))
        return refuse(
            reason,
            "A sweep must last at least a period of its first frequency for each factor e that it runs through.");
    if (seconds * sampleRate > 100e6)
        return refuse(reason, "A sweep must not be longer than 100 million samples.");
    if (!(fadeIn >= 0 && fadeOut >= 0 && fadeIn + fadeOut < 0.5 * seconds))
        return refuse(reason, "The fades of a sweep must be at least 0 s, and less than half the sweep together.");
    return true;
}

ExponentialSweep::ExponentialSweep(const ExponentialSweepOptions& options) : options_(options)
{
    std::string reason;
    if (!options.isValid(&reason))
        throw Error(Error::Kind::usage, reason);
    L_ = std::round(options.bandLow * options.seconds / std::log(options.bandHigh / options.bandLow)) / options.bandLow;
}

double ExponentialSweep::seconds() const { return L_ * std::log(options_.bandHigh / options_.bandLow); }

double ExponentialSweep::advance(int harmonic) const { return L_ * std::log(static_cast<double>(harmonic)); }

std::vector<double> ExponentialSweep::samples() const
{
    const double T = seconds();
    std::vector<double> x(static_cast<std::size_t>(std::ceil(T * options_.sampleRate)));
    for (std::size_t n = 0; n < x.size(); ++n) {
        const double t = static_cast<double>(n) / options_.sampleRate;
        x[n] = options_.peak * raisedCosine(t, options_.fadeIn) * raisedCosine(T - t, options_.fadeOut)
               * std::sin(2 * pi * options_.bandLow * L_ * std::exp(t / L_));
    }
    return x;
}

std::complex<double> ExponentialSweep::spectrum(double frequency) const
{
    const double nu = 2 * pi * frequency * L_;
    return std::polar(0.5 * options_.peak * std::sqrt(L_ / frequency), nu * (1 - std::log(frequency / options_.bandLow))
                                                                           + 1 / (12 * nu) + 1 / (360 * nu * nu * nu)
                                                                           - pi / 4);
}

}  // namespace excursion
