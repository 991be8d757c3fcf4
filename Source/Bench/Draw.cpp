// SPDX-License-Identifier: GPL-3.0-or-later
#include "Bench/Draw.h"

#include "Bench/Random.h"
#include "Bench/Run.h"
#include "Bench/Stimulus.h"
#include "Engine/Error.h"
#include "Engine/Signal/Fft.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace excursion::bench {
namespace {

double largest(std::span<const double> samples)
{
    double peak = 0.0;
    for (const double value : samples)
        peak = std::max(peak, std::abs(value));
    return peak;
}

// One period of every realization at the loudest level, with the effects: where does the cone really go?
double pilotPeak(const Loudspeaker& speaker, const BenchSetup& setup)
{
    auto plan = setup.excitation;
    plan.levels = {plan.levels.back()};
    plan.settlePeriods = 1;
    plan.periods = 0;
    const auto voltage = drive(plan, setup.sampleRate, setup.seed, 0);
    const auto record = run(speaker, voltage, setup.sampleRate, {Quantity::displacement}, setup.microphoneDistance,
                            0.5 * plan.bandLow);
    return largest(record.signals.at(Quantity::displacement));
}

void scaleLevels(BenchSetup& setup, double factor)
{
    for (auto& level : setup.excitation.levels)
        level *= factor;
}

void requirePressure(BenchSetup& setup)
{
    if (std::find(setup.channels.begin(), setup.channels.end(), Quantity::pressure) == setup.channels.end())
        setup.channels.push_back(Quantity::pressure);
}

}  // namespace

const std::vector<std::string>& drawnEffects()
{
    static const std::vector<std::string> ids {"force-factor",  "stiffness", "inductance-position",
                                               "eddy-currents", "creep",     "damping-velocity"};
    return ids;
}

Visited visit(const Loudspeaker& speaker, const BenchSetup& setup)
{
    const auto bare = speaker.linear();
    const auto& plan = setup.excitation;
    const auto N = static_cast<std::size_t>(plan.period);
    const double level = *std::max_element(plan.levels.begin(), plan.levels.end());
    Random gridChoice(setup.seed, 1);
    const auto lines = plan.lines.empty() ? excitedLines(plan, setup.sampleRate, gridChoice) : plan.lines;
    Visited visited;
    for (int r = 0; r < plan.realizations; ++r) {
        Random phases(setup.seed, 100 + static_cast<std::uint64_t>(r));
        const auto U = fft(multisine(plan, lines, phases));
        std::vector<std::complex<double>> X(U.size()), V(U.size()), I(U.size());
        for (const int line : lines) {
            const auto k = static_cast<std::size_t>(line);
            const double f = line * setup.sampleRate / plan.period;
            const auto response = bare.small(f);
            X[k] = level * U[k] * response.displacement;
            V[k] = X[k] * std::complex<double>(0.0, 2.0 * std::numbers::pi * f);
            I[k] = level * U[k] * response.current;
        }
        const auto current = inverseFft(I, N);
        double square = 0.0;
        for (const double value : current)
            square += value * value;
        visited.displacement = std::max(visited.displacement, largest(inverseFft(X, N)));
        visited.velocity = std::max(visited.velocity, largest(inverseFft(V, N)));
        visited.current = std::max(visited.current, largest(current));
        visited.power = std::max(visited.power, speaker.Re * square / static_cast<double>(N));
    }
    return visited;
}

Draw draw(std::uint64_t seed, const DrawOptions& options)
{
    // Each part has its own stream, so that fixing one choice leaves the others as they were.
    Random classChoice(seed, 10), driverChoice(seed, 11), setupChoice(seed, 12), effectChoice(seed, 13),
        levelChoice(seed, 14);

    Draw result;
    const auto& classes = driverClasses();
    const auto& drawnClass = classes[static_cast<std::size_t>(classChoice.index(static_cast<int>(classes.size())))];
    result.driver = options.driver.value_or(drawnClass);
    result.speaker = drawLinear(result.driver, driverChoice);
    result.setup = drawSetup(result.speaker, options, setupChoice);
    result.setup.seed = seed;
    result.setup.jumps = options.jumps.value_or(Random(seed, 15).chance(0.5));

    const double target = levelChoice.uniform(0.5, 0.8) * result.speaker.xmax;
    scaleLevels(result.setup, target / visit(result.speaker, result.setup).displacement);
    result.visited = visit(result.speaker, result.setup);

    const auto& ids = drawnEffects();
    const auto& chosen = ids[static_cast<std::size_t>(effectChoice.index(static_cast<int>(ids.size())))];
    result.hidden = options.hidden.value_or(std::vector<HiddenEffect> {{chosen, 0.0}});
    for (auto& effect : result.hidden) {
        const auto place = std::find(effectIds().begin(), effectIds().end(), effect.id) - effectIds().begin();
        Random shape(seed, 20 + static_cast<std::uint64_t>(place));
        effect.strength = addEffect(result.speaker, effect, result.visited, result.setup, shape);
        if (effect.id == "doppler" || effect.id == "cone-breakup")
            requirePressure(result.setup);
    }
    if (result.speaker.eddyCurrents && result.speaker.inductancePosition && Random(seed, 19).chance(0.7))
        setMoving(result.speaker, result.setup.excitation);

    if (!options.oddity.empty()) {
        Random course(seed, 18);
        const double strength = course.logUniform(0.01, 0.2);
        result.speaker.oddity = drawOddity(options.oddity, strength, result.speaker.K, result.visited.displacement,
                                           course);
    }

    const bool bare = result.hidden.empty() && !result.speaker.oddity;
    for (int round = 0; round < 4 && !bare; ++round) {
        const double reached = pilotPeak(result.speaker, result.setup);
        if (reached > 0.45 * result.speaker.xmax && reached < 0.85 * result.speaker.xmax)
            break;
        scaleLevels(result.setup, std::clamp(target / reached, 0.3, 2.0));
    }
    return result;
}

Loudspeaker drawLoudspeaker(std::uint64_t seed, const std::vector<HiddenEffect>& hidden)
{
    DrawOptions options;
    options.hidden = hidden;
    return draw(seed, options).speaker;
}

}  // namespace excursion::bench
