// SPDX-License-Identifier: GPL-3.0-or-later
// How long the steps of ExponentialStep may be.
#include "Engine/Loudspeaker/ExponentialStep.h"

#include "Engine/Numerics/Eigenvalues.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace excursion {
namespace {

/// max |lambda|; of two rows from lambda^2 - tr(J) lambda + det(J) = 0.
double spectralRadius(const Eigen::MatrixXd& J)
{
    if (J.rows() > 2)
        return eigenvalues(J).cwiseAbs().maxCoeff();
    const std::complex<double> half = 0.5 * J.trace(), root = std::sqrt(half * half - J.determinant());
    return std::max(std::abs(half + root), std::abs(half - root));
}

/// Memories that are shares of a limit, at that limit where the cone slides; whether there are any. They are those in
/// which their rate is not affine.
template <class RateAt>
bool carry(Eigen::VectorXd& y, Eigen::Index motions, double v, const RateAt& rateAt)
{
    constexpr double same = 1e-6;
    bool any = false;
    const Eigen::VectorXd rest = y, none = rateAt(rest);
    for (Eigen::Index m = motions; m < y.size(); ++m) {
        const auto own = none.size() - y.size() + m;
        auto half = rest, whole = rest;
        half[m] = 0.5;
        whole[m] = 1.0;
        const double toHalf = rateAt(half)[own] - none[own], toWhole = rateAt(whole)[own] - none[own];
        if (std::abs(toWhole - 2.0 * toHalf) <= same * std::abs(toWhole))
            continue;
        y[m] = std::copysign(1.0, v);
        any = true;
    }
    return any;
}

bool samePlaces(const OperatingRange& a, const OperatingRange& b)
{
    return a.displacement == b.displacement && a.velocity == b.velocity && a.current == b.current
           && a.highFrequency == b.highFrequency;
}

}  // namespace

std::vector<ExponentialStep::LawSlope> ExponentialStep::lawSlopes(Places places, std::span<const double> speeds)
{
    std::vector<const OperatingRange*> ranges;
    for (const auto& law : laws_)
        if (const auto& range = law.component->operatingRange;
            std::none_of(ranges.begin(), ranges.end(), [&](const auto* known) { return samePlaces(*known, range); }))
            ranges.push_back(&range);
    std::vector<double> velocities;  // shares
    for (const double speed : speeds)
        velocities.insert(velocities.end(), {-speed, speed});
    std::vector<LawSlope> slopes;
    const auto rateAt = [this](const Eigen::VectorXd& y) -> Eigen::VectorXd {
        y_ = y;
        ask(0.0, N_[0].data());
        return N_[0];
    };
    Eigen::VectorXd y(y_.size()), little(y_.size());
    for (const auto* range : ranges) {
        const double rise = 2.0 * std::numbers::pi * range->highFrequency * range->current;  // A/s
        little.setOnes();
        little.head<motions>() << range->current, range->displacement, range->velocity, rise,
            range->velocity * rise / range->current;
        little *= 1e-6;
        for (const double angle : {0.0, 0.25, 0.75, 1.0, 1.25, 1.75})  // a sinusoid of the highest frequency
            for (int k = -4; k <= 4; ++k)
                for (const double speed : velocities)
                    for (const bool carries : {false, true}) {
                        y.setZero();
                        const double place = 0.25 * k, v = speed * range->velocity,
                                     share = places == Places::all ? 1.0 : std::sqrt(1.0 - place * place);
                        if (share == 0.0 && angle != 0.0)
                            continue;  // all angles are one place
                        const double current = share * std::cos(angle * std::numbers::pi);
                        y.head(3) << current * range->current, place * range->displacement, v;
                        y[3] = share * rise * std::sin(angle * std::numbers::pi);
                        if (carries && !carry(y, motions, v, rateAt))
                            continue;
                        const auto here = rateAt(y);
                        Eigen::MatrixXd J(here.size(), y.size());
                        for (Eigen::Index c = 0; c < y.size(); ++c) {
                            const double inward = y[c] > 0.0 ? -little[c] : little[c];  // laws have corners there
                            auto there = y;
                            there[c] += inward;
                            J.col(c) = (rateAt(there) - here) / inward;
                        }
                        if (J.allFinite())
                            slopes.push_back({range, current, place, speed, std::move(J)});
                    }
    }
    return slopes;
}

Eigen::MatrixXd ExponentialStep::among(const Eigen::MatrixXd& J) const
{
    const auto laws = J.rows();
    Eigen::MatrixXd own(laws, laws);
    for (const Eigen::Index q : {0, 1})
        own.col(q) = J.col(2 * q) + J.middleCols(3, 2) * C_.block(3, 2 * q, 2, 1);
    own.rightCols(laws - rates) = J.rightCols(laws - rates);
    return own;
}

double ExponentialStep::fastestLaw()
{
    double fastest = 0.0;
    for (const auto& place : lawSlopes())
        fastest = std::max(fastest, spectralRadius(among(place.slope)));
    return fastest;
}

ExponentialStep::Difference ExponentialStep::differenceNear(const Eigen::MatrixXd& J) const
{
    const auto n = moving_, memories = J.rows() - rates;
    const auto wide = [&](const Eigen::MatrixXd& linear, double kept) {
        Eigen::MatrixXd map = Eigen::MatrixXd::Zero(linear.rows() + memories, n + memories);
        map.topLeftCorner(linear.rows(), n) = linear.leftCols(n);
        map.bottomRightCorner(memories, memories).diagonal().setConstant(kept);
        return map;
    };
    const auto states = A_.rows();
    const Eigen::MatrixXd seen = wide(C_, 1.0), half = wide(C_ * halfway_.leftCols(states), 1.0),
                          end = wide(C_ * whole_.leftCols(states), 1.0);
    const auto stage = [&](const Eigen::MatrixXd& from, const Eigen::MatrixXd& moved, double time,
                           const Eigen::MatrixXd& N) -> Eigen::MatrixXd {
        Eigen::MatrixXd y = from;
        y.topRows(motions) += moved;
        y.bottomRows(memories) += time * N.bottomRows(memories);
        return J * y;
    };
    const Eigen::MatrixXd N1 = J * seen, N2 = stage(half, stage_ * N1.topRows(rates), 0.5 * step_, N1),
                          N3 = stage(half, stage_ * N2.topRows(rates), 0.5 * step_, N2),
                          N4 = stage(end,
                                     last_ * N1.topRows(rates) + stage_ * (2.0 * N3.topRows(rates) - N1.topRows(rates)),
                                     step_, N3);
    const Eigen::MatrixXd twice = N2 + N3, across = quadrature_.topRows(n);
    Difference d {.rate = wide(A_.topRows(n), 0.0), .step = wide(whole_.topRows(n), 1.0)};
    d.rate.topRows(n) += E_.topRows(n) * N1.topRows(rates);
    d.rate.bottomRows(memories) += N1.bottomRows(memories);
    d.step.topRows(n) += across.leftCols(rates) * N1.topRows(rates)
                         + across.middleCols(rates, rates) * twice.topRows(rates)
                         + across.rightCols(rates) * N4.topRows(rates);
    d.step.bottomRows(memories) += step_ / 6.0 * (N1 + 2.0 * twice + N4).bottomRows(memories);
    return d;
}

bool ExponentialStep::isStable(const Eigen::MatrixXd& slope) const
{
    constexpr double explicitLimit = 2.0;  // of Runge and Kutta's method of fourth order, 2.8 on either axis
    constexpr double rounding = 1e-4, inexact = 0.05;  // where all decays, and where something truly grows
    constexpr double threefold = 3.0;
    if (isWithin(among(slope), explicitLimit / step_))
        return true;
    const auto difference = differenceNear(slope);
    if (isWithin(difference.step, 1.0 + rounding))  // whether anything grows or not
        return true;
    if (!isWithin(difference.step, threefold))  // no motion grows by as much within a step
        return false;
    const double grows = eigenvalues(difference.rate).real().maxCoeff();
    return grows > 0.0 && isWithin(difference.step, (1.0 + inexact) * std::exp(step_ * grows));
}

bool ExponentialStep::isStable(const std::vector<LawSlope>& places) const
{
    return std::all_of(places.begin(), places.end(), [this](const LawSlope& place) { return isStable(place.slope); });
}

}  // namespace excursion
