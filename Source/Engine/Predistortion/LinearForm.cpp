// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Predistortion/LinearForm.h"

#include <cmath>

namespace excursion {

std::optional<LinearForm> linearForm(const Effect& effect, const OperatingRange& operatingRange,
                                     const double* coefficients)
{
    const auto n = static_cast<std::size_t>(effect.memorySize(operatingRange));
    const std::array<double, 3> visited {operatingRange.current, operatingRange.displacement, operatingRange.velocity};
    std::vector<double> memory(n, 0.0), unused(n, 0.0);
    const auto ask = [&](const std::array<double, 3>& q) {
        Balance<double> sum;
        effect.contribute(operatingRange, coefficients, {q[0], q[1], q[2]}, memory.data(), unused.data(), sum);
        return sum;
    };
    const auto rest = ask({});
    if (rest.drop != 0.0 || rest.force != 0.0)
        return std::nullopt;
    LinearForm form;
    form.inductance = rest.inductance;
    form.mass = rest.mass;
    for (std::size_t q = 0; q < 3; ++q) {
        std::array<double, 3> at {};
        at[q] = visited[q];
        const auto sum = ask(at);
        form.drop[q] = sum.drop / visited[q];
        form.force[q] = sum.force / visited[q];
    }
    for (std::size_t k = 0; k < n; ++k) {
        memory[k] = 1.0;
        const auto sum = ask({});
        form.dropByMemory.push_back(sum.drop);
        form.forceByMemory.push_back(sum.force);
        memory[k] = 0.0;
    }

    const auto agrees = [](double value, double expected, double size) {
        return std::abs(value - expected) <= 1e-9 * size;
    };
    for (int trial = 1; trial <= 8; ++trial) {
        std::array<double, 3> at {};
        double drop = 0.0, force = 0.0, dropSize = 0.0, forceSize = 0.0;
        const auto count = [&](double byDrop, double byForce, double q) {
            drop += byDrop * q;
            force += byForce * q;
            dropSize += std::abs(byDrop * q);
            forceSize += std::abs(byForce * q);
        };
        for (std::size_t q = 0; q < 3; ++q) {
            // also beyond what was visited
            at[q] = 1.7 * visited[q] * std::sin(1.0 + 2.3 * trial + 1.7 * static_cast<double>(q));
            count(form.drop[q], form.force[q], at[q]);
        }
        for (std::size_t k = 0; k < n; ++k) {
            memory[k] = std::cos(0.9 * trial + 2.1 * static_cast<double>(k));
            count(form.dropByMemory[k], form.forceByMemory[k], memory[k]);
        }
        const auto sum = ask(at);
        if (!(agrees(sum.drop, drop, dropSize) && agrees(sum.force, force, forceSize) && sum.fluxSlope == 0.0
              && agrees(sum.inductance, form.inductance, form.inductance) && agrees(sum.mass, form.mass, form.mass)))
            return std::nullopt;
    }
    return form;
}

std::optional<LinearRates> linearRates(const Effect& effect, const OperatingRange& operatingRange,
                                       const double* coefficients)
{
    const auto n = static_cast<Eigen::Index>(effect.memorySize(operatingRange));
    const Eigen::Vector3d visited(operatingRange.current, operatingRange.displacement, operatingRange.velocity);
    Eigen::VectorXd m = Eigen::VectorXd::Zero(n), r(n);
    const auto ask = [&](const Eigen::Vector3d& q) -> const Eigen::VectorXd& {
        Balance<double> unused;
        effect.contribute(operatingRange, coefficients, {q[0], q[1], q[2]}, m.data(), r.data(), unused);
        return r;
    };
    LinearRates rates {Eigen::MatrixXd(n, n), Eigen::MatrixX3d(n, 3)};
    const bool restsAtRest = ask(Eigen::Vector3d::Zero()).isZero(0.0);
    for (Eigen::Index q = 0; q < 3; ++q)
        rates.b.col(q) = ask(visited[q] * Eigen::Vector3d::Unit(q)) / visited[q];
    for (Eigen::Index k = 0; k < n; ++k) {
        m = Eigen::VectorXd::Unit(n, k);
        rates.A.col(k) = ask(Eigen::Vector3d::Zero());
    }
    if (!(restsAtRest && rates.A.allFinite() && rates.b.allFinite()))
        return std::nullopt;
    for (int trial = 1; trial <= 4; ++trial) {
        Eigen::Vector3d at;
        for (int q = 0; q < 3; ++q)
            at[q] = visited[q] * std::sin(1.0 + 2.3 * trial + 1.7 * q);
        for (Eigen::Index k = 0; k < n; ++k)
            m[k] = std::cos(0.9 * trial + 2.1 * static_cast<double>(k));
        const Eigen::VectorXd size = rates.A.cwiseAbs() * m.cwiseAbs() + rates.b.cwiseAbs() * at.cwiseAbs();
        if (!((ask(at) - rates.A * m - rates.b * at).array().abs() <= 1e-9 * size.array()).all())
            return std::nullopt;
    }
    return rates;
}

}  // namespace excursion
