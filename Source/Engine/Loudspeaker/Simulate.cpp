// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/Simulate.h"

#include "Engine/Loudspeaker/ExponentialStep.h"
#include "Engine/Loudspeaker/Plausible.h"
#include "Engine/Loudspeaker/Radiator.h"
#include "Engine/Loudspeaker/SensitivityStep.h"
#include "Engine/Loudspeaker/Sensors.h"
#include "Engine/Signal/Level.h"
#include "Engine/Signal/Resample.h"
#include "Engine/Validity.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>

namespace excursion {

Drive::Drive(std::span<const double> samples, double sampleRate, int substeps)
    : length_(samples.size()),
      substeps_(substeps),
      step_(1.0 / (sampleRate * substeps)),
      fine_(upsample(samples, 2 * substeps))
{
}

std::array<double, 7> Drive::polynomial(std::size_t halfStep) const
{
    // Lagrange's polynomial through s = -1, -1/2, ..., 2, by the inverse of its Vandermonde matrix.
    constexpr int count = 7;
    static const auto inverse = [] {
        Eigen::Matrix<double, count, count> vandermonde;
        for (int row = 0; row < count; ++row)
            for (int column = 0; column < count; ++column)
                vandermonde(row, column) = std::pow(0.5 * (row - 2), column);
        return vandermonde.inverse().eval();
    }();
    const auto last = static_cast<std::ptrdiff_t>(fine_.size()) - 1;
    Eigen::Matrix<double, count, 1> value;
    for (int k = 0; k < count; ++k) {
        const auto n = static_cast<std::ptrdiff_t>(halfStep) + k - 2;
        const auto inside = [&](std::ptrdiff_t at) {
            return fine_[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(at, 0, last))];
        };
        value[k] = n < 0      ? 2.0 * inside(0) - inside(-n)
                   : n > last ? 2.0 * inside(last) - inside(2 * last - n)
                              : inside(n);
    }
    std::array<double, count> result;
    Eigen::Map<Eigen::Matrix<double, count, 1>>(result.data()).noalias() = inverse * value;
    return result;
}

const std::vector<double>& Trajectory::operator[](Trace trace) const
{
    const std::array<const std::vector<double>*, traceCount> all {&current, &displacement, &velocity, &acceleration,
                                                                  &flow,    &lateness,     &spot};
    return *all[static_cast<std::size_t>(trace)];
}

bool integrate(const Model& model, const Drive& drive, std::size_t first, Trajectory& out, const Eigen::VectorXd& start)
{
    ExponentialStep motion(model, drive.step());
    Radiator radiator(model);
    const Plausible plausible(model);
    if (start.size() > 0)
        motion.begin(start);
    Eigen::VectorXd before;
    for (auto* trace :
         {&out.current, &out.displacement, &out.velocity, &out.acceleration, &out.flow, &out.lateness, &out.spot}) {
        trace->clear();
        trace->reserve(drive.length() - first);
    }
    std::size_t half = 0;
    for (std::size_t n = 0; n < drive.length(); ++n) {
        const bool kept = n >= first;
        if (kept) {
            out.current.push_back(motion.current());
            out.displacement.push_back(motion.displacement());
            out.velocity.push_back(motion.velocity());
            motion.state(before);
        }
        for (int s = 0; s < drive.substeps(); ++s, half += 2) {
            const double acceleration = motion.step(drive.polynomial(half));
            if (s > 0 || !kept)
                continue;
            const auto sound = radiator.at(before.data(), acceleration);
            out.acceleration.push_back(acceleration);
            out.flow.push_back(sound.flow);
            out.lateness.push_back(sound.lateness);
            out.spot.push_back(sound.spot);
        }
        if (!plausible.holds(motion.current(), motion.displacement(), motion.velocity()))
            return false;
    }
    return true;
}

bool differentiate(const Model& model, std::span<const Eigen::Index> active, const Drive& drive, std::size_t first,
                   const std::vector<Trace>& observed, const StartState& start, std::vector<Eigen::MatrixXd>& out)
{
    const auto count = static_cast<Eigen::Index>(active.size());
    SensitivityStep motion(model, drive.step(), active);
    const bool radiates = std::any_of(observed.begin(), observed.end(),
                                      [](Trace trace) { return trace >= Trace::flow; });
    Radiator radiator(model, radiates ? active : std::span<const Eigen::Index> {});
    const Plausible plausible(model);
    if (start.value.size() > 0) {
        Eigen::MatrixXd slopes(count, start.value.size());
        for (std::size_t k = 0; k < active.size(); ++k)
            slopes.row(static_cast<Eigen::Index>(k)) = start.gradient.col(active[k]).transpose();
        motion.begin(start.value, slopes);
    }
    out.assign(observed.size(), Eigen::MatrixXd(count, static_cast<Eigen::Index>(drive.length() - first)));
    Eigen::MatrixXd before, emitted(count, 3);
    Eigen::VectorXd from;
    std::size_t half = 0;
    for (std::size_t n = 0; n < drive.length(); ++n) {
        const auto column = static_cast<Eigen::Index>(n - first);
        const bool kept = n >= first;
        if (kept) {
            for (std::size_t q = 0; q < observed.size(); ++q)
                if (observed[q] < Trace::acceleration)
                    out[q].col(column) = motion.slopes().col(static_cast<Eigen::Index>(observed[q]));
            if (radiates) {
                motion.slopesByState(before);
                motion.state(from);
            }
        }
        for (int s = 0; s < drive.substeps(); ++s, half += 2) {
            motion.step(drive.polynomial(half));
            if (s > 0 || !kept)
                continue;
            if (radiates)
                radiator.differentiate(from.data(), motion.acceleration(), before, motion.accelerationSlopes(),
                                       emitted);
            for (std::size_t q = 0; q < observed.size(); ++q)
                if (observed[q] == Trace::acceleration)
                    out[q].col(column) = motion.accelerationSlopes();
                else if (observed[q] > Trace::acceleration)
                    out[q].col(column) = emitted.col(static_cast<Eigen::Index>(observed[q])
                                                     - static_cast<Eigen::Index>(Trace::flow));
        }
        if (!plausible.holds(motion.current(), motion.displacement(), motion.velocity()))
            return false;
    }
    return true;
}

int stableSubsteps(const Model& model, double sampleRate, double limit)
{
    return std::clamp(
        static_cast<int>(std::ceil(ExponentialStep(model, 1.0 / sampleRate).fastestLaw() / (limit * sampleRate))), 1,
        64);
}

bool SimulationOptions::isValid(std::string* reason) const
{
    if (!(tolerance > 1e-12 && tolerance < 1.0))
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

    SimulationSummary summary;
    summary.substeps = stableSubsteps(model, sampleRate);
    Trajectory coarse, fine;
    bool have = integrate(model, Drive(part, sampleRate, summary.substeps), 0, coarse);
    while (summary.substeps <= options.maximumSubsteps) {
        const bool refined = integrate(model, Drive(part, sampleRate, 2 * summary.substeps), 0, fine);
        if (have && refined) {
            summary.accuracy = std::max(relativeChange(coarse.displacement, fine.displacement),
                                        relativeChange(coarse.acceleration, fine.acceleration));
            if (model.electrical())
                summary.accuracy = std::max(summary.accuracy, relativeChange(coarse.current, fine.current));
            summary.converged = summary.accuracy <= options.tolerance;
            if (summary.converged)
                break;
        }
        summary.substeps *= 2;
        std::swap(coarse, fine);
        have = refined;
    }
    summary.substeps = std::min(summary.substeps, options.maximumSubsteps);
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
    if (!integrate(model, Drive(input, sampleRate, chosen.substeps), 0, run))
        throw Error(Error::Kind::numerical,
                    "The simulated driver ran away: at this level the model is driven far beyond the "
                    "range in which it was measured; lower --full-scale.");
    progress.at(0.95, "radiating");
    const Sensors sensors(model, run, sampleRate);

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
