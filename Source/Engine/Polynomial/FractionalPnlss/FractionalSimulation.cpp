// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/FractionalPnlss/FractionalSimulation.h"

#include "Engine/Error.h"
#include "Engine/Polynomial/FractionalPnlss/FractionalRecursion.h"
#include "Engine/Signal/Resample.h"

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

namespace excursion {

using Eigen::Index;
using Eigen::MatrixXd;

MatrixXd fineInput(const MatrixXd& input, int substeps, bool periodic, Index skip)
{
    const auto N = input.rows();
    const Index after = periodic ? std::min<Index>(N - skip, 256) : 0;
    MatrixXd fine(N * substeps, input.cols());
    std::vector<double> samples(static_cast<std::size_t>(N + after));
    for (Index c = 0; c < input.cols(); ++c) {
        for (Index t = 0; t < N; ++t)
            samples[static_cast<std::size_t>(t)] = input(t, c);
        for (Index t = 0; t < after; ++t)
            samples[static_cast<std::size_t>(N + t)] = input(skip + t, c);
        const auto between = upsample(samples, substeps);
        fine.col(c) = Eigen::Map<const Eigen::VectorXd>(between.data(), N * substeps);
    }
    return fine;
}

MatrixXd simulate(const FractionalPnlss& model, const MatrixXd& input, const FractionalGrid& grid)
{
    std::string reason;
    if (!model.isValid(&reason))
        throw Error(Error::Kind::usage, "The fractional model is not valid: " + reason + ".");
    if (input.cols() != model.form.linear.inputs())
        throw Error(Error::Kind::usage, "The input does not fit the model.");
    FractionalRecursion::Trajectory run;
    run.output = MatrixXd::Zero(input.rows(), model.form.linear.outputs());
    if (!FractionalRecursion(model, grid, false, false)
             .run(model, fineInput(input, grid.substeps, false, 0), 1e100, run))
        run.output.setConstant(std::numeric_limits<double>::quiet_NaN());
    return run.output;
}

}  // namespace excursion
