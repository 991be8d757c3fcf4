// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/BlackBox/BoxLinearPart.h"

#include "Engine/BlackBox/BoxMotion.h"
#include "Engine/BlackBox/BoxProtection.h"
#include "Engine/BlackBox/RegionLimiter.h"
#include "Engine/Linear/Response.h"
#include "Engine/Numerics/Eigenvalues.h"
#include "Engine/Predistortion/TargetFilter.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <memory>
#include <numbers>

namespace excursion {
namespace {

using Complex = std::complex<double>;
using Curve = std::function<Complex(double)>;

/// How often the output is derived from the displacement: -1: it is not.
int derivatives(const BlackBox& box)
{
    if (box.output == "displacement")
        return 0;
    if (box.output == "velocity")
        return 1;
    return box.output == "acceleration" || box.output == "pressure" ? 2 : -1;
}

Curve outputOf(const BlackBox& box)
{
    return [linear = box.linear](double f) { return respond(linear, {f}).front()(0, 0); };
}

/// The output, derived so often more, or integrated.
Curve derived(const Curve& output, int times)
{
    return [output, times](double f) { return output(f) * std::pow(Complex(0.0, 2.0 * std::numbers::pi * f), times); };
}

/// Pairs of poles that swing, in continuous time.
std::vector<Resonance> pairsOf(const StateSpace& linear)
{
    std::vector<Resonance> found;
    const auto poles = eigenvalues(linear.A);
    for (const auto& pole : poles) {
        if (!(pole.imag() > 0.0) || !(std::abs(pole) > 1e-3))
            continue;
        const Complex s = std::log(pole) * linear.sampleRate;
        if (s.real() < 0.0)
            found.push_back({std::abs(s) / (2.0 * std::numbers::pi), std::abs(s) / (-2.0 * s.real())});
    }
    return found;
}

/// The motion below the resonance, as a resonance has it at a quarter of its frequency.
double slowMotion(const Curve& motion, const Resonance& own)
{
    const Complex s(0.0, 0.25);
    return std::abs(motion(0.25 * own.frequency) * (s * s + s / own.quality + 1.0));
}

/// rms of what the motion departs from that resonance by, dB.
double departure(const Curve& motion, const Resonance& own, double slow)
{
    double sum = 0.0;
    int count = 0;
    for (double octaves = -2.0; octaves <= 1.0; octaves += 0.125, ++count) {
        const Complex s(0.0, std::exp2(octaves));
        const double apart = std::abs(motion(std::exp2(octaves) * own.frequency) * (s * s + s / own.quality + 1.0));
        sum += std::pow(20.0 * std::log10(apart / slow), 2);
    }
    return std::sqrt(sum / count);
}

}  // namespace

OwnLinearPart ownLinearPart(const BlackBox& box)
{
    OwnLinearPart own;
    const int order = derivatives(box);
    if (order < 0)
        return own;
    const auto output = outputOf(box), motion = derived(output, -order), heard = derived(output, 2 - order);
    double least = std::numeric_limits<double>::infinity();
    Resonance best;
    for (const auto& pair : pairsOf(box.linear)) {
        if (2.0 * pair.frequency > 0.45 * box.linear.sampleRate)
            continue;
        if (const double apart = departure(motion, pair, slowMotion(motion, pair)); apart < least) {
            least = apart;
            best = pair;
        }
    }
    if (std::isfinite(least))
        own.takeResonance(motion, best, slowMotion(motion, best));
    own.sound.emplace();
    const double from = box.stimulus.lowest(), to = std::min(box.stimulus.highest(), 0.45 * box.linear.sampleRate);
    for (std::size_t k = 0; k < own.sound->size(); ++k)  // beyond the fit nothing is known, and it stays as it is
        (*own.sound)[k] = 20.0 * std::log10(std::max(std::abs(heard(std::clamp(thirdOctave(k), from, to))), 1e-30));
    return own;
}

TargetForecast forecastTarget(const BlackBox& box, const Region& region, const Rest& rest,
                              const BlackBoxRehearsal& rehearsal, const PredistortionControls& controls, double volts,
                              const Progress& progress)
{
    ForecastSubject subject;
    subject.own = ownLinearPart(box);
    subject.resonance = subject.own.single ? subject.own.single->frequency : BoxMotion(box).linear.resonance;
    subject.sampleRate = box.linear.sampleRate;
    subject.highest = box.stimulus.highest();
    const int order = derivatives(box);
    const auto output = outputOf(box);
    if (order == 0)
        subject.motion = output;
    // In dB of the loudest third of an octave, as a model without a cone has no plateau.
    double loudest = -std::numeric_limits<double>::infinity();
    if (subject.own.sound)
        loudest = *std::max_element(subject.own.sound->begin(), subject.own.sound->end());
    subject.soundDb = [heard = derived(output, order < 0 ? 0 : 2 - order),
                       level = std::isfinite(loudest) ? loudest : 0.0](double f) {
        return 20.0 * std::log10(std::abs(heard(f))) - level;
    };
    subject.share = BoxProtection::share(box, rehearsal, controls.margin);
    subject.linearized = [&](const Target& target) -> ForecastSubject::Play {
        auto filter = std::make_shared<TargetFilter>(subject.own, box.linear.sampleRate);
        filter->aim(target);
        auto linearizer = std::make_shared<BlackBoxLinearizer>(box, region, rest, rehearsal.design);
        auto limiter = std::make_shared<RegionLimiter>(box, region, box.linear.sampleRate);
        return [&, filter, linearizer, limiter](const std::vector<double>& signal, std::size_t from, double level) {
            filter->reset();
            linearizer->reset();
            limiter->reset();
            ForecastSubject::Peak peak;
            const auto late = static_cast<std::size_t>(linearizer->latency());
            for (std::size_t n = 0; n < signal.size() + late; ++n) {
                const double aimed = filter->step(n < signal.size() ? level * signal[n] : 0.0);
                const auto sample = linearizer->step(aimed);
                limiter->step(aimed);
                if (n >= from)
                    peak.region = std::max(peak.region, limiter->latest());
                if (n < from + late)
                    continue;
                const double out = sample.input + controls.amount * sample.correction;
                peak.voltage = std::max(peak.voltage, std::abs(out));
                if (order == 0)
                    peak.displacement = std::max(peak.displacement, std::abs(sample.output));
            }
            return peak;
        };
    };
    return forecastTarget(subject, controls, volts, progress);
}

}  // namespace excursion
