// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/Trajectory.h"

#include "Engine/Loudspeaker/DividedStep.h"
#include "Engine/Loudspeaker/Plausible.h"
#include "Engine/Loudspeaker/Radiator.h"
#include "Engine/Loudspeaker/SensitivityStep.h"

#include <algorithm>
#include <array>

namespace excursion {
namespace {

constexpr int mostSubsteps = 1 << (StepParts::powers - 1);

}  // namespace

const std::vector<double>& Trajectory::operator[](Trace trace) const
{
    const std::array<const std::vector<double>*, traceCount> all {&current, &displacement, &velocity, &acceleration,
                                                                  &flow,    &lateness,     &spot};
    return *all[static_cast<std::size_t>(trace)];
}

bool integrate(const Model& model, const Drive& drive, const Window& window, Trajectory& out,
               const Eigen::VectorXd& start)
{
    return integrate(model, drive, StepDivision(model, 1.0 / (drive.step() * drive.substeps()), 1), window, out, start);
}

bool integrate(const Model& model, const Drive& drive, const StepDivision& division, const Window& window,
               Trajectory& out, const Eigen::VectorXd& start)
{
    const auto first = window.begin;
    DividedStep motion(model, division, drive.step());
    Radiator radiator(model);
    const Plausible plausible(model);
    if (start.size() > 0)
        motion.begin(start);
    motion.letSlowStand(window.slowStands && first > 0);
    Eigen::VectorXd before;
    for (auto* trace :
         {&out.current, &out.displacement, &out.velocity, &out.acceleration, &out.flow, &out.lateness, &out.spot}) {
        trace->clear();
        trace->reserve(drive.length() - first);
    }
    out.ahead = std::min(window.ahead, first);
    const std::size_t left = first - out.ahead, allLeft = drive.length() - out.ahead;
    std::size_t half = 0;
    for (std::size_t n = 0; n < drive.length(); ++n) {
        if (window.slowStands && n == first)
            motion.letSlowStand(false);
        const bool kept = n >= first;
        if (kept) {
            out.current.push_back(motion.current());
            out.displacement.push_back(motion.displacement());
            out.velocity.push_back(motion.velocity());
        }
        const bool radiated = n >= left && n < allLeft;
        if (kept || radiated)
            motion.state(before);
        for (int s = 0; s < drive.substeps(); ++s, half += 2) {
            const double acceleration = motion.step(drive.polynomial(half));
            if (s > 0 || !(kept || radiated))
                continue;
            const auto sound = radiator.at(before.data(), acceleration);
            if (kept) {
                out.acceleration.push_back(acceleration);
                out.spot.push_back(sound.spot);
            }
            if (radiated) {
                out.flow.push_back(sound.flow);
                out.lateness.push_back(sound.lateness);
            }
        }
        if (!plausible.holds(motion.current(), motion.displacement(), motion.velocity()))
            return false;
    }
    return true;
}

bool differentiate(const Model& model, std::span<const Eigen::Index> active, const Drive& drive, const Window& window,
                   const std::vector<Trace>& observed, const StartState& start, std::vector<Eigen::MatrixXd>& out)
{
    const auto first = window.begin;
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
    motion.letSlowStand(window.slowStands && first > 0);
    out.assign(observed.size(), Eigen::MatrixXd(count, static_cast<Eigen::Index>(drive.length() - first)));
    Eigen::MatrixXd before, emitted(count, 3);
    Eigen::VectorXd from;
    const std::size_t ahead = std::min(window.ahead, first), left = first - ahead, allLeft = drive.length() - ahead;
    std::size_t half = 0;
    for (std::size_t n = 0; n < drive.length(); ++n) {
        if (window.slowStands && n == first)
            motion.letSlowStand(false);
        const auto column = static_cast<Eigen::Index>(n - first), leaves = static_cast<Eigen::Index>(n - left);
        const bool kept = n >= first, radiated = radiates && n >= left && n < allLeft;
        if (kept)
            for (std::size_t q = 0; q < observed.size(); ++q)
                if (observed[q] < Trace::acceleration)
                    out[q].col(column) = motion.slopes().col(static_cast<Eigen::Index>(observed[q]));
        if (radiates && (kept || radiated)) {
            motion.slopesByState(before);
            motion.state(from);
        }
        for (int s = 0; s < drive.substeps(); ++s, half += 2) {
            motion.step(drive.polynomial(half));
            if (s > 0 || !(kept || radiated))
                continue;
            if (radiates)
                radiator.differentiate(from.data(), motion.acceleration(), before, motion.accelerationSlopes(),
                                       emitted);
            for (std::size_t q = 0; q < observed.size(); ++q) {
                const bool heard = observed[q] == Trace::flow || observed[q] == Trace::lateness;
                if (observed[q] < Trace::acceleration || !(heard ? radiated : kept))
                    continue;
                auto to = out[q].col(heard ? leaves : column);
                if (observed[q] == Trace::acceleration)
                    to = motion.accelerationSlopes();
                else
                    to = emitted.col(static_cast<Eigen::Index>(observed[q]) - static_cast<Eigen::Index>(Trace::flow));
            }
        }
        if (!plausible.holds(motion.current(), motion.displacement(), motion.velocity()))
            return false;
    }
    return true;
}

int stableSubsteps(const Model& model, double sampleRate, ExponentialStep::Places places)
{
    ExponentialStep whole(model, 1.0 / sampleRate);
    const auto slopes = whole.lawSlopes(places);
    int substeps = 1;
    while (substeps < mostSubsteps && !ExponentialStep(model, 1.0 / (sampleRate * substeps)).isStable(slopes))
        ++substeps;
    return substeps;
}

}  // namespace excursion
