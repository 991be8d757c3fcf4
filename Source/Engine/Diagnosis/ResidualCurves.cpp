// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/ResidualCurves.h"

#include "Engine/Loudspeaker/Fit.h"
#include "Engine/Loudspeaker/Trajectory.h"
#include "Engine/Loudspeaker/SmallSignal.h"
#include "Engine/Loudspeaker/StartState.h"
#include "Engine/Numerics/LuFactors.h"
#include "Engine/Signal/Fft.h"
#include "Engine/Signal/Level.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace excursion {
namespace {

using Complex = std::complex<double>;

/// Error of displacement per line from the most direct channel; empty when there is none.
std::vector<Complex> displacementError(const Record& record, const Section& section, const SectionFit& fit)
{
    int order = 0;
    for (const auto quantity : {Quantity::displacement, Quantity::velocity, Quantity::acceleration}) {
        if (const auto c = record.channelIndex(quantity)) {
            std::vector<Complex> error(section.measured[*c].size());
            for (std::size_t k = 1; k < error.size(); ++k) {
                const Complex s(0.0, 2.0 * std::numbers::pi * record.frequency(section, k));
                error[k] = (section.measured[*c][k] - fit.predicted[*c][k]) / std::pow(s, order);
            }
            return error;
        }
        ++order;
    }
    return {};
}

/// The rows of the linear equations of motion that must be driven to repair the errors: with z the state that has the
/// wanted i and x, and memories that follow them, B_f force = (s - A) z in the row of v, and likewise for the voltage
/// in that of i.
class Repair {
public:
    explicit Repair(const Model& model) : linear_(smallSignal(model)), n_(linear_.A.rows()) {}

    struct Drives {
        Complex voltage, acceleration;
    };

    Drives at(Complex s, Complex i, Complex x) const
    {
        Eigen::VectorXcd z = Eigen::VectorXcd::Zero(n_);
        z[0] = i;
        z[1] = x;
        z[2] = s * x;
        const Eigen::Index m = n_ - 3;
        if (m > 0) {
            const Eigen::MatrixXcd system = s * Eigen::MatrixXcd::Identity(m, m)
                                            - linear_.A.bottomRightCorner(m, m).cast<Complex>();
            z.tail(m) = ComplexLu(system).solve(linear_.A.bottomLeftCorner(m, 3).cast<Complex>() * z.head(3));
        }
        const Eigen::VectorXcd rows = s * z.head(3) - linear_.A.topRows(3).cast<Complex>() * z;
        // B holds 1/inductance for a coil; of a mechanical-only driver 1/mass, in the row of v.
        return {linear_.B[0] > 0.0 ? rows[0] / linear_.B[0] : Complex {}, rows[2]};
    }

private:
    SmallSignal linear_;
    Eigen::Index n_;
};

struct Motions {
    std::vector<double> x, v, i, force, voltage, drive;
};

void bin(const std::vector<double>& argument, const std::vector<double>& value, ResidualCurve& curve)
{
    constexpr int bins = 41;
    const auto [low, high] = std::minmax_element(argument.begin(), argument.end());
    const double width = (*high - *low) / bins;
    if (!(width > 0.0))
        return;
    std::vector<double> count(bins, 0.0), sum(bins, 0.0), square(bins, 0.0);
    for (std::size_t n = 0; n < argument.size(); ++n) {
        const auto b = static_cast<std::size_t>(
            std::clamp(static_cast<int>((argument[n] - *low) / width), 0, bins - 1));
        count[b] += 1.0;
        sum[b] += value[n];
        square[b] += value[n] * value[n];
    }
    for (std::size_t b = 0; b < bins; ++b) {
        if (count[b] < 5.0)
            continue;
        const double mean = sum[b] / count[b];
        curve.argument.push_back(*low + width * (static_cast<double>(b) + 0.5));
        curve.mean.push_back(mean);
        curve.scatter.push_back(std::sqrt(std::max(0.0, square[b] / count[b] - mean * mean)));
    }
}

}  // namespace

std::vector<ResidualCurve> residualCurves(const Model& model, const Record& record,
                                          const std::vector<std::size_t>& sections, const std::vector<SectionFit>& fits)
{
    int loudest = -1;
    for (const auto n : sections)
        loudest = std::max(loudest, record.sections[n].level);
    const auto currentChannel = record.channelIndex(Quantity::current);
    const Repair repair(model);
    const double mass = model.baseParameter("m").value;
    const int substeps = stableSubsteps(model, record.sampleRate);
    const auto leadIn = settlingTime(model, record);
    const auto from = startStates(model, record, sections, leadIn, false, 1);
    Motions motions;
    bool seesForce = false, seesVoltage = false;
    for (std::size_t n = 0; n < sections.size(); ++n) {
        const auto& section = record.sections[sections[n]];
        if (section.level != loudest)
            continue;
        const auto ex = displacementError(record, section, fits[n]);
        if (ex.empty() || (model.electrical() && !currentChannel))
            return {};
        seesForce = true;
        seesVoltage = model.electrical();
        const std::size_t lines = section.window / 2 + 1;
        std::vector<Complex> force(lines), voltage(lines);
        // Above the band the second derivative of displacement is noise.
        for (std::size_t k = 1; k < lines; ++k) {
            const double f = record.frequency(section, k);
            if (f < 0.5 * record.bandLow || f > std::min(1.2 * record.bandHigh, record.highFrequency))
                continue;
            const Complex s(0.0, 2.0 * std::numbers::pi * f);
            const Complex ei = currentChannel && seesVoltage
                                   ? section.measured[*currentChannel][k] - fits[n].predicted[*currentChannel][k]
                                   : 0.0;
            const auto drives = repair.at(s, ei, ex[k]);
            // Displacement drowns in noise long before the band ends: keep the lines where it stands out.
            const auto c = record.channelIndex(Quantity::displacement);
            if (!c || !record.noiseKnown || std::abs(section.measured[*c][k]) > 3.0 * section.deviation[*c][k])
                force[k] = mass * drives.acceleration;
            voltage[k] = drives.voltage;
        }
        Trajectory run;
        const auto drive = record.drive(section, leadIn);
        if (!integrate(model, Drive(drive, record.sampleRate, substeps),
                       {drive.size() - section.window, 0, section.periodic}, run, from[n].value))
            return {};
        const auto append = [](std::vector<double>& to, const std::vector<double>& from) {
            to.insert(to.end(), from.begin(), from.end());
        };
        append(motions.drive, {drive.end() - static_cast<std::ptrdiff_t>(section.window), drive.end()});
        append(motions.x, run.displacement);
        append(motions.v, run.velocity);
        append(motions.i, run.current);
        append(motions.force, inverseFft(force, section.window));
        append(motions.voltage, inverseFft(voltage, section.window));
    }
    std::vector<ResidualCurve> curves;
    const auto add = [&](const char* residual, const char* unit, const std::vector<double>& value, double driveRms) {
        const double db = 20.0 * std::log10(std::max(rmsOf(value), 1e-300) / std::max(driveRms, 1e-300));
        const auto against = [&](const char* name, const char* argumentUnit, const std::vector<double>& argument) {
            ResidualCurve curve {residual, unit, name, argumentUnit, {}, {}, {}, db};
            bin(argument, value, curve);
            if (!curve.argument.empty())
                curves.push_back(std::move(curve));
        };
        against("x", "m", motions.x);
        against("v", "m/s", motions.v);
        if (model.electrical())
            against("i", "A", motions.i);
    };
    if (seesForce)
        add("force", "N", motions.force,
            model.electrical() ? model.baseParameter("Bl").value * rmsOf(motions.i) : rmsOf(motions.drive));
    if (seesVoltage)
        add("voltage", "V", motions.voltage, rmsOf(motions.drive));
    return curves;
}

}  // namespace excursion
