// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Predistortion/CouplingFilter.h"

#include "Engine/Numerics/Exponential.h"
#include "Engine/Predistortion/CubicDrive.h"

namespace excursion {

CouplingFilter::CouplingFilter(const AmplifierCoupling& coupling, double sampleRate)
    : order_(coupling.passesConstant() ? 0 : static_cast<std::size_t>(coupling.order))
{
    if (order_ == 0)
        return;
    const Withheld withheld(coupling);
    const auto [decay, phi] = exponential(withheld.A, withheld.B, 1.0 / sampleRate, 4);
    const Eigen::MatrixXd input = bySamples(phi);
    for (std::size_t row = 0; row < order_; ++row) {
        const auto r = static_cast<Eigen::Index>(row);
        for (std::size_t k = 0; k < order_; ++k)
            decay_[row][k] = decay(r, static_cast<Eigen::Index>(k));
        for (std::size_t k = 0; k < 4; ++k)
            input_[row][k] = input(r, static_cast<Eigen::Index>(k));
        out_[row] = withheld.C(0, r);
        direct_ += out_[row] * input_[row][0];
    }
}

void CouplingFilter::reset()
{
    state_ = next_ = {};
    past_ = {};
    coming_ = 0.0;
}

std::array<double, 2> CouplingFilter::charge() const
{
    return order_ == 2 ? std::array {state_[1], state_[0]} : state_;
}

void CouplingFilter::charge(const std::array<double, 2>& held)
{
    reset();
    if (order_ == 0)
        return;
    state_ = order_ == 2 ? std::array {held[1], held[0]} : std::array {held[0], 0.0};
    foresee();
}

void CouplingFilter::take(double u)
{
    if (order_ == 0)
        return;
    for (std::size_t row = 0; row < order_; ++row)
        state_[row] = next_[row] + input_[row][0] * u;
    past_ = {u, past_[0], past_[1]};
    foresee();
}

void CouplingFilter::foresee()
{
    coming_ = 0.0;
    for (std::size_t row = 0; row < order_; ++row) {
        double sum = 0.0;
        for (std::size_t k = 0; k < order_; ++k)
            sum += decay_[row][k] * state_[k];
        for (std::size_t k = 0; k < 3; ++k)
            sum += input_[row][k + 1] * past_[k];
        next_[row] = sum;
        coming_ += out_[row] * sum;
    }
}

}  // namespace excursion
