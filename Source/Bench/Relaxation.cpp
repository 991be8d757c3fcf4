// SPDX-License-Identifier: GPL-3.0-or-later
#include "Bench/Relaxation.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace excursion::bench {
namespace {

struct Rule {
    std::vector<double> node, weight;
};

// Gauss rule for the weight t^power on (0, 1), by Golub and Welsch: the nodes are the eigenvalues of
// the Jacobi matrix of the polynomials orthogonal to (1 + x)^power on (-1, 1).
Rule gaussRule(int count, double power)
{
    Eigen::VectorXd diagonal(count), side(std::max(count - 1, 1));
    for (int n = 0; n < count; ++n) {
        const double s = 2.0 * n + power;
        diagonal(n) = n == 0 ? power / (power + 2.0) : power * power / (s * (s + 2.0));
        if (n > 0) {
            const double product = n * (n + power);
            side(n - 1) = n == 1 ? std::sqrt(4.0 * (1.0 + power) / ((2.0 + power) * (2.0 + power) * (3.0 + power)))
                                 : std::sqrt(4.0 * product * product / (s * s * (s * s - 1.0)));
        }
    }
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
    solver.computeFromTridiagonal(diagonal, side.head(count - 1));
    Rule rule;
    for (int n = 0; n < count; ++n) {
        const double first = solver.eigenvectors()(0, n);
        rule.node.push_back(0.5 * (1.0 + solver.eigenvalues()(n)));
        rule.weight.push_back(first * first / (1.0 + power));  // the weight integrates to 1/(1 + power)
    }
    return rule;
}

}  // namespace

std::complex<double> Relaxations::response(std::complex<double> s) const
{
    std::complex<double> sum = 0.0;
    for (std::size_t k = 0; k < rate.size(); ++k)
        sum += weight[k] / (s + rate[k]);
    return sum;
}

Relaxations fractionalIntegral(double alpha, double low, double high)
{
    constexpr int tail = 6;
    const double density = std::sin(std::numbers::pi * alpha) / std::numbers::pi;
    const double decades = std::log(high / low);
    Relaxations cells;
    const auto add = [&](double rate, double weight) {
        cells.rate.push_back(rate);
        cells.weight.push_back(density * weight);
    };

    const auto below = gaussRule(tail, -alpha);
    for (int n = 0; n < tail; ++n)
        add(low * below.node[n], std::pow(low, 1.0 - alpha) * below.weight[n]);

    const auto middle = gaussRule(std::max(8, static_cast<int>(std::ceil(2.6 * decades))), 0.0);
    for (std::size_t n = 0; n < middle.node.size(); ++n) {
        const double rate = low * std::exp(decades * middle.node[n]);
        add(rate, decades * middle.weight[n] * std::pow(rate, 1.0 - alpha));
    }

    // r = high/t: r^(-alpha) dr/(s + r) = high^(-alpha) t^(alpha - 1) dt / (1 + s t/high)
    const auto above = gaussRule(tail, alpha - 1.0);
    for (int n = 0; n < tail; ++n) {
        const double rate = high / above.node[n];
        add(rate, std::pow(high, -alpha) * above.weight[n] * rate);
    }
    return cells;
}

Relaxations logarithm(double low, double high)
{
    const double decades = std::log(high / low);
    const auto rule = gaussRule(std::max(8, static_cast<int>(std::ceil(2.6 * decades))), 0.0);
    Relaxations cells;
    for (std::size_t n = 0; n < rule.node.size(); ++n) {
        const double rate = low * std::exp(decades * rule.node[n]);
        cells.rate.push_back(rate);
        cells.weight.push_back(decades * rule.weight[n] * rate);
    }
    return cells;
}

}  // namespace excursion::bench
