// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/Volterra/VolterraSeries.h"

#include "Engine/Error.h"
#include "Engine/Signal/Convolution.h"
#include "Engine/Validity.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace excursion {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

Index VolterraSeries::parameters() const
{
    const auto T2 = second.rows(), T3 = static_cast<Index>(third.size());
    return 1 + first.size() + T2 * (T2 + 1) / 2 + T3 * (T3 + 1) * (T3 + 2) / 6;
}

bool VolterraSeries::isValid(std::string* reason) const
{
    if (!(std::isfinite(sampleRate) && sampleRate > 0.0))
        return refuse(reason, "a Volterra series needs a sample rate above 0 Hz");
    if (first.size() == 0 || second.rows() != second.cols())
        return refuse(reason, "a Volterra series needs a first kernel, and a second one that is square");
    const auto T3 = static_cast<Index>(third.size());
    bool finite = std::isfinite(offset) && first.allFinite() && second.allFinite(), cubic = true,
         symmetric = second == second.transpose();
    for (Index i = 0; i < T3; ++i) {
        const auto& slice = third[static_cast<std::size_t>(i)];
        cubic = cubic && slice.rows() == T3 && slice.cols() == T3;
        finite = finite && slice.allFinite();
        for (Index j = 0; cubic && j < i; ++j)
            symmetric = symmetric && slice.row(j) == third[static_cast<std::size_t>(j)].row(i);
        symmetric = symmetric && cubic && slice == slice.transpose();
    }
    if (!cubic)
        return refuse(reason,
                      "the third kernel of a Volterra series needs as many matrices as each has rows and columns");
    if (!finite)
        return refuse(reason, "a kernel of a Volterra series is not finite");
    if (!symmetric)
        return refuse(reason, "the kernels of a Volterra series must be symmetric");
    return true;
}

MatrixXd simulate(const VolterraSeries& model, const MatrixXd& input)
{
    std::string reason;
    if (!model.isValid(&reason))
        throw Error(Error::Kind::usage, "The model cannot be simulated: " + reason + ".");
    if (input.cols() != 1)
        throw Error(Error::Kind::usage, "A Volterra series has one input, but the record has another number.");
    const Index N = input.rows(), T2 = model.second.rows(), T3 = static_cast<Index>(model.third.size()),
                longest = std::max(T2, T3);
    const auto linear = convolved(std::span(model.first.data(), static_cast<std::size_t>(model.first.size())),
                                  std::span(input.data(), static_cast<std::size_t>(N)));
    VectorXd y = Eigen::Map<const VectorXd>(linear.data(), N).array() + model.offset;
    VectorXd past = VectorXd::Zero(longest + N);  // newest first
    past.head(N) = input.col(0).reverse();
    for (Index t = 0; longest > 0 && t < N; ++t) {
        const auto window = past.segment(N - 1 - t, longest);
        y[t] += window.head(T2).dot(model.second * window.head(T2));
        for (Index i = 0; i < T3; ++i)
            y[t] += window[i] * window.head(T3).dot(model.third[static_cast<std::size_t>(i)] * window.head(T3));
    }
    return y;
}

VolterraSeries volterraSeries(const Pnlss& model, Index memory1, Index memory2, Index memory3)
{
    if (memory1 < 1 || memory2 < 0 || memory3 < 0 || memory1 > 65536 || memory2 > 2048 || memory3 > 128)
        throw Error(Error::Kind::usage,
                    "A Volterra series has memories of 1 to 65536, 0 to 2048 and 0 to 128 samples.");
    const Volterra kernels(model);
    if (model.linear.inputs() != 1 || model.linear.outputs() != 1)
        throw Error(Error::Kind::usage, "A Volterra series is made of a model with one input and one output.");
    VolterraSeries result;
    result.sampleRate = model.linear.sampleRate;
    result.offset = kernels.offset()[0];
    result.first = kernels.kernel({0}, memory1);
    // Impulses at 0 and s: h(t, t - s), one diagonal
    result.second.resize(memory2, memory2);
    for (Index s = 0; s < memory2; ++s) {
        const auto along = kernels.kernel({0, s}, memory2);
        for (Index t = s; t < memory2; ++t)
            result.second(t, t - s) = result.second(t - s, t) = along(t, 0);
    }
    result.third.assign(static_cast<std::size_t>(memory3), MatrixXd::Zero(memory3, memory3));
    for (Index r = 0; r < memory3; ++r)
        for (Index s = r; s < memory3; ++s) {
            const auto along = kernels.kernel({0, r, s}, memory3);
            for (Index t = s; t < memory3; ++t) {
                const Index at[] {t, t - r, t - s};
                Index order[] {0, 1, 2};
                do
                    result.third[static_cast<std::size_t>(at[order[0]])](at[order[1]], at[order[2]]) = along(t, 0);
                while (std::next_permutation(order, order + 3));
            }
        }
    return result;
}

}  // namespace excursion
