// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Numerics/StateUnits.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace excursion {
namespace {

/// The power of two next to a ratio; one where there is none.
double power(double ratio)
{
    return ratio > 0.0 && std::isfinite(ratio) ? std::exp2(std::round(std::log2(ratio))) : 1.0;
}

/// Sizes of what couples states, in units that grow.
class Couplings {
public:
    explicit Couplings(const Eigen::MatrixXd& A)
        : rate_(A.diagonal().cwiseAbs()), B_(A.cwiseAbs()), units_(Eigen::VectorXd::Ones(A.rows()))
    {
        B_.diagonal().setZero();
    }

    /// Balances some states among themselves.
    void balance(const std::vector<Eigen::Index>& states)
    {
        // States that move one another but none of the rest have no end of better units: what gains little is left.
        constexpr double worthIt = 0.95;
        constexpr int mostSweeps = 100;
        bool moved = true;
        for (int sweep = 0; sweep < mostSweeps && moved; ++sweep) {
            moved = false;
            for (const auto k : states) {
                const double row = B_(k, states).sum(), column = B_(states, k).sum(),
                             f = power(std::sqrt(row) / std::sqrt(column));
                if (column * f + row / f < worthIt * (column + row)) {
                    grow(k, f);
                    moved = true;
                }
            }
        }
    }

    /// Measures a state that moves none of the others, or that none of them moves, by its own rate.
    void measure(Eigen::Index k, const std::vector<Eigen::Index>& others)
    {
        const double row = B_(k, others).sum(), column = B_(others, k).sum();
        grow(k, power(row > 0.0 ? row / rate_[k] : rate_[k] / column));
    }

    /// Takes the states that move none of the others, or that none of them moves, out of `states`, one after the other.
    std::vector<Eigen::Index> takeLoose(std::vector<Eigen::Index>& states) const
    {
        std::vector<Eigen::Index> loose;
        const auto isLoose = [&](Eigen::Index k) { return B_(k, states).isZero(0.0) || B_(states, k).isZero(0.0); };
        for (auto next = states.begin();
             (next = std::find_if(states.begin(), states.end(), isLoose)) != states.end();) {
            loose.push_back(*next);
            states.erase(next);
        }
        return loose;
    }

    const Eigen::VectorXd& units() const { return units_; }

private:
    void grow(Eigen::Index k, double f)
    {
        units_[k] *= f;
        B_.col(k) *= f;
        B_.row(k) /= f;
    }

    Eigen::VectorXd rate_;
    Eigen::MatrixXd B_;  // |A| without its diagonal
    Eigen::VectorXd units_;
};

}  // namespace

Eigen::VectorXd stateUnits(const Eigen::MatrixXd& A)
{
    if (!A.allFinite())
        return Eigen::VectorXd::Ones(A.rows());
    Couplings couplings(A);
    std::vector<Eigen::Index> states(static_cast<std::size_t>(A.rows()));
    std::iota(states.begin(), states.end(), Eigen::Index {0});
    // A loose state would draw the units of all others after its own for ever.
    const auto loose = couplings.takeLoose(states);
    couplings.balance(states);
    for (auto k = loose.rbegin(); k != loose.rend(); ++k) {
        couplings.measure(*k, states);
        states.push_back(*k);
    }
    return couplings.units();
}

Eigen::MatrixXd inUnits(const Eigen::MatrixXd& A, const Eigen::VectorXd& units)
{
    return units.cwiseInverse().asDiagonal() * A * units.asDiagonal();
}

}  // namespace excursion
