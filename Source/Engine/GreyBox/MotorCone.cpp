// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/GreyBox/MotorCone.h"

#include "Engine/Error.h"
#include "Engine/GreyBox/CascadeRefinement.h"
#include "Engine/Linear/DelayedFit.h"
#include "Engine/Linear/PoleZero.h"
#include "Engine/Linear/Response.h"
#include "Engine/Numerics/LuFactors.h"
#include "Engine/Numerics/QrFactors.h"
#include "Engine/Validity.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXd;

std::string hertz(double f) { return std::to_string(std::lround(f)) + " Hz"; }

void requireTogether(const FrequencyData& displacement, const FrequencyData& pressure)
{
    std::string reason;
    for (const auto* data : {&displacement, &pressure}) {
        if (!data->isValid(&reason))
            throw Error(Error::Kind::data, "Motor and cone cannot be told from these responses: " + reason + ".");
        if (data->value.cols() != 1)
            throw Error(Error::Kind::data,
                        "Motor and cone are told from one displacement and one pressure, each to one voltage.");
    }
    if (displacement.frequency != pressure.frequency)
        throw Error(Error::Kind::data, "Displacement and pressure must be given at the same frequencies.");
    if (!(displacement.frequency.front() > 0.0))
        throw Error(Error::Kind::data, "Motor and cone are told at frequencies above 0 Hz.");
    if (!(displacement.value.cwiseAbs().minCoeff() > 0.0))
        throw Error(Error::Kind::data,
                    "The displacement is zero at a frequency, so there is no cone to be told there.");
}

/// States x, dx/dt [, d2x/dt2] first, what is left at right angles to them; outputs displacement, velocity,
/// acceleration.
StateSpace withMotion(const StateSpace& motor, Index relativeDegree)
{
    const auto n = motor.order();
    MatrixXd derivatives(3, n);
    derivatives.row(0) = motor.C;
    for (Index k = 1; k < 3; ++k)
        derivatives.row(k) = derivatives.row(k - 1) * motor.A;
    // Lengths first: the rows are apart by the poles' sizes.
    MatrixXd inverse(n, n);
    inverse.topRows(relativeDegree) = derivatives.topRows(relativeDegree).rowwise().normalized();
    const MatrixXd basis = completedBasis(inverse.topRows(relativeDegree).transpose());
    inverse.bottomRows(n - relativeDegree) = basis.rightCols(n - relativeDegree).transpose();
    MatrixXd T = RealLu(inverse).inverse();
    for (Index k = 0; k < relativeDegree; ++k)
        T.col(k) /= derivatives.row(k).norm();
    auto result = transformed(motor, T);
    result.C = derivatives * T;
    result.D = MatrixXd::Zero(3, 1);
    // What the constraint and the basis say is zero or one, is.
    for (Index k = 0; k < relativeDegree; ++k) {
        result.C.row(k) = Eigen::RowVectorXd::Unit(n, k);
        if (k + 1 < relativeDegree) {
            result.A.row(k) = Eigen::RowVectorXd::Unit(n, k + 1);
            result.B(k, 0) = 0.0;
        }
    }
    if (relativeDegree == 2) {
        result.C.row(2) = result.A.row(1);
        result.D(2, 0) = result.B(1, 0);
    }
    return result;
}

/// What is known of both halves between the steps.
struct Halves {
    PartialFractionFit motor, cone;
    SearchSummary motorRefinement, coneRefinement;
};

StateSpace modelOf(const PartialFractionFit& fit) { return realize(fit.sections, fit.C, fit.D); }

bool explained(double chiSquared, Index lines)
{
    const auto K = static_cast<double>(lines);
    return chiSquared <= K + 5.0 * std::sqrt(K);  // one that is not known explains nothing
}

IdentifyOptions identifyOptions(const MotorConeOptions& options, int order)
{
    IdentifyOptions identifying;
    identifying.order = order;
    identifying.thorough = options.thorough;
    identifying.refinement = options.refinement;
    identifying.refinement.stable = true;
    return identifying;
}

void findMotor(const FrequencyData& displacement, const MotorConeOptions& options, Halves& halves,
               const Progress& progress)
{
    const auto identifying = identifyOptions(options, options.motorOrder);
    auto start = *identify(displacement, identifying, progress).sections;
    start.relativeDegree = options.relativeDegree;
    const auto refined = refinePoles(start, displacement, identifying.refinement);
    halves.motor = refined.fit;
    halves.motorRefinement = refined;
}

/// P/(s^2 X), X the motor's where that is asked for or the displacement is not told.
void divide(const FrequencyData& displacement, const FrequencyData& pressure, const StateSpace& motor,
            double leastSignalDb, MotorCone& result)
{
    const bool known = displacement.deviation.size() != 0;
    const double least = std::pow(10.0, leastSignalDb / 20.0);
    auto& cone = result.coneResponse;
    cone = pressure;
    result.told.assign(displacement.frequency.size(), true);
    const Resolvent resolvent(motor);
    const auto points = evaluationPoints(cone.frequency, 0.0);
    Eigen::VectorXcd modelled(points.size());
    double relativeError = 0.0;
    for (Index k = 0; k < cone.lines(); ++k) {
        modelled[k] = resolvent.response(points[k])(0, 0);
        if (known && std::abs(modelled[k]) < least * displacement.deviation(k, 0))
            result.told[static_cast<std::size_t>(k)] = false;
        else
            relativeError += std::norm(modelled[k] / displacement.value(k, 0) - 1.0);
    }
    relativeError = std::sqrt(
        relativeError / std::max(1.0, static_cast<double>(std::count(result.told.begin(), result.told.end(), true))));
    for (Index k = 0; k < cone.lines(); ++k) {
        const Complex s = points[k];
        const bool told = result.told[static_cast<std::size_t>(k)];
        const bool measured = told && result.from == ConeFrom::quotient;
        const Complex moved = measured ? displacement.value(k, 0) : modelled[k];
        if (told)
            result.toldUpTo = cone.frequency[static_cast<std::size_t>(k)];
        cone.value(k, 0) = pressure.value(k, 0) / (s * s * moved);
        if (cone.deviation.size() == 0)
            continue;
        // |G| r_p is finite where the pressure itself happens to be zero.
        const double ofPressure = pressure.deviation(k, 0) / std::abs(s * s * moved);
        double relative = 0.0;  // r_x
        if (result.from == ConeFrom::quotient)
            relative = !measured ? relativeError : known ? displacement.deviation(k, 0) / std::abs(moved) : 0.0;
        cone.deviation(k, 0) = std::hypot(ofPressure, relative * std::abs(cone.value(k, 0)));
    }
}

StateSpace accelerated(const StateSpace& motor)
{
    auto result = motor;
    result.C = motor.C.row(2).eval();
    result.D = motor.D.row(2).eval();
    return result;
}

/// Motor and cone together, kept if the motor still explains the displacement.
void refineTogether(const FrequencyData& displacement, const FrequencyData& pressure, const MotorConeOptions& options,
                    Halves& halves, MotorCone& result)
{
    auto refinement = options.refinement;
    refinement.maximumIterations = std::max(refinement.maximumIterations, 100);
    const auto together = refineCascade(halves.motor, halves.cone, displacement, pressure, refinement);
    if (!explained(judged(modelOf(together.first), displacement).chiSquared, displacement.lines()))
        return;
    halves = {together.first, together.second, together, together};
    result.refined = true;
    divide(displacement, pressure, modelOf(halves.motor), options.leastSignalDb, result);
}

std::string sentenceFor(const MotorCone& result, bool known, double leastSignalDb)
{
    if (!known)
        return "The noise of the displacement is not known, so neither is how far motor and cone can be told apart.";
    const auto all = result.told.size(),
               count = static_cast<std::size_t>(std::count(result.told.begin(), result.told.end(), true));
    const std::string level = std::to_string(std::lround(leastSignalDb)) + " dB above its noise";
    if (count == all)
        return "The displacement stands at least " + level
               + " at all frequencies, so motor and cone are told apart at all of them.";
    return "The displacement stands at least " + level + " at " + std::to_string(count) + " of " + std::to_string(all)
           + " frequencies, the highest of them " + hertz(result.toldUpTo)
           + "; elsewhere only motor and cone together are measured, and how they share rests on the motor's model.";
}

}  // namespace

bool MotorConeOptions::isValid(std::string* reason) const
{
    if (relativeDegree != 2 && relativeDegree != 3)
        return refuse(reason, "the relative degree of a displacement is 2 or 3");
    if (motorOrder < relativeDegree || motorOrder > 100 || coneOrder < 0 || coneOrder > 400)
        return refuse(reason,
                      "the motor's order must lie between its relative degree and 100, the cone's between 0 and 400");
    if (!std::isfinite(delay) || !(leastSignalDb >= 0.0) || !std::isfinite(leastSignalDb))
        return refuse(reason,
                      "the delay must be finite, and the least level of the displacement 0 dB above its noise or more");
    return refinement.isValid(reason);
}

MotorCone identifyMotorCone(const FrequencyData& displacement, const FrequencyData& pressure,
                            const MotorConeOptions& options, const Progress& progress)
{
    std::string reason;
    if (!options.isValid(&reason))
        throw Error(Error::Kind::usage, "Motor and cone cannot be identified: " + reason + ".");
    requireTogether(displacement, pressure);
    const auto prompt = delayed(pressure, -options.delay);
    const bool known = displacement.deviation.size() != 0;
    MotorCone result;

    Halves halves;
    findMotor(displacement, options, halves, progress.part(0.0, 0.3));
    result.from = options.from;
    if (options.from == ConeFrom::automatic)
        result.from = explained(judged(modelOf(halves.motor), displacement).chiSquared, displacement.lines())
                          ? ConeFrom::motor
                          : ConeFrom::quotient;
    divide(displacement, prompt, modelOf(halves.motor), options.leastSignalDb, result);
    if (std::count(result.told.begin(), result.told.end(), true) <= options.coneOrder)
        throw Error(Error::Kind::data,
                    "The displacement stands out of its noise at too few frequencies to tell a cone of order "
                        + std::to_string(options.coneOrder) + " from the motor.");
    const auto found = identify(result.coneResponse, identifyOptions(options, options.coneOrder),
                                progress.part(0.3, 0.9));
    halves.cone = fitPartialFractions(*found.sections, result.coneResponse);
    halves.coneRefinement = found.refinement;
    if (options.from == ConeFrom::automatic && result.from == ConeFrom::motor && prompt.deviation.size() != 0)
        refineTogether(displacement, prompt, options, halves, result);

    const auto motor = judged(modelOf(halves.motor), displacement);
    result.motorErrorDb = motor.errorDb;
    result.motorChiSquared = motor.chiSquared;
    result.motorRefinement = halves.motorRefinement;
    result.motor = withMotion(motor.model, options.relativeDegree);
    const auto cone = judged(modelOf(halves.cone), result.coneResponse);
    result.cone = cone.model;
    result.coneErrorDb = cone.errorDb;
    result.coneRefinement = halves.coneRefinement;
    const auto whole = judged(series(accelerated(result.motor), result.cone), prompt);
    result.cascade = whole.model;
    result.errorDb = whole.errorDb;
    result.chiSquared = whole.chiSquared;
    result.stable = motor.stable && cone.stable;
    result.sentence = sentenceFor(result, known, options.leastSignalDb);
    return result;
}

}  // namespace excursion
