// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/Simulate.h"

#include "Engine/Error.h"
#include "Engine/Loudspeaker/SensorResponse.h"
#include "Engine/Loudspeaker/Sensors.h"
#include "Engine/Signal/Level.h"
#include "Engine/Validity.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace excursion {

bool SimulationOptions::isValid(std::string* reason) const
{
    const auto possible = [](double one) { return one > 1e-12 && one < 1.0; };
    if (!possible(tolerance)
        || !std::all_of(tolerances.begin(), tolerances.end(), [&](const auto& one) { return possible(one.second); }))
        return refuse(reason, "the tolerance of a simulation must lie between 1e-12 and 1");
    if (maximumSubsteps < 1)
        return refuse(reason, "a simulation needs at least one step a sample");
    return true;
}

namespace {

/// After the first quarter, where an input that starts at once has made the states jump.
double relativeChange(const std::vector<double>& coarse, const std::vector<double>& fine)
{
    double difference = 0.0, power = 0.0;
    for (std::size_t n = fine.size() / 4; n < fine.size(); ++n) {
        difference += (coarse[n] - fine[n]) * (coarse[n] - fine[n]);
        power += fine[n] * fine[n];
    }
    return power > 0.0 ? std::sqrt(difference / power) : 0.0;
}

std::map<Trace, double> tolerancesOf(const Model& model, const SimulationOptions& options)
{
    if (!options.tolerances.empty())
        return options.tolerances;
    std::map<Trace, double> result {{Trace::displacement, options.tolerance}, {Trace::acceleration, options.tolerance}};
    if (model.electrical())
        result[Trace::current] = options.tolerance;
    return result;
}

}  // namespace

SimulationSummary chooseSubsteps(const Model& model, std::span<const double> input, double sampleRate,
                                 const SimulationOptions& options)
{
    // The loudest stretch decides; it is short, so the search costs little.
    const auto stretch = std::min<std::size_t>(input.size(), 8192);
    const auto peak = std::max_element(input.begin(), input.end(),
                                       [](double a, double b) { return std::abs(a) < std::abs(b); });
    const auto centre = static_cast<std::size_t>(peak - input.begin());
    const auto begin = std::min(centre > stretch / 2 ? centre - stretch / 2 : 0, input.size() - stretch);
    const auto part = input.subspan(begin, stretch);

    const auto tolerances = tolerancesOf(model, options);
    SimulationSummary summary;
    summary.substeps = 1;
    Trajectory coarse, fine;
    bool have = integrate(model, Drive(part, sampleRate, summary.substeps), {}, coarse), ever = have;
    while (summary.substeps <= options.maximumSubsteps) {
        const bool refined = integrate(model, Drive(part, sampleRate, 2 * summary.substeps), {}, fine);
        if (have && refined) {
            summary.accuracy = 0.0;
            summary.converged = true;
            for (const auto& [trace, tolerance] : tolerances) {
                const double change = relativeChange(coarse[trace], fine[trace]);
                summary.accuracy = std::max(summary.accuracy, change);
                summary.converged = summary.converged && change <= tolerance;
            }
            if (summary.converged)
                break;
        }
        summary.substeps *= 2;
        std::swap(coarse, fine);
        have = refined;
        ever = ever || refined;
    }
    // What runs away at every step does so by a law, and no shorter steps help.
    summary.substeps = ever ? std::min(summary.substeps, options.maximumSubsteps) : 1;
    return summary;
}

Measurement simulate(const Model& model, std::span<const double> input, double sampleRate,
                     const SimulationOptions& options, SimulationSummary* summary, const Progress& progress)
{
    std::string reason;
    if (!options.isValid(&reason))
        throw Error(Error::Kind::usage, "The simulation cannot run: " + reason + ".");
    progress.at(0.0, "choosing the step size");
    const auto chosen = chooseSubsteps(model, input, sampleRate, options);
    if (summary)
        *summary = chosen;
    progress.at(0.2, "simulating");
    Trajectory run;
    if (!integrate(model, Drive(input, sampleRate, chosen.substeps), {}, run))
        throw Error(Error::Kind::numerical,
                    "The simulated driver ran away: at this level the model is driven far beyond the "
                    "range in which it was measured; lower --full-scale.");
    progress.at(0.95, "radiating");
    const auto perfect = withoutSensors(model);
    const Sensors sensors(perfect, run, sampleRate);

    Measurement result;
    result.sampleRate = sampleRate;
    result.driver.name = model.name;
    result.driver.coneArea = std::abs(model.path.parameters[0].value);  // negative where a microphone is inverted
    result.driver.microphoneDistance = model.microphoneDistance;
    const auto add = [&result](Quantity quantity, std::vector<double> samples) {
        const double peak = peakOf(samples);
        result.channels.push_back(
            {quantity, std::string(siUnit(quantity)), peak > 0.0 ? 1.25 * peak : 1.0, std::move(samples)});
    };
    std::vector<double> copy(input.begin(), input.end());
    add(model.electrical() ? Quantity::voltage : Quantity::force, std::move(copy));
    for (const auto quantity :
         {Quantity::current, Quantity::displacement, Quantity::velocity, Quantity::acceleration, Quantity::pressure})
        if (quantity != Quantity::current || model.electrical())
            add(quantity, sensors.record(quantity));
    progress.at(1.0, "simulated");
    return result;
}

}  // namespace excursion
