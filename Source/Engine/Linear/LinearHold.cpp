// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Linear/LinearHold.h"

#include "Engine/Error.h"

#include <unsupported/Eigen/MatrixFunctions>

namespace excursion {

LinearHold linearHold(const StateSpace& model, double sampleRate)
{
    std::string reason;
    if (!model.isValid(&reason))
        throw Error(Error::Kind::usage, "The model cannot be sampled: " + reason + ".");
    if (!model.continuous() || !(sampleRate > 0.0))
        throw Error(Error::Kind::usage, "A model of continuous time is sampled, at a rate above 0 Hz.");
    const auto n = model.order(), m = model.inputs();
    Eigen::MatrixXd bordered = Eigen::MatrixXd::Zero(n + 2 * m, n + 2 * m);
    bordered.topLeftCorner(n, n) = model.A / sampleRate;
    bordered.block(0, n, n, m) = model.B / sampleRate;
    bordered.block(n, n + m, m, m).setIdentity();
    const Eigen::MatrixXd solution = bordered.exp();
    if (!solution.allFinite())
        throw Error(Error::Kind::numerical, "The model grows beyond all numbers within one sample.");
    LinearHold hold;
    hold.late = solution.block(0, n + m, n, m);
    hold.model.sampleRate = sampleRate;
    hold.model.A = solution.topLeftCorner(n, n);
    hold.model.B = solution.block(0, n, n, m) - hold.late + hold.model.A * hold.late;
    hold.model.C = model.C;
    hold.model.D = model.D + model.C * hold.late;
    return hold;
}

}  // namespace excursion
