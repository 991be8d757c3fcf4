// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/Hammerstein/LongHammerstein.h"

#include "Engine/Polynomial/Powers.h"
#include "Engine/Signal/Fft.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace excursion {

using Eigen::Index;
using Eigen::VectorXd;

LongHammerstein::LongHammerstein(const std::vector<InputOutputRecord>& records, const Eigen::MatrixXd& T, Index taps)
    : branches_(T.cols()), taps_(taps)
{
    for (const auto& record : records) {
        const auto N = record.input.rows();
        Stretch stretch {std::bit_ceil(static_cast<std::size_t>(N + taps)), {}, record.output.col(0), record.skip};
        stretch.output.head(record.skip).setZero();
        const Eigen::MatrixXd P = powersOf(record.input.col(0), 1, branches_) * T;
        std::vector<double> padded(stretch.length);
        for (Index n = 0; n < branches_; ++n) {
            std::copy_n(P.col(n).data(), N, padded.begin());
            stretch.polynomials.push_back(fft(padded));
        }
        samples_ += static_cast<double>(N - record.skip);
        stretches_.push_back(std::move(stretch));
    }
}

VectorXd LongHammerstein::forward(const Stretch& stretch, const VectorXd& unknowns) const
{
    std::vector<std::complex<double>> sum(stretch.length / 2 + 1);
    std::vector<double> padded(stretch.length);
    for (Index n = 0; n < branches_; ++n) {
        std::copy_n(unknowns.data() + 1 + n * taps_, taps_, padded.begin());
        const auto taps = fft(padded);
        const auto& P = stretch.polynomials[static_cast<std::size_t>(n)];
        for (std::size_t k = 0; k < sum.size(); ++k)
            sum[k] += P[k] * taps[k];
    }
    const auto y = inverseFft(sum, stretch.length);
    VectorXd result = Eigen::Map<const VectorXd>(y.data(), stretch.output.size()).array() + unknowns[0];
    result.head(stretch.skip).setZero();
    return result;
}

void LongHammerstein::addBackward(const Stretch& stretch, const VectorXd& rest, VectorXd& sum) const
{
    sum[0] += rest.sum();
    std::vector<double> padded(stretch.length);
    std::copy_n(rest.data(), rest.size(), padded.begin());
    const auto R = fft(padded);
    for (Index n = 0; n < branches_; ++n) {
        auto product = R;
        const auto& P = stretch.polynomials[static_cast<std::size_t>(n)];
        for (std::size_t k = 0; k < product.size(); ++k)
            product[k] *= std::conj(P[k]);
        const auto correlation = inverseFft(product, stretch.length);
        sum.segment(1 + n * taps_, taps_) += Eigen::Map<const VectorXd>(correlation.data(), taps_);
    }
}

LongHammerstein::Solution LongHammerstein::solve(double regularization, int iterations, int every,
                                                 const Judge& judge) const
{
    const double ridge = regularization * samples_;
    Solution solution;
    auto& x = solution.unknowns;
    x = VectorXd::Zero(1 + branches_ * taps_);
    std::vector<VectorXd> rest;
    for (const auto& stretch : stretches_)
        rest.push_back(stretch.output);
    const auto gradient = [&] {
        VectorXd s = -ridge * x;
        s[0] = 0.0;  // the offset is free
        for (std::size_t r = 0; r < rest.size(); ++r)
            addBackward(stretches_[r], rest[r], s);
        return s;
    };
    const auto cost = [&] {
        double sum = ridge * x.tail(x.size() - 1).squaredNorm();
        for (const auto& part : rest)
            sum += part.squaredNorm();
        return sum;
    };
    solution.initialCost = cost();
    solution.end(Termination::maximumIterations);
    VectorXd s = gradient(), p = s;
    double size = s.squaredNorm();
    const double enough = 1e-20 * size;
    for (int k = 1; k <= iterations && size > enough; ++k) {
        solution.iterations = k;
        std::vector<VectorXd> q;
        double curvature = ridge * p.tail(p.size() - 1).squaredNorm();
        for (const auto& stretch : stretches_) {
            q.push_back(forward(stretch, p));
            curvature += q.back().squaredNorm();
        }
        const double step = size / curvature;
        x += step * p;
        for (std::size_t r = 0; r < rest.size(); ++r)
            rest[r] -= step * q[r];
        s = gradient();
        const double next = s.squaredNorm();
        p = s + next / size * p;
        size = next;
        if ((k % every == 0 || k == iterations || size <= enough) && !judge(x, k)) {
            solution.end(Termination::validationSettled);
            break;
        }
        if (size <= enough)
            solution.end(Termination::noBetterStep);
    }
    solution.finalCost = cost();
    return solution;
}

}  // namespace excursion
