// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Driver/OutputError.h"

#include "Engine/Driver/Linearize.h"
#include "Engine/Driver/Simulate.h"
#include "Engine/Driver/StartState.h"
#include "Engine/Signal/Fft.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <numbers>
#include <thread>

namespace excursion {
namespace {

using Spectrum = std::vector<std::complex<double>>;

/// The trajectory's record that a channel observes; pressure is made of acceleration.
const std::vector<double>& observed(const Trajectory& run, Quantity quantity)
{
    switch (quantity) {
    case Quantity::current: return run.current;
    case Quantity::displacement: return run.displacement;
    case Quantity::velocity: return run.velocity;
    default: return run.acceleration;
    }
}

/// Whether a law is at work whose memory forgets by the way that the cone goes, and not in time.
bool remembersWay(const Component& component)
{
    const auto& effect = *component.effect;
    return !effect.linear() && !effect.slow() && effect.memorySize(component.extent) > 0
        && std::any_of(component.parameters.begin(), component.parameters.end(), [](const Parameter& p) { return p.strength && p.value != 0.0; });
}

std::complex<double> pathResponse(const Model& model, double frequency)
{
    const double gain = radiationPerArea() * model.path[0].value / model.microphoneDistance;
    return std::polar(gain, -2.0 * std::numbers::pi * frequency * model.path[1].value);
}

class SectionRun {
public:
    SectionRun(const Model& model, const Record& record, const Section& section, const std::vector<Eigen::Index>& active,
               const OutputErrorOptions& options, std::size_t leadIn, const StartState& from)
        : model_(model), record_(record), section_(section), active_(active), options_(options), from_(from)
    {
        std::tie(first_, last_) = record.lineRange(section);
        const auto drive = record.drive(section, leadIn);
        drive_.emplace(drive, record.sampleRate, options.substeps);
        if (options.gradient && options.gradientSubsteps != options.substeps)
            gradientDrive_.emplace(drive, record.sampleRate, options.gradientSubsteps);
        start_ = drive.size() - section.window;
    }

    SectionFit run()
    {
        SectionFit fit;
        const auto channels = record_.channels.size();
        const auto lines = static_cast<Eigen::Index>(last_ - first_ + 1);
        const auto columns = static_cast<Eigen::Index>(active_.size());

        Trajectory trajectory;
        fit.finite = integrate(model_, *drive_, start_, trajectory, from_.value);
        if (!fit.finite)
            return fit;
        fit.channels.resize(channels);
        fit.power.resize(channels);
        std::vector<Eigen::VectorXd> residual(channels, Eigen::VectorXd(2 * lines));
        std::vector<Spectrum> predicted(channels);
        for (std::size_t c = 0; c < channels; ++c) {
            predicted[c] = spectrumOf(observed(trajectory, record_.channels[c]), record_.channels[c]);
            residualOf(c, predicted[c], residual[c], fit.power[c]);
            fit.channels[c].cost = residual[c].squaredNorm();
            fit.channels[c].rows = static_cast<double>(2 * lines);
        }
        if (options_.gradient && columns > 0) {
            std::vector<Eigen::MatrixXd> J(channels, Eigen::MatrixXd::Zero(2 * lines, columns));
            if (!sensitivities(predicted, J)) {
                fit.finite = false;
                return fit;
            }
            for (std::size_t c = 0; c < channels; ++c) {
                fit.channels[c].N.noalias() = J[c].transpose() * J[c];
                fit.channels[c].g.noalias() = J[c].transpose() * residual[c];
            }
        }
        if (options_.spectra)
            fit.predicted = std::move(predicted);
        return fit;
    }

private:
    Spectrum spectrumOf(const std::vector<double>& samples, Quantity quantity) const
    {
        auto spectrum = fft(samples);
        if (quantity == Quantity::pressure)
            for (std::size_t k = 0; k < spectrum.size(); ++k)
                spectrum[k] *= pathResponse(model_, record_.frequency(section_, k));
        return spectrum;
    }

    void residualOf(std::size_t c, const Spectrum& predicted, Eigen::VectorXd& r, ErrorPower& power) const
    {
        const auto& measured = section_.measured[c];
        const auto& deviation = section_.deviation[c];
        const auto lines = static_cast<Eigen::Index>(last_ - first_ + 1);
        for (Eigen::Index n = 0; n < lines; ++n) {
            const auto k = first_ + static_cast<std::size_t>(n);
            const auto error = predicted[k] - measured[k];
            const double weight = std::numbers::sqrt2 / deviation[k];
            r[n] = weight * error.real();
            r[lines + n] = weight * error.imag();
            power.error += std::norm(error);
            power.measured += std::norm(measured[k]);
            power.noise += deviation[k] * deviation[k];
        }
    }

    void fill(std::size_t c, const Spectrum& derivative, Eigen::Ref<Eigen::VectorXd> column) const
    {
        const auto& deviation = section_.deviation[c];
        const auto lines = static_cast<Eigen::Index>(last_ - first_ + 1);
        for (Eigen::Index n = 0; n < lines; ++n) {
            const auto k = first_ + static_cast<std::size_t>(n);
            const double weight = std::numbers::sqrt2 / deviation[k];
            column[n] = weight * derivative[k].real();
            column[lines + n] = weight * derivative[k].imag();
        }
    }

    bool sensitivities(const std::vector<Spectrum>& predicted, std::vector<Eigen::MatrixXd>& J) const
    {
        const auto dynamicCount = static_cast<Eigen::Index>(parametersOf(model_).size() - model_.path.size());
        std::vector<std::size_t> dynamic;   // columns whose parameter acts through the equations of motion
        for (std::size_t j = 0; j < active_.size(); ++j)
            if (active_[j] < dynamicCount)
                dynamic.push_back(j);
            else
                pathSensitivity(active_[j] - dynamicCount, j, predicted, J);

        // As many parameters at once as their records leave room for.
        constexpr std::size_t room = 1 << 23;   // numbers
        const auto together = std::clamp<std::size_t>(room / (section_.window * record_.channels.size()), 1, std::max<std::size_t>(dynamic.size(), 1));
        std::vector<double> samples(section_.window);
        for (std::size_t block = 0; block < dynamic.size(); block += together) {
            std::vector<Eigen::Index> parameters;
            for (std::size_t b = block; b < std::min(block + together, dynamic.size()); ++b)
                parameters.push_back(active_[dynamic[b]]);
            std::vector<Eigen::MatrixXd> slopes;
            if (!differentiate(model_, parameters, gradientDrive_ ? *gradientDrive_ : *drive_, start_, record_.channels, from_, slopes))
                return false;
            for (std::size_t c = 0; c < record_.channels.size(); ++c)
                for (std::size_t b = 0; b < parameters.size(); ++b) {
                    for (std::size_t n = 0; n < samples.size(); ++n)
                        samples[n] = slopes[c](static_cast<Eigen::Index>(b), static_cast<Eigen::Index>(n));
                    fill(c, spectrumOf(samples, record_.channels[c]), J[c].col(static_cast<Eigen::Index>(dynamic[block + b])));
                }
        }
        return true;
    }

    /// The path is linear and known in closed form: dP/dSd = P/Sd, dP/dtau = -j w P.
    void pathSensitivity(Eigen::Index which, std::size_t column, const std::vector<Spectrum>& predicted,
                         std::vector<Eigen::MatrixXd>& J) const
    {
        const auto c = record_.channelIndex(Quantity::pressure);
        if (!c)
            return;
        auto derivative = predicted[*c];
        for (std::size_t k = 0; k < derivative.size(); ++k)
            derivative[k] *= which == 0 ? std::complex<double>(1.0 / model_.path[0].value)
                                        : std::complex<double>(0.0, -2.0 * std::numbers::pi * record_.frequency(section_, k));
        fill(*c, derivative, J[*c].col(static_cast<Eigen::Index>(column)));
    }

    const Model& model_;
    const Record& record_;
    const Section& section_;
    const std::vector<Eigen::Index>& active_;
    const OutputErrorOptions& options_;
    const StartState& from_;
    std::optional<Drive> drive_, gradientDrive_;
    std::size_t first_ = 0, last_ = 0, start_ = 0;
};

} // namespace

void NormalEquations::add(const NormalEquations& other)
{
    if (N.size() == 0) {
        N = other.N;
        g = other.g;
    } else if (other.N.size() > 0) {
        N += other.N;
        g += other.g;
    }
    cost += other.cost;
    rows += other.rows;
}

std::size_t settlingTime(const Model& model, const Record& record)
{
    if (record.sections.empty() || !record.sections.front().periodic)
        return 0;
    constexpr double by110dB = 12.7, by60dB = 6.9;   // nepers
    Model base = model;
    base.components.resize(1);
    double needed = 0.0;   // s
    for (const auto& pole : poles(linearize(base)))
        if (pole.real() < 0.0)
            needed = std::max(needed, by110dB / -pole.real());
    const double slowest = 0.3 * 2.0 * std::numbers::pi * record.bandLow;
    if (model.components.size() > 1)
        for (const auto& pole : poles(linearize(model)))
            if (-pole.real() > slowest)
                needed = std::max(needed, by60dB / -pole.real());
    const auto period = static_cast<double>(record.sections.front().window);
    const double least = std::any_of(model.components.begin(), model.components.end(), remembersWay) ? 2.0 : 0.25;   // periods
    return static_cast<std::size_t>(std::clamp(needed * record.sampleRate, least * period, 4.0 * period));
}

std::vector<SectionFit> outputError(const Model& model, const Record& record, const std::vector<std::size_t>& sections,
                                    const std::vector<Eigen::Index>& active, const OutputErrorOptions& wanted,
                                    const Progress& progress)
{
    const auto leadIn = settlingTime(model, record);
    const int stable = stableSubsteps(model, record.sampleRate);
    OutputErrorOptions options = wanted;
    options.substeps = std::max(wanted.substeps, stable);
    options.gradientSubsteps = std::min(options.substeps, std::max(wanted.gradientSubsteps, stable));
    const auto from = startStates(model, record, sections, leadIn, options.gradient && !active.empty());
    std::vector<SectionFit> fits(sections.size());
    std::atomic<std::size_t> next {0};
    std::atomic<bool> failed {false};
    std::exception_ptr failure;
    std::mutex failureMutex;
    const auto work = [&] {
        for (std::size_t n = next++; n < sections.size() && !failed; n = next++) {
            try {
                if (progress.stop.stop_requested())
                    break;
                fits[n] = SectionRun(model, record, record.sections[sections[n]], active, options, leadIn, from[n]).run();
                if (!fits[n].finite)
                    failed = true;
            } catch (...) {
                const std::lock_guard lock(failureMutex);
                failure = std::current_exception();
                failed = true;
            }
        }
    };
    {
        std::vector<std::jthread> threads;
        for (unsigned t = 1; t < std::min<std::size_t>(options.threads, sections.size()); ++t)
            threads.emplace_back(work);
        work();
    }
    if (failure)
        std::rethrow_exception(failure);
    if (progress.stop.stop_requested())
        progress.at(0.0, "");
    return fits;
}

void addPrior(const Model& model, const std::vector<Eigen::Index>& active, NormalEquations& sum)
{
    const auto all = parametersOf(model);
    for (std::size_t j = 0; j < active.size(); ++j) {
        const auto& p = *all[static_cast<std::size_t>(active[j])];
        if (!std::isfinite(p.prior))
            continue;
        const double weight = 1.0 / (p.prior * p.prior);
        sum.cost += weight * p.value * p.value;
        if (sum.N.size() > 0) {
            const auto k = static_cast<Eigen::Index>(j);
            sum.N(k, k) += weight;
            sum.g[k] += weight * p.value;
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

std::vector<std::size_t> estimationSections(const Record& record)
{
    std::vector<std::size_t> result;
    for (std::size_t n = 0; n < record.sections.size(); ++n)
        if (!record.sections[n].validation)
            result.push_back(n);
    return result;
}

std::vector<std::size_t> validationSections(const Record& record)
{
    std::vector<std::size_t> result;
    for (std::size_t n = 0; n < record.sections.size(); ++n)
        if (record.sections[n].validation)
            result.push_back(n);
    if (result.empty())
        return estimationSections(record);
    return result;
}

} // namespace excursion
