// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Polynomial/MonomialProducts.h"
#include "Engine/Polynomial/Narx/Narx.h"

#include <functional>
#include <vector>

namespace excursion {

/// The recursion of a NARX model and of its derivatives, compiled once for its terms.
/// With r(t) the values of the monomials, the derivatives by the coefficients obey a recursion of the model's own lags:
///     dy(t)/dc = r(t) + sum_{i=1..na} (df/dy(t-i)) dy(t-i)/dc
class NarxRecursion {
public:
    explicit NarxRecursion(const Narx& structure);

    /// @param output  becomes N long @return how many samples it took to leave `bound` or the finite numbers; N where
    /// it did not
    Eigen::Index run(const Eigen::VectorXd& coefficients, const Eigen::VectorXd& input, double bound,
                     Eigen::VectorXd& output) const;

    /// The values of the monomials, N x K, on a given output, whose past is measured: for one step ahead.
    Eigen::MatrixXd regressors(const Eigen::VectorXd& input, const Eigen::VectorXd& output, Eigen::Index first,
                               Eigen::Index rows) const;

    /// Takes dy/dc of a stretch of T samples along a run, T x K, in ascending time.
    using Consumer = std::function<void(Eigen::Index first, const Eigen::MatrixXd& derivatives)>;
    void differentiate(const Eigen::VectorXd& coefficients, const Eigen::VectorXd& input, const Eigen::VectorXd& output,
                       const Consumer&) const;

private:
    /// The nodes of time t from the past of input and output.
    void place(const Eigen::VectorXd& input, const Eigen::VectorXd& output, Eigen::Index t,
               Eigen::VectorXd& nodes) const;
    Eigen::VectorXd weights(const Eigen::VectorXd& coefficients) const;  // one a node

    Eigen::Index na_, nb_, terms_;
    MonomialProducts products_;
};

/// The output, N x 1, for an input of N samples, N x 1; input and output are 0 before. A model that runs away leaves
/// the finite numbers; what comes after is not finite either. Throws Error (usage) for a model or an input that does
/// not fit.
Eigen::MatrixXd simulate(const Narx&, const Eigen::MatrixXd& input);

}  // namespace excursion
