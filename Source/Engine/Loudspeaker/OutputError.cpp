// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/OutputError.h"

#include "Engine/Loudspeaker/DepartureResponse.h"
#include "Engine/Loudspeaker/LawPace.h"
#include "Engine/Loudspeaker/SensorResponse.h"
#include "Engine/Loudspeaker/Sensors.h"
#include "Engine/Loudspeaker/SmallSignal.h"
#include "Engine/Loudspeaker/StartState.h"
#include "Engine/Loudspeaker/Trajectory.h"
#include "Engine/Numerics/Parallel.h"
#include "Engine/Signal/Fft.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace excursion {
namespace {

using Spectrum = std::vector<std::complex<double>>;

/// Whether the memory of a law is at work that is to settle in the lead-in: a slow one has its history.
bool settles(const Component& component)
{
    const auto& effect = *component.effect;
    return !effect.linear() && !effect.slow() && effect.memorySize(component.operatingRange) > 0
           && std::any_of(component.parameters.begin(), component.parameters.end(),
                          [](const Parameter& p) { return p.strength && p.value != 0.0; });
}

/// A sum that is empty at first.
void addTo(Eigen::MatrixXd& sum, const Eigen::MatrixXd& more)
{
    if (sum.size() == 0)
        sum = more;
    else
        sum += more;
}

class SectionRun {
public:
    SectionRun(const Model& model, const Record& record, const Section& section,
               const std::vector<Eigen::Index>& active, const OutputErrorOptions& options, const StepDivision& division,
               std::size_t leadIn, std::size_t ahead, const StartState& from, const Paths* paths,
               const DepartureResponse* departures)
        : model_(model),
          record_(record),
          section_(section),
          residual_(record, section),
          active_(active),
          options_(options),
          division_(division),
          from_(from),
          paths_(paths),
          departures_(departures)
    {
        input_ = record.drive(section, leadIn);
        drive_.emplace(input_, record.sampleRate, options.substeps);
        window_.begin = input_.size() - section.window;
        window_.slowStands = section.periodic;
        window_.ahead = ahead;
    }

    SectionFit run()
    {
        SectionFit fit;
        const auto channels = record_.channels.size();
        const auto columns = static_cast<Eigen::Index>(active_.size());

        Trajectory trajectory;
        fit.finite = integrate(model_, *drive_, division_, window_, trajectory, from_.value);
        if (!fit.finite)
            return fit;
        std::vector<Eigen::VectorXd> residual;
        std::vector<Spectrum> predicted;
        Sensors sensors(model_, trajectory, record_.sampleRate);
        for (const auto quantity : record_.channels)
            predicted.push_back(sensors.seen(quantity));
        if (departures_)
            departures_->addTo(predicted, section_);
        for (std::size_t c = 0; c < channels; ++c)
            residual.push_back(residual_.of(c, predicted[c]));
        std::optional<SectionDrift> drift;
        if (paths_) {
            drift.emplace(model_, record_, section_, residual_, *paths_, fft(trajectory.current),
                          fft(trajectory.displacement));
            fit.drift = drift->follow(predicted, residual);
        }
        for (std::size_t c = 0; c < channels; ++c) {
            fit.power.push_back(residual_.power(c, predicted[c]));
            fit.channels.emplace_back(residual[c]);
        }
        if (options_.gradient && columns > 0) {
            std::vector<Eigen::MatrixXd> J(channels, Eigen::MatrixXd::Zero(residual_.rows(), columns));
            fit.finite = sensitivities(sensors, J, options_.gradientSubsteps);
            if (!fit.finite) {  // it has been where few models go
                const int finer = stableSubsteps(model_, record_.sampleRate, ExponentialStep::Places::all);
                fit.finite = finer > options_.gradientSubsteps && sensitivities(sensors, J, finer);
            }
            if (!fit.finite)
                return fit;
            addSensors(predicted, J);
            if (drift)
                drift->takeOut(J);
            for (std::size_t c = 0; c < channels; ++c) {
                fit.channels[c].differentiateBy(J[c], residual[c]);
                fit.pull(residual_.pulls(J[c], residual[c]));
                if (options_.slopes)
                    fit.slopes.push_back(J[c].cast<float>());
            }
            if (options_.shared)
                fit.shared = residual_.shared(J);
        }
        if (options_.spectra)
            fit.predicted = std::move(predicted);
        return fit;
    }

private:
    /// The columns of what no state feels: the responses of the sensors.
    void addSensors(const std::vector<Spectrum>& predicted, std::vector<Eigen::MatrixXd>& J) const
    {
        const double step = 2.0 * std::numbers::pi * record_.frequency(section_, 1);
        const auto path = firstParameterOf(model_, model_.components.size());
        for (std::size_t c = 0; c < J.size(); ++c) {
            const auto sensor = sensorOf(model_, record_.channels[c]);
            for (const auto& p : sensorParameters(record_.channels[c])) {
                const auto at = std::find(active_.begin(), active_.end(), path + p.place);
                if (at == active_.end())
                    continue;
                auto slope = predicted[c];
                for (std::size_t k = residual_.firstLine(); k <= residual_.lastLine(); ++k)
                    slope[k] *= sensor.logSlope(p.value, {0.0, step * static_cast<double>(k)});
                residual_.fill(c, slope, J[c].col(at - active_.begin()));
            }
        }
    }

    bool sensitivities(Sensors& sensors, std::vector<Eigen::MatrixXd>& J, int substeps) const
    {
        const bool same = substeps == options_.substeps;
        const auto own = same ? std::optional<Drive>() : Drive(input_, record_.sampleRate, substeps);
        std::vector<Trace> traces;  // of all channels, each once
        for (const auto quantity : record_.channels)
            for (const auto trace : sensors.tracesOf(quantity))
                if (std::find(traces.begin(), traces.end(), trace) == traces.end())
                    traces.push_back(trace);
        // As many parameters at once as their records leave room for.
        constexpr std::size_t room = 1 << 23;  // numbers
        const auto together = std::clamp<std::size_t>(room / (section_.window * traces.size()), 1, active_.size());
        for (std::size_t block = 0; block < active_.size(); block += together) {
            const std::span parameters(active_.data() + block, std::min(together, active_.size() - block));
            std::vector<Eigen::MatrixXd> slopes;
            if (!differentiate(model_, parameters, same ? *drive_ : *own, window_, traces, from_, slopes))
                return false;
            for (std::size_t c = 0; c < record_.channels.size(); ++c) {
                const auto made = sensors.tracesOf(record_.channels[c]);
                Eigen::MatrixXd rows(static_cast<Eigen::Index>(made.size()),
                                     static_cast<Eigen::Index>(section_.window));
                for (std::size_t b = 0; b < parameters.size(); ++b) {
                    for (std::size_t r = 0; r < made.size(); ++r) {
                        const auto place = std::find(traces.begin(), traces.end(), made[r]) - traces.begin();
                        rows.row(static_cast<Eigen::Index>(r)) = slopes[static_cast<std::size_t>(place)].row(
                            static_cast<Eigen::Index>(b));
                    }
                    if (!rows.isZero(0.0))
                        residual_.fill(c, sensors.slope(record_.channels[c], rows),
                                       J[c].col(static_cast<Eigen::Index>(block + b)));
                }
            }
        }
        return true;
    }

    const Model& model_;
    const Record& record_;
    const Section& section_;
    Residual residual_;
    const std::vector<Eigen::Index>& active_;
    const OutputErrorOptions& options_;
    const StepDivision& division_;
    const StartState& from_;
    const Paths* paths_;
    const DepartureResponse* departures_;
    std::vector<double> input_;
    std::optional<Drive> drive_;
    Window window_;
};

}  // namespace

std::size_t settlingTime(const Model& model, const Record& record)
{
    if (record.sections.empty() || !record.sections.front().periodic)
        return 0;
    constexpr double by110dB = 12.7, by60dB = 6.9;  // nepers
    Model base = model;
    base.components.resize(1);
    double needed = 0.0;  // s
    for (const auto& pole : poles(smallSignal(base)))
        if (pole.real() < 0.0)
            needed = std::max(needed, by110dB / -pole.real());
    const double slowest = 0.3 * 2.0 * std::numbers::pi * record.bandLow;
    if (model.components.size() > 1)
        for (const auto& pole : poles(smallSignal(model)))
            if (-pole.real() > slowest)
                needed = std::max(needed, by60dB / -pole.real());
    const auto period = static_cast<double>(record.sections.front().window);
    double least = 0.25;  // periods
    for (const auto& component : model.components)
        if (settles(component)) {
            const auto pace = paceOf(component, record.sampleRate);
            if (pace.steady)
                needed = std::max(needed, by60dB / pace.slowest);
            else  // it forgets by the way that the cone goes
                least = 2.0;
        }
    return static_cast<std::size_t>(std::clamp(needed * record.sampleRate, least * period, 4.0 * period));
}

std::vector<SectionFit> outputError(const Model& model, const Record& record, const std::vector<std::size_t>& sections,
                                    const std::vector<Eigen::Index>& active, const OutputErrorOptions& wanted,
                                    const Progress& progress)
{
    const auto leadIn = settlingTime(model, record);
    const bool gradient = wanted.gradient && !active.empty();
    OutputErrorOptions options = wanted;
    options.substeps = std::max(wanted.substeps, 1);
    if (gradient)
        options.gradientSubsteps = std::max(wanted.gradientSubsteps, stableSubsteps(model, record.sampleRate));
    const StepDivision division(model, record.sampleRate, options.threads);
    const auto from = startStates(model, record, sections, leadIn, gradient, options.threads);
    const auto ahead = record.channelIndex(Quantity::pressure) ? aheadOf(model, record.sampleRate) : 0;
    const auto paths = record.sectionsDrift || wanted.sectionsDrift
                           ? pathsToChannels(model, record, sections, false, options.threads)
                           : PathsByWindow {};
    const auto departures = departureResponses(model, record, sections, options.threads);
    std::vector<SectionFit> fits(sections.size());
    inParallel(sections.size(), options.threads, progress, [&](std::size_t n) {
        const auto& section = record.sections[sections[n]];
        fits[n] = SectionRun(model, record, section, active, options, division, leadIn, ahead, from[n],
                             ofWindow(paths, section), ofWindow(departures, section))
                      .run();
        return fits[n].finite;
    });
    return fits;
}

std::optional<NormalEquations> sumOf(const std::vector<SectionFit>& fits)
{
    NormalEquations sum;
    for (const auto& section : fits) {
        if (!section.finite)
            return std::nullopt;
        for (const auto& channel : section.channels)
            sum.add(channel);
    }
    return sum;
}

void SectionFit::pull(const Eigen::MatrixXd& more) { addTo(pulls, more); }

void SectionFit::keepSlopes(const std::vector<Eigen::Index>& places)
{
    for (auto& channel : channels)
        if (channel.N.size() > 0) {
            channel.N = channel.N(places, places).eval();
            channel.g = channel.g(places).eval();
        }
    for (auto& J : slopes)
        J = J(Eigen::all, places).eval();
    if (pulls.size() > 0)
        pulls = pulls(places, Eigen::all).eval();
    if (shared.size() > 0)
        shared = shared(places, places).eval();
}

Eigen::MatrixXd pullsOf(const std::vector<SectionFit>& fits, const Record& record,
                        const std::vector<std::size_t>& sections)
{
    std::map<int, Eigen::MatrixXd> byLevel;
    for (std::size_t s = 0; s < fits.size(); ++s)
        if (fits[s].pulls.size() > 0)
            addTo(byLevel[record.sections[sections[s]].level], fits[s].pulls);
    if (byLevel.empty())
        return {};
    const auto rows = byLevel.begin()->second.rows();
    Eigen::MatrixXd all(rows, Residual::bands * static_cast<Eigen::Index>(byLevel.size()));
    Eigen::Index column = 0;
    for (const auto& [level, pulls] : byLevel) {
        all.middleCols(column, Residual::bands) = pulls;
        column += Residual::bands;
    }
    return all;
}

Eigen::MatrixXd sharedOf(const std::vector<SectionFit>& fits)
{
    Eigen::MatrixXd sum;
    for (const auto& fit : fits)
        if (fit.shared.size() > 0)
            addTo(sum, fit.shared);
    return sum;
}

double worstPower(const std::vector<SectionFit>& fits)
{
    std::vector<ErrorPower> channels;
    for (const auto& section : fits) {
        channels.resize(section.power.size());
        for (std::size_t c = 0; c < channels.size(); ++c)
            channels[c].add(section.power[c]);
    }
    double worst = 0.0;
    for (const auto& channel : channels)
        worst = std::max(worst, channel.overNoise());
    return worst;
}

void addPrior(const Model& model, const std::vector<Eigen::Index>& active, NormalEquations& sum, double variance,
              const Eigen::VectorXd& slopes)
{
    const auto all = parametersOf(model);
    for (std::size_t j = 0; j < active.size(); ++j) {
        const auto& p = *all[static_cast<std::size_t>(active[j])];
        if (!std::isfinite(p.prior))
            continue;
        const double weight = variance / (p.prior * p.prior);
        sum.cost += weight * p.value * p.value;
        if (sum.N.size() > 0) {
            const auto k = static_cast<Eigen::Index>(j);
            const double slope = slopes.size() > 0 ? slopes[k] : 1.0;
            sum.N(k, k) += weight * slope * slope;
            sum.g[k] += weight * slope * p.value;
        }
    }
}

std::vector<Eigen::Index> freeParameters(const Model& model)
{
    std::vector<Eigen::Index> result;
    const auto all = parametersOf(model);
    for (std::size_t k = 0; k < all.size(); ++k)
        if (all[k]->free)
            result.push_back(static_cast<Eigen::Index>(k));
    return result;
}

}  // namespace excursion
