// SPDX-License-Identifier: GPL-3.0-or-later
#include "Bench/Collocation.h"

#include <cmath>

namespace excursion::bench {
namespace {

// Coefficients of the Lagrange parabolas: l_i(s) = sum_p table[i][p] s^p.
Square lagrange(const Triple& c)
{
    Square table {};
    for (int i = 0; i < 3; ++i) {
        const double a = c[(i + 1) % 3], b = c[(i + 2) % 3];
        const double below = (c[i] - a) * (c[i] - b);
        table[i] = {a * b / below, -(a + b) / below, 1.0 / below};
    }
    return table;
}

Square makeOnce()
{
    const auto parabola = lagrange(Radau::points());
    Square A {};
    for (int j = 0; j < 3; ++j) {
        const double c = Radau::points()[j];
        for (int l = 0; l < 3; ++l)
            A[j][l] = c * (parabola[l][0] + c * (parabola[l][1] / 2.0 + c * parabola[l][2] / 3.0));
    }
    return A;
}

Square makeTwice()
{
    const auto& A = Radau::once();
    Square B {};
    for (int j = 0; j < 3; ++j)
        for (int l = 0; l < 3; ++l)
            for (int k = 0; k < 3; ++k)
                B[j][l] += A[j][k] * A[k][l];
    return B;
}

std::array<std::array<double, 6>, 3> makeExtrapolation()
{
    std::array<double, 6> at {};
    for (int l = 0; l < 3; ++l) {
        at[l] = Radau::points()[l] - 2.0;
        at[l + 3] = Radau::points()[l] - 1.0;
    }
    std::array<std::array<double, 6>, 3> weights {};
    for (int j = 0; j < 3; ++j)
        for (int n = 0; n < 6; ++n) {
            weights[j][n] = 1.0;
            for (int m = 0; m < 6; ++m)
                if (m != n)
                    weights[j][n] *= (Radau::points()[j] - at[m]) / (at[n] - at[m]);
        }
    return weights;
}

}  // namespace

const Triple& Radau::points()
{
    static const Triple c {(4.0 - std::sqrt(6.0)) / 10.0, (4.0 + std::sqrt(6.0)) / 10.0, 1.0};
    return c;
}

const Square& Radau::once()
{
    static const Square A = makeOnce();
    return A;
}

const Square& Radau::twice()
{
    static const Square B = makeTwice();
    return B;
}

const std::array<std::array<double, 6>, 3>& Radau::extrapolation()
{
    static const auto weights = makeExtrapolation();
    return weights;
}

std::array<std::complex<double>, 3> decayedPowers(std::complex<double> q, double c)
{
    std::array<std::complex<double>, 3> I {};
    if (std::abs(q) * c > 1.5) {
        I[0] = (1.0 - std::exp(-q * c)) / q;
        I[1] = (c - I[0]) / q;
        I[2] = (c * c - 2.0 * I[1]) / q;
        return I;
    }
    // c^(p+1) p! sum_n (-q c)^n / (n + p + 1)!, where the closed forms would cancel
    double power = c;
    for (int p = 0; p < 3; ++p) {
        std::complex<double> term = 1.0 / (p + 1.0), sum = 0.0;
        for (int n = 0; n < 30; ++n) {
            sum += term;
            term *= -q * c / (n + p + 2.0);
        }
        I[p] = power * sum;
        power *= c;
    }
    return I;
}

std::array<std::array<std::complex<double>, 3>, 3> decayedParabola(std::complex<double> q)
{
    const auto parabola = lagrange(Radau::points());
    std::array<std::array<std::complex<double>, 3>, 3> out {};
    for (int j = 0; j < 3; ++j) {
        const auto I = decayedPowers(q, Radau::points()[j]);
        for (int l = 0; l < 3; ++l)
            out[j][l] = parabola[l][0] * I[0] + parabola[l][1] * I[1] + parabola[l][2] * I[2];
    }
    return out;
}

Triple solve(const Square& M, const Triple& r)
{
    const double a = M[1][1] * M[2][2] - M[1][2] * M[2][1];
    const double b = M[1][2] * M[2][0] - M[1][0] * M[2][2];
    const double c = M[1][0] * M[2][1] - M[1][1] * M[2][0];
    const double d = M[0][2] * M[2][1] - M[0][1] * M[2][2];
    const double e = M[0][0] * M[2][2] - M[0][2] * M[2][0];
    const double f = M[0][1] * M[2][0] - M[0][0] * M[2][1];
    const double g = M[0][1] * M[1][2] - M[0][2] * M[1][1];
    const double h = M[0][2] * M[1][0] - M[0][0] * M[1][2];
    const double k = M[0][0] * M[1][1] - M[0][1] * M[1][0];
    const double inverse = 1.0 / (M[0][0] * a + M[0][1] * b + M[0][2] * c);
    return {inverse * (a * r[0] + d * r[1] + g * r[2]), inverse * (b * r[0] + e * r[1] + h * r[2]),
            inverse * (c * r[0] + f * r[1] + k * r[2])};
}

RelaxationBank::RelaxationBank(const Relaxations& cells, double step) : state_(cells.rate.size(), 0.0)
{
    for (std::size_t k = 0; k < cells.rate.size(); ++k) {
        const double q = cells.rate[k] * step;
        const auto parabola = decayedParabola(q);
        for (int j = 0; j < 3; ++j) {
            look_[j].push_back(cells.weight[k] * std::exp(-q * Radau::points()[j]));
            take_[j].push_back(step * parabola[2][j].real());
            for (int l = 0; l < 3; ++l)
                gain_[j][l] += cells.weight[k] * step * parabola[j][l].real();
        }
        decay_.push_back(std::exp(-q));
    }
}

Triple RelaxationBank::history() const
{
    Triple sum {};
    for (std::size_t k = 0; k < state_.size(); ++k)
        for (int j = 0; j < 3; ++j)
            sum[j] += look_[j][k] * state_[k];
    return sum;
}

void RelaxationBank::advance(const Triple& input)
{
    for (std::size_t k = 0; k < state_.size(); ++k)
        state_[k] = decay_[k] * state_[k] + take_[0][k] * input[0] + take_[1][k] * input[1] + take_[2][k] * input[2];
}

}  // namespace excursion::bench
