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
#include <iterator>
#include <limits>
#include <numbers>
#include <numeric>

namespace excursion {
namespace {

using Complex = std::complex<double>;

/// The displacement per line that spectra of all channels tell most directly; empty if none does.
std::vector<Complex> displacementOf(const Record& record, const Section& section,
                                    const std::vector<std::vector<Complex>>& channels)
{
    int order = 0;
    for (const auto quantity : {Quantity::displacement, Quantity::velocity, Quantity::acceleration}) {
        if (const auto c = record.channelIndex(quantity)) {
            std::vector<Complex> displacement(channels[*c].size());
            for (std::size_t k = 1; k < displacement.size(); ++k) {
                const Complex s(0.0, 2.0 * std::numbers::pi * record.frequency(section, k));
                displacement[k] = channels[*c][k] / std::pow(s, order);
            }
            return displacement;
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

/// What the two balances lack in a section, as spectra of its window.
struct Lack {
    std::vector<Complex> force, voltage;  ///< N, V; zero outside the band
};

/// Finds what a model lacks from the errors of its simulation.
class Lacking {
public:
    Lacking(const Model& model, const Record& record)
        : record_(record), repair_(model), mass_(model.baseParameter("m").value), electrical_(model.electrical())
    {
    }

    /// Whether the channels tell the errors of displacement, and of current where there is a coil.
    bool isTold() const
    {
        const bool moves = record_.channelIndex(Quantity::displacement) || record_.channelIndex(Quantity::velocity)
                           || record_.channelIndex(Quantity::acceleration);
        return moves && (!electrical_ || record_.channelIndex(Quantity::current));
    }

    Lack in(const Section& section, const SectionFit& fit) const
    {
        auto error = section.measured;
        for (std::size_t c = 0; c < error.size(); ++c)
            for (std::size_t k = 0; k < error[c].size(); ++k)
                error[c][k] -= fit.predicted[c][k];
        const auto ex = displacementOf(record_, section, error);
        const std::size_t lines = section.window / 2 + 1;
        Lack lack {std::vector<Complex>(lines), std::vector<Complex>(lines)};
        // Above the band the second derivative of displacement is noise.
        for (std::size_t k = 1; k < lines; ++k) {
            const double f = record_.frequency(section, k);
            if (f < 0.5 * record_.bandLow || f > std::min(1.2 * record_.bandHigh, record_.highFrequency))
                continue;
            const Complex s(0.0, 2.0 * std::numbers::pi * f);
            const auto drives = repair_.at(s, electrical_ ? error[*record_.channelIndex(Quantity::current)][k] : 0.0,
                                           ex[k]);
            // Displacement drowns in noise long before the band ends: keep the lines where it stands out.
            const auto c = record_.channelIndex(Quantity::displacement);
            if (!c || !record_.noiseKnown || std::abs(section.measured[*c][k]) > 3.0 * section.deviation[*c][k])
                lack.force[k] = mass_ * drives.acceleration;
            lack.voltage[k] = drives.voltage;
        }
        return lack;
    }

private:
    const Record& record_;
    Repair repair_;
    double mass_;
    bool electrical_;
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

/// The real number a that a balance lacks by a product with a motion: what it lacks is -a times that.
struct Multiple {
    double value = std::numeric_limits<double>::quiet_NaN();  ///< where nothing tells it
    /// its standard error from what is no such product, line by line: high lines scatter far more than low ones
    double error = std::numeric_limits<double>::quiet_NaN();
};

Multiple multipleOf(const std::vector<Complex>& motion, const std::vector<Complex>& lack)
{
    const auto along = [&](std::size_t k, Complex of) { return std::real(std::conj(motion[k]) * of); };
    double product = 0.0, square = 0.0, scatter = 0.0;
    for (std::size_t k = 0; k < lack.size(); ++k)
        if (lack[k] != 0.0) {
            product -= along(k, lack[k]);
            square += std::norm(motion[k]);
        }
    if (!(square > 0.0))
        return {};
    const double value = product / square;
    for (std::size_t k = 0; k < lack.size(); ++k)
        if (lack[k] != 0.0)
            scatter += std::pow(along(k, lack[k] + value * motion[k]), 2);
    return {value, std::sqrt(scatter) / square};
}

void add(ResidualCurve& curve, double time, const Multiple& multiple)
{
    curve.argument.push_back(time);
    curve.mean.push_back(multiple.value);
    curve.scatter.push_back(multiple.error);
}

}  // namespace

std::vector<ResidualCurve> residualCurves(const Model& model, const Record& record,
                                          const std::vector<std::size_t>& sections, const std::vector<SectionFit>& fits)
{
    int loudest = -1;
    for (const auto n : sections)
        loudest = std::max(loudest, record.sections[n].level);
    const Lacking lacking(model, record);
    if (!lacking.isTold())
        return {};
    const StepDivision division(model, record.sampleRate, 1);
    const auto leadIn = settlingTime(model, record);
    const auto from = startStates(model, record, sections, leadIn, false, 1);
    Motions motions;
    for (std::size_t n = 0; n < sections.size(); ++n) {
        const auto& section = record.sections[sections[n]];
        if (section.level != loudest)
            continue;
        const auto lack = lacking.in(section, fits[n]);
        Trajectory run;
        const auto drive = record.drive(section, leadIn);
        if (!integrate(model, Drive(drive, record.sampleRate, 1), division,
                       {drive.size() - section.window, 0, section.periodic}, run, from[n].value))
            return {};
        const auto append = [](std::vector<double>& to, const std::vector<double>& from) {
            to.insert(to.end(), from.begin(), from.end());
        };
        append(motions.drive, {drive.end() - static_cast<std::ptrdiff_t>(section.window), drive.end()});
        append(motions.x, run.displacement);
        append(motions.v, run.velocity);
        append(motions.i, run.current);
        append(motions.force, inverseFft(lack.force, section.window));
        append(motions.voltage, inverseFft(lack.voltage, section.window));
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
    if (motions.x.empty())
        return {};
    add("force", "N", motions.force,
        model.electrical() ? model.baseParameter("Bl").value * rmsOf(motions.i) : rmsOf(motions.drive));
    if (model.electrical())
        add("voltage", "V", motions.voltage, rmsOf(motions.drive));
    return curves;
}

std::vector<std::size_t> sectionsInTime(const Record& record)
{
    std::vector<std::size_t> order(record.sections.size());
    std::iota(order.begin(), order.end(), std::size_t {0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return record.sections[a].middle < record.sections[b].middle;
    });
    return order;
}

std::vector<ResidualCurve> curvesOverTime(const Model& model, const Record& record, const std::vector<SectionFit>& fits)
{
    constexpr std::size_t fewest = 3;
    const Lacking lacking(model, record);
    if (!lacking.isTold() || record.sections.size() < fewest
        || std::any_of(fits.begin(), fits.end(), [](const SectionFit& fit) { return !fit.finite; }))
        return {};
    ResidualCurve stiffness {"stiffness", "N/m", "t", "s", {}, {}, {}, 0.0},
        resistance {"resistance", "ohm", "t", "s", {}, {}, {}, 0.0};
    for (const auto n : sectionsInTime(record)) {
        const auto& section = record.sections[n];
        const auto lack = lacking.in(section, fits[n]);
        // What the comparison follows is no part of what is left.
        const auto& followed = fits[n].drift;
        auto softer = multipleOf(displacementOf(record, section, section.measured), lack.force);
        softer.value += followed.stiffness * model.baseParameter("K").value;
        add(stiffness, section.middle, softer);
        if (model.electrical()) {
            auto warmer = multipleOf(section.measured[*record.channelIndex(Quantity::current)], lack.voltage);
            warmer.value += followed.resistance * model.baseParameter("Re").value;
            add(resistance, section.middle, warmer);
        }
    }
    std::vector<ResidualCurve> curves;
    const auto keep = [&](ResidualCurve& curve, const char* base) {
        std::vector<double> known;
        std::copy_if(curve.mean.begin(), curve.mean.end(), std::back_inserter(known),
                     [](double value) { return std::isfinite(value); });
        if (known.empty())
            return;
        curve.db = 20.0 * std::log10(std::max(rmsOf(known), 1e-300) / model.baseParameter(base).value);
        curves.push_back(std::move(curve));
    };
    keep(stiffness, "K");
    if (model.electrical())
        keep(resistance, "Re");
    return curves;
}

}  // namespace excursion
