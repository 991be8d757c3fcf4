// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"
#include "Engine/Loudspeaker/StartState.h"
#include "Engine/Progress.h"
#include "Engine/Take/Measurement.h"

#include <array>
#include <span>
#include <vector>

namespace excursion {

/// A record that a simulation leaves: of the coil's motion, and of what leaves the driver (Emission; flow is area times
/// acceleration).
enum class Trace { current, displacement, velocity, acceleration, flow, lateness, spot };
inline constexpr std::size_t traceCount = 7;

/// What the driver does, sample by sample. Every vector has one value a sample.
struct Trajectory {
    std::vector<double> current, displacement, velocity, acceleration;  ///< A, m, m/s, m/s^2
    std::vector<double> flow, lateness, spot;                           ///< m^3/s^2, s, m

    const std::vector<double>& operator[](Trace) const;
};

/// A voltage (or force) record, upsampled so that steps find the band-limited input between the samples.
class Drive {
public:
    /// @param samples     V (or N), starting from silence
    /// @param sampleRate  Hz
    /// @param substeps    integration steps a sample
    Drive(std::span<const double> samples, double sampleRate, int substeps);

    std::size_t length() const { return length_; }  ///< samples
    int substeps() const { return substeps_; }
    double step() const { return step_; }  ///< s
    double at(std::size_t halfStep) const { return halfStep < fine_.size() ? fine_[halfStep] : 0.0; }

    /// Coefficients of the input on the step that starts there, u(s) = sum u_k s^k, 0 <= s <= 1: through the values at
    /// half steps from one step before to one step after it; beyond the ends the record is reflected oddly, as by
    /// upsample().
    std::array<double, 7> polynomial(std::size_t halfStep) const;

private:
    std::size_t length_;
    int substeps_;
    double step_;
    std::vector<double> fine_;  // two values a step
};

/// Integrates the model from rest, or from another state (ExponentialStep).
/// @param first  the trajectory is kept from this sample on
/// @param start  state z of Dynamics at the drive's first sample; empty: rest
/// @returns false when the state leaves the finite numbers or any plausible range; the trajectory is then void
bool integrate(const Model&, const Drive&, std::size_t first, Trajectory& out, const Eigen::VectorXd& start = {});

/// Derivatives of the trajectory by parameters of the model (SensitivityStep).
/// @param active    the parameters, in the order of parametersOf()
/// @param observed  the traces to differentiate
/// @param start     state at the drive's first sample and its derivatives by all parameters; empty: rest
/// @param out       one matrix an observed trace, parameters x samples
bool differentiate(const Model&, std::span<const Eigen::Index> active, const Drive&, std::size_t first,
                   const std::vector<Trace>& observed, const StartState& start, std::vector<Eigen::MatrixXd>& out);

/// The fewest steps a sample, at most 64, with which the laws' fastest eigenvalue times the step stays within the
/// limit; by default that up to which both of the above are stable.
int stableSubsteps(const Model&, double sampleRate, double limit = 2.0);

struct SimulationOptions {
    double tolerance = 1e-5;  ///< largest relative rms change of any channel when the step is halved
    int maximumSubsteps = 64;
    bool isValid(std::string* reason) const;
};

struct SimulationSummary {
    int substeps = 0;
    double accuracy = 1.0;   ///< relative rms change against a run with half the step, worst channel
    bool converged = false;  ///< accuracy is within the tolerance
};

/// The number of steps a sample that reaches the tolerance on (a stretch of) this input.
SimulationSummary chooseSubsteps(const Model&, std::span<const double> input, double sampleRate,
                                 const SimulationOptions&);

/// Simulates all channels (the input, current, displacement, velocity, acceleration and pressure) from an input record,
/// with the step halved until the tolerance is reached. Throws Error (numerical) when the model runs away.
Measurement simulate(const Model&, std::span<const double> input, double sampleRate, const SimulationOptions&,
                     SimulationSummary* = nullptr, const Progress& = {});

}  // namespace excursion
