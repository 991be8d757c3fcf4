// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Linear/Bilinear.h"

#include "Engine/Error.h"
#include "Engine/Numerics/LuFactors.h"

#include <cmath>
#include <numbers>

namespace excursion {
namespace {

using Eigen::MatrixXd;

/// M^-1, refused when M is singular to working precision.
MatrixXd inverse(const MatrixXd& M, const char* pole)
{
    const RealLu lu(M);
    if (M.rows() > 0 && !(lu.rcond() > 1e-15))
        throw Error(Error::Kind::numerical,
                    std::string("The bilinear transform does not exist: the model has a pole at ") + pole + ".");
    return lu.inverse();
}

void require(const StateSpace& model, bool continuous, const char* sentence)
{
    std::string reason;
    if (!model.isValid(&reason))
        throw Error(Error::Kind::usage, "The model cannot be transformed: " + reason + ".");
    if (model.continuous() != continuous)
        throw Error(Error::Kind::usage, sentence);
}

}  // namespace

StateSpace toDiscrete(const StateSpace& model, double sampleRate)
{
    require(model, true, "The model is one of discrete time already.");
    if (!(sampleRate > 0.0) || !std::isfinite(sampleRate))
        throw Error(Error::Kind::usage, "The sample rate of a bilinear transform must be above 0.");
    const double a = 2.0 * sampleRate;
    const MatrixXd I = MatrixXd::Identity(model.order(), model.order());
    const MatrixXd R = inverse(a * I - model.A, "2 fs");
    StateSpace result;
    result.sampleRate = sampleRate;
    result.A = I + 2.0 * R * model.A;  // (a I - A)^-1 (a I + A), without losing the small difference to I
    result.B = std::sqrt(2.0 * a) * R * model.B;
    result.C = std::sqrt(2.0 * a) * model.C * R;
    result.D = model.D + model.C * R * model.B;
    return result;
}

StateSpace toContinuous(const StateSpace& model)
{
    require(model, false, "The model is one of continuous time already.");
    const double a = 2.0 * model.sampleRate;
    const MatrixXd I = MatrixXd::Identity(model.order(), model.order());
    const MatrixXd R = inverse(model.A + I, "z = -1");
    StateSpace result;
    result.A = a * R * (model.A - I);
    result.B = std::sqrt(2.0 * a) * R * model.B;
    result.C = std::sqrt(2.0 * a) * model.C * R;
    result.D = model.D - model.C * R * model.B;
    return result;
}

double warpedFrequency(double frequency, double sampleRate)
{
    return sampleRate / std::numbers::pi * std::atan(std::numbers::pi * frequency / sampleRate);
}

}  // namespace excursion
