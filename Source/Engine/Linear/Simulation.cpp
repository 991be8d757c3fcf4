// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Linear/Simulation.h"

#include "Engine/Error.h"

namespace excursion {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

void require(const StateSpace& model, const MatrixXd& input)
{
    std::string reason;
    if (!model.isValid(&reason))
        throw Error(Error::Kind::usage, "The model cannot be simulated: " + reason + ".");
    if (model.continuous())
        throw Error(Error::Kind::usage, "A model of continuous time is simulated after a transform to discrete time.");
    if (input.cols() != model.inputs())
        throw Error(Error::Kind::usage, "The model has " + std::to_string(model.inputs()) + " inputs, but "
                                            + std::to_string(input.cols()) + " were given.");
}

}  // namespace

MatrixXd simulate(const StateSpace& model, const MatrixXd& input, const VectorXd& initial)
{
    require(model, input);
    if (initial.size() != 0 && initial.size() != model.order())
        throw Error(Error::Kind::usage, "The initial state has " + std::to_string(initial.size())
                                            + " numbers, the model " + std::to_string(model.order()) + " states.");
    VectorXd x = initial.size() != 0 ? initial : VectorXd::Zero(model.order()), next(model.order());
    MatrixXd output(input.rows(), model.outputs());
    for (Eigen::Index t = 0; t < input.rows(); ++t) {
        output.row(t).transpose().noalias() = model.D * input.row(t).transpose();
        output.row(t).transpose().noalias() += model.C * x;
        next.noalias() = model.B * input.row(t).transpose();
        next.noalias() += model.A * x;
        x.swap(next);
    }
    return output;
}

}  // namespace excursion
