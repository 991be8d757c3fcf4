// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Driver/ExponentialAdams.h"

#include "Engine/Driver/Exponential.h"
#include "Engine/Driver/TallProduct.h"

#include <cmath>

namespace excursion {

ExponentialAdams::ExponentialAdams(const Model& model, double h) : motion_(model, h)
{
    const auto n = motion_.A_.rows(), outputs = motion_.y_.size(), laws = motion_.N_[0].size();
    const auto rows = padded(n + outputs);
    linear_.setZero(rows, n + ExponentialStep::terms);
    linear_.topRows(n) = motion_.linear_.topRows(n);
    linear_.middleRows(n, outputs) = motion_.linear_.middleRows(n + 2 * outputs, outputs);
    const Eigen::MatrixXd C = motion_.linear_.block(n, 0, outputs, n);
    ahead_.setZero(rows, 3 * laws);
    for (Eigen::Index q = 0; q < laws; ++q) {
        const auto phi = exponential(motion_.A_, motion_.E_.col(q), h, 3).phi;
        for (Eigen::Index k = 0; k < 3; ++k) {
            ahead_.col(k * laws + q).head(n) = std::tgamma(static_cast<double>(k) + 1.0) * phi.col(k);
            ahead_.col(k * laws + q).segment(n, outputs) = C * ahead_.col(k * laws + q).head(n);
        }
    }
    z_.setZero(n);
    from_.setZero(linear_.cols());
    run_.setZero(rows);
    parabola_.setZero(3 * laws);
    for (auto& N : past_)
        N.setZero(laws);
}

void ExponentialAdams::reset()
{
    z_.setZero();
    for (auto& N : past_)
        N.setZero();
}

double ExponentialAdams::step(std::span<const double> u)
{
    const auto n = z_.size(), outputs = motion_.y_.size(), laws = past_[0].size();
    auto& [now, before, earlier] = past_;
    const double end = ExponentialStep::later(u).second;
    from_.head(n) = z_;
    for (std::size_t k = 0; k < ExponentialStep::terms; ++k)
        from_[n + static_cast<Eigen::Index>(k)] = k < u.size() ? u[k] : 0.0;
    // In powers of s: N_n, D + D2/2 and D2/2.
    parabola_.head(laws) = now;
    parabola_.tail(laws) = 0.5 * (now - 2.0 * before + earlier);
    parabola_.segment(laws, laws) = now - before + parabola_.tail(laws);
    run_.setZero();
    addTallProduct(linear_.data(), linear_.rows(), linear_.cols(), from_.data(), 1, run_.data(), 0, linear_.rows());
    addTallProduct(ahead_.data(), ahead_.rows(), ahead_.cols(), parabola_.data(), 1, run_.data(), 0, ahead_.rows());
    z_ = run_.head(n);
    motion_.y_ = run_.segment(n, outputs);
    earlier.swap(before);
    before.swap(now);
    motion_.ask(end, now.data());
    return motion_.y_[4] + now[1] + motion_.motion(end);
}

} // namespace excursion
