// SPDX-License-Identifier: GPL-3.0-or-later
#include "Import/FaultSimulator.h"

#include "Bench/Draw.h"
#include "Bench/Run.h"
#include "Engine/Signal/Fft.h"
#include "Engine/Take/ExcitationPlan.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace excursion::test {
namespace {

constexpr double pi = std::numbers::pi;

double besselI0(double x)
{
    double sum = 1.0, term = 1.0;
    for (int k = 1; k < 60; ++k) {
        term *= x * x / (4.0 * k * k);
        sum += term;
    }
    return sum;
}

/// A Kaiser window on a fine grid, -1 .. 1.
class Kaiser {
public:
    Kaiser()
    {
        for (std::size_t k = 0; k < values_.size(); ++k) {
            const double u = static_cast<double>(k) / static_cast<double>(values_.size() - 2);
            values_[k] = u < 1 ? besselI0(14.0 * std::sqrt(1 - u * u)) / besselI0(14.0) : besselI0(0) / besselI0(14.0);
        }
    }
    double operator()(double u) const
    {
        const double place = std::abs(u) * static_cast<double>(values_.size() - 2);
        const auto k = static_cast<std::size_t>(place);
        return k + 1 >= values_.size() ? 0.0
                                       : values_[k] + (place - static_cast<double>(k)) * (values_[k + 1] - values_[k]);
    }

private:
    std::vector<double> values_ = std::vector<double>(1u << 18);
};

/// x at the place p of its samples; x is band-limited to half of its band and silent outside.
double between(const std::vector<double>& x, double p, const Kaiser& window)
{
    constexpr int reach = 32;
    const double whole = std::floor(p), part = p - whole;
    const auto size = static_cast<std::ptrdiff_t>(x.size());
    const auto first = static_cast<std::ptrdiff_t>(whole);
    if (part == 0.0)
        return first >= 0 && first < size ? x[static_cast<std::size_t>(first)] : 0.0;
    const double sine = std::sin(pi * part) / pi;
    double sum = 0.0;
    for (int k = -reach + 1; k <= reach; ++k) {
        const auto n = first + k;
        if (n < 0 || n >= size)
            continue;
        const double away = part - k;
        sum += x[static_cast<std::size_t>(n)] * (k % 2 == 0 ? sine : -sine) / away * window(away / reach);
    }
    return sum;
}

}  // namespace

Played play(const PlayedOptions& options)
{
    ExcitationPlanOptions planned;
    planned.multisine.sampleRate = options.sampleRate;
    planned.multisine.period = options.period;
    planned.multisine.bandLow = options.bandLow;
    planned.multisine.bandHigh = options.bandHigh;
    planned.multisine.seed = options.seed;
    planned.levels = options.levels;
    planned.realizations = options.realizations;
    planned.periods = options.periods;
    return play(planExcitation(planned), options.seed, options.bandLow);
}

Played play(const Measurement& plan, std::uint64_t seed, double lowest)
{
    Played played;
    played.plan = plan;
    played.lead = 2048;
    std::vector<double> voltage(played.lead, 0.0);
    const auto& wanted = played.plan.input().samples;
    voltage.insert(voltage.end(), wanted.begin(), wanted.end());
    voltage.resize((voltage.size() + 4096) / 2 * 2, 0.0);
    const auto speaker = bench::drawLoudspeaker(seed, {{"stiffness", 0.3}});
    played.quantities = {Quantity::voltage, Quantity::current, Quantity::displacement, Quantity::pressure};
    const auto run = bench::run(speaker, voltage, plan.sampleRate,
                                {Quantity::current, Quantity::displacement, Quantity::pressure}, 0.1, lowest);
    for (const auto quantity : played.quantities) {
        const auto& fine = run.signals.at(quantity);
        // Twice the plan's rate is kept; what the loudspeaker adds above the plan's band is far below the noise.
        const auto every = static_cast<std::size_t>(run.oversampling / 2);
        std::vector<double> kept;
        for (std::size_t n = 0; n < fine.size(); n += every)
            kept.push_back(fine[n]);
        played.signals.push_back(std::move(kept));
    }
    return played;
}

Recorded record(const Played& played, const Recorder& recorder)
{
    static const Kaiser window;
    const double rate = played.plan.sampleRate;
    Recorded recorded;
    recorded.sampleRate = recorder.sampleRate;
    // samples a second of the player's clock
    const double actual = recorder.sampleRate * (1 + 1e-6 * recorder.ppm);
    recorded.step = actual / rate;
    recorded.start = recorder.lead * actual;
    const double seconds = recorder.lead + static_cast<double>(played.plan.length()) / rate + recorder.tail;
    const auto length = static_cast<std::size_t>(seconds * actual);
    std::mt19937_64 random(recorder.seed);
    std::normal_distribution<double> normal;
    for (std::size_t c = 0; c < recorder.signals.size(); ++c) {
        const auto& signal = played.signals[recorder.signals[c]];  // at twice the plan's rate
        // A recorder that is slower than the plan has a filter that lets nothing above half its rate pass; the plan has
        // nothing there.
        std::vector<double> x(length);
        for (std::size_t n = 0; n < length; ++n) {
            const double planSample = (static_cast<double>(n) - recorded.start) / recorded.step;
            const double place = 2.0 * (planSample + static_cast<double>(played.lead));
            if (place > -64 && place < static_cast<double>(signal.size()) + 64)
                x[n] = between(signal, place, window) / recorder.fullScale[c];
        }
        const double step = std::exp2(1 - recorder.bits);
        for (auto& v : x) {
            v += recorder.noise * normal(random);
            v = std::clamp(std::round(v / step) * step, -1.0, 1.0 - step);
        }
        if (recorder.drop > 0 && recorder.dropAt >= 0) {
            const auto at = x.begin() + static_cast<std::ptrdiff_t>(recorder.dropAt * recorder.sampleRate);
            x.erase(at, at + recorder.drop);
        }
        recorded.channels.push_back(std::move(x));
    }
    return recorded;
}

Recorder recorder(std::vector<std::size_t> signals)
{
    Recorder r;
    r.signals = std::move(signals);
    static constexpr double scales[] {16.0, 4.0, 0.008, 8.0};
    for (const auto s : r.signals)
        r.fullScale.push_back(scales[s]);
    return r;
}

void RecorderClock::set(Recorder& r) const
{
    r.sampleRate = rate;
    r.ppm = ppm;
    r.lead = lead;
    r.bits = bits;
}

double clockError(const Alignment& alignment, const Recorded& truth, const Measurement& take)
{
    const auto error = [&](double n) {
        return std::abs(alignment.clock.at(n) - truth.start - n * truth.step) / truth.step;
    };
    return std::max(error(0.0), error(static_cast<double>(take.length())));
}

}  // namespace excursion::test
