// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Driver/ExponentialStep.h"

#include "Engine/Driver/Linearize.h"

#include <Eigen/Eigenvalues>
#include <unsupported/Eigen/MatrixFunctions>

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

constexpr Eigen::Index rates = 2;     // di/dt and dv/dt lead N
constexpr Eigen::Index motions = 5;   // i, x, v, A_i z and A_v z lead y

Model linearPart(Model model)
{
    std::erase_if(model.components, [](const Component& c) { return !c.effect->linear(); });
    return model;
}

std::vector<double> coefficientsOf(const Component& component)
{
    std::vector<double> parameters, coefficients(static_cast<std::size_t>(component.effect->coefficientCount(component.extent)));
    for (const auto& p : component.parameters)
        parameters.push_back(p.value);
    component.effect->prepare(component.extent, parameters.data(), coefficients.data());
    return coefficients;
}

/// exp(A h) and, column by column, phi_k(A h) b h for k = 1..count, phi_k(Z) = int_0^1 exp(Z (1 - s)) s^(k-1)/(k-1)! ds, both from
/// one exponential of A bordered by b and a chain of integrators.
struct Exponential {
    Eigen::MatrixXd decay, phi;
};

Exponential exponential(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, double h, Eigen::Index count)
{
    const auto n = A.rows();
    Eigen::MatrixXd bordered = Eigen::MatrixXd::Zero(n + count, n + count);
    bordered.topLeftCorner(n, n) = A * h;
    bordered.block(0, n, n, 1) = b * h;
    bordered.block(n, n + 1, count - 1, count - 1).setIdentity();
    const Eigen::MatrixXd solution = bordered.exp();
    return {solution.topLeftCorner(n, n), solution.topRightCorner(n, count)};
}

} // namespace

ExponentialStep::ExponentialStep(const Model& model, double h) : model_(model), electrical_(model.electrical())
{
    // Places of the linear part's states, and of the laws' memories, in z.
    std::vector<Eigen::Index> linearPlace {0, 1, 2}, lawPlace;
    Eigen::Index n = 3;
    Balance<double> atRest;
    for (const auto& component : model_.components) {
        const Eigen::Index size = component.effect->memorySize(component.extent);
        auto coefficients = coefficientsOf(component);
        auto& places = component.effect->linear() ? linearPlace : lawPlace;
        if (component.effect->linear()) {
            const std::vector<double> memory(static_cast<std::size_t>(size), 0.0);
            std::vector<double> unused(memory);
            component.effect->contribute(component.extent, coefficients.data(), {0.0, 0.0, 0.0}, memory.data(), unused.data(), atRest);
        } else {
            laws_.push_back({&component, std::move(coefficients), static_cast<Eigen::Index>(places.size())});
        }
        for (Eigen::Index k = 0; k < size; ++k)
            places.push_back(n++);
    }
    inductance_ = atRest.inductance;
    mass_ = atRest.mass;

    const auto part = linearize(linearPart(model));
    A_.setZero(n, n);
    Eigen::VectorXd B = Eigen::VectorXd::Zero(n);
    for (std::size_t row = 0; row < linearPlace.size(); ++row) {
        B[linearPlace[row]] = part.B[static_cast<Eigen::Index>(row)];
        for (std::size_t column = 0; column < linearPlace.size(); ++column)
            A_(linearPlace[row], linearPlace[column]) = part.A(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column));
    }
    const auto memories = static_cast<Eigen::Index>(lawPlace.size());
    const auto outputs = motions + memories, laws = rates + memories;
    Eigen::MatrixXd C = Eigen::MatrixXd::Zero(outputs, n), E = Eigen::MatrixXd::Zero(n, laws);
    C.topLeftCorner(3, 3).setIdentity();
    C.row(3) = A_.row(0);
    C.row(4) = A_.row(2);
    E(0, 0) = E(2, 1) = 1.0;
    for (Eigen::Index k = 0; k < memories; ++k) {
        const auto place = lawPlace[static_cast<std::size_t>(k)];
        C(motions + k, place) = E(place, rates + k) = 1.0;
    }

    const auto whole = exponential(A_, B, h, terms), half = exponential(A_, B, 0.5 * h, terms);
    linear_.setZero(n + 3 * outputs, n + terms);
    linear_.topLeftCorner(n, n) = whole.decay;
    linear_.block(n, 0, outputs, n) = C;
    linear_.block(n + outputs, 0, outputs, n) = C * half.decay;
    double factorial = 1.0;
    for (int k = 0; k < terms; ++k) {
        factorial *= std::max(k, 1);
        linear_.col(n + k).head(n) = factorial * whole.phi.col(k);
        linear_.col(n + k).segment(n + outputs, outputs) = factorial * std::pow(0.5, k) * (C * half.phi.col(k));
    }
    linear_.bottomRows(outputs) = C * linear_.topRows(n);

    quadrature_.resize(n, 3 * laws);
    stage_.resize(outputs, laws);
    later_.resize(outputs, laws);
    for (Eigen::Index q = 0; q < laws; ++q) {
        const auto phi = exponential(A_, E.col(q), h, 3).phi;
        quadrature_.col(q) = phi.col(0) - 3.0 * phi.col(1) + 4.0 * phi.col(2);
        quadrature_.col(laws + q) = 2.0 * phi.col(1) - 4.0 * phi.col(2);
        quadrature_.col(2 * laws + q) = 4.0 * phi.col(2) - phi.col(1);
        const Eigen::VectorXd Q = exponential(A_, E.col(q), 0.5 * h, 1).phi;
        stage_.col(q) = C * Q;
        later_.col(q) = C * (half.decay * Q);
    }
    from_.setZero(n + terms);
    run_.setZero(linear_.rows());
    y_.setZero(outputs);
    sums_.setZero(3 * laws);
    for (auto& N : N_)
        N.setZero(laws);
}

/// N at y_.
void ExponentialStep::ask(double u, double* N)
{
    Balance<double> sum;
    for (const auto& law : laws_)
        law.component->effect->contribute(law.component->extent, law.coefficients.data(), {y_[0], y_[1], y_[2]},
                                          y_.data() + motions + law.memory, N + rates + law.memory, sum);
    // The linear part's drop is u - L A_i z - u, its force m A_v z; the whole drop and force act on the whole inductance and mass.
    N[0] = electrical_ ? (inductance_ * y_[3] + u - sum.drop - sum.fluxSlope * y_[2]) / (inductance_ + sum.inductance) - y_[3] - u / inductance_
                       : 0.0;
    const double force = mass_ * (y_[4] + motion(u));
    N[1] = (force + sum.force) / (mass_ + sum.mass) - y_[4] - motion(u);
}

double ExponentialStep::acceleration(const double* z, double u)
{
    y_.noalias() = linear_.block(order(), 0, y_.size(), order()) * Eigen::Map<const Eigen::VectorXd>(z, order());
    ask(u, N_[0].data());
    return y_[4] + N_[0][1] + motion(u);
}

double ExponentialStep::step(double* z, std::span<const double> u)
{
    const auto n = A_.rows(), outputs = y_.size(), laws = N_[0].size();
    double middle = 0.0, end = 0.0;
    for (std::size_t k = u.size(); k-- > 0;) {
        middle = 0.5 * middle + u[k];
        end += u[k];
    }
    from_.head(n) = Eigen::Map<const Eigen::VectorXd>(z, n);
    for (std::size_t k = 0; k < terms; ++k)
        from_[n + static_cast<Eigen::Index>(k)] = k < u.size() ? u[k] : 0.0;
    run_.noalias() = linear_ * from_;
    const auto atStart = run_.segment(n, outputs), halfway = run_.segment(n + outputs, outputs), atEnd = run_.tail(outputs);

    auto& [N1, N2, N3, N4] = N_;
    y_ = atStart;
    ask(u[0], N1.data());
    y_ = halfway + stage_.lazyProduct(N1);
    ask(middle, N2.data());
    y_ = halfway + stage_.lazyProduct(N2);
    ask(middle, N3.data());
    sums_.head(laws) = 2.0 * N3 - N1;
    y_ = atEnd + later_.lazyProduct(N1) + stage_.lazyProduct(sums_.head(laws));
    ask(end, N4.data());
    sums_.head(laws) = N1;
    sums_.segment(laws, laws) = N2 + N3;
    sums_.tail(laws) = N4;
    const double acceleration = atStart[4] + N1[1] + motion(u[0]);
    run_.head(n).noalias() += quadrature_ * sums_;
    Eigen::Map<Eigen::VectorXd>(z, n) = run_.head(n);
    return acceleration;
}

double ExponentialStep::fastestLaw()
{
    // N moves di/dt and dv/dt alone, so its eigenvalues are those of its derivatives by i and v.
    double fastest = 0.0;
    for (const auto& law : laws_) {
        const auto& extent = law.component->extent;
        const double di = 1e-6 * extent.current, dv = 1e-6 * extent.velocity;
        for (const double i : {-extent.current, extent.current})
            for (int k = -4; k <= 4; ++k)
                for (const double v : {-extent.velocity, extent.velocity}) {
                    const auto at = [&](double current, double velocity) -> Eigen::Vector2d {
                        y_.setZero();
                        y_.head(3) << current, 0.25 * k * extent.displacement, velocity;
                        y_[3] = A_.row(0).head(3) * y_.head(3);
                        y_[4] = A_.row(2).head(3) * y_.head(3);
                        ask(0.0, N_[0].data());
                        return N_[0].head(2);
                    };
                    const Eigen::Vector2d here = at(i, v);
                    Eigen::Matrix2d J;
                    J << (at(i + di, v) - here) / di, (at(i, v + dv) - here) / dv;
                    if (J.allFinite())
                        fastest = std::max(fastest, J.eigenvalues().cwiseAbs().maxCoeff());
                }
    }
    return fastest;
}

} // namespace excursion
