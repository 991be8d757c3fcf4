// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Driver/ExponentialStep.h"

#include "Engine/Driver/Exponential.h"
#include "Engine/Driver/Linearize.h"
#include "Engine/Driver/TallProduct.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <complex>

namespace excursion {
namespace {

/// max |lambda|; of two rows from lambda^2 - tr(J) lambda + det(J) = 0.
double spectralRadius(const Eigen::MatrixXd& J)
{
    if (J.rows() > 2)
        return J.eigenvalues().cwiseAbs().maxCoeff();
    const std::complex<double> half = 0.5 * J.trace(), root = std::sqrt(half * half - J.determinant());
    return std::max(std::abs(half + root), std::abs(half - root));
}

} // namespace

ExponentialStep::ExponentialStep(const Model& model, double h) : model_(model), electrical_(model.electrical())
{
    linearPlace_ = {0, 1, 2};
    Eigen::Index n = 3;
    Balance<double> atRest;
    for (const auto& component : model_.components) {
        const Eigen::Index size = component.effect->memorySize(component.extent);
        auto coefficients = coefficientsOf(component, valuesOf(component));
        auto& places = component.effect->linear() ? linearPlace_ : lawPlace_;
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
    for (std::size_t row = 0; row < linearPlace_.size(); ++row) {
        B[linearPlace_[row]] = part.B[static_cast<Eigen::Index>(row)];
        for (std::size_t column = 0; column < linearPlace_.size(); ++column)
            A_(linearPlace_[row], linearPlace_[column]) = part.A(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column));
    }
    const auto memories = static_cast<Eigen::Index>(lawPlace_.size());
    const auto outputs = motions + memories, laws = rates + memories;
    Eigen::MatrixXd C = Eigen::MatrixXd::Zero(outputs, n);
    E_.setZero(n, laws);
    C.topLeftCorner(3, 3).setIdentity();
    C.row(3) = A_.row(0);
    C.row(4) = A_.row(2);
    E_(0, 0) = E_(2, 1) = 1.0;
    for (Eigen::Index k = 0; k < memories; ++k) {
        const auto place = lawPlace_[static_cast<std::size_t>(k)];
        C(motions + k, place) = E_(place, rates + k) = 1.0;
    }

    const auto whole = exponential(A_, B, h, terms), half = exponential(A_, B, 0.5 * h, terms);
    linear_.setZero(padded(n + 3 * outputs), n + terms);
    linear_.topLeftCorner(n, n) = whole.decay;
    linear_.block(n, 0, outputs, n) = C;
    for (int k = 0; k < terms; ++k)
        linear_.col(n + k).head(n) = std::tgamma(k + 1.0) * whole.phi.col(k);
    linear_.middleRows(n + 2 * outputs, outputs) = C * linear_.topRows(n);

    halfway_.resize(n, n + terms);
    halfway_.leftCols(n) = half.decay;
    for (int k = 0; k < terms; ++k)
        halfway_.col(n + k) = std::tgamma(k + 1.0) * std::pow(0.5, k) * half.phi.col(k);
    linear_.middleRows(n + outputs, outputs) = C * halfway_;

    quadrature_.resize(n, 3 * laws);
    Q_.resize(n, laws);
    for (Eigen::Index q = 0; q < laws; ++q) {
        const auto weights = quadrature(A_, E_.col(q), h);
        for (Eigen::Index point = 0; point < 3; ++point)
            quadrature_.col(point * laws + q) = weights.col(point);
        Q_.col(q) = exponential(A_, E_.col(q), 0.5 * h, 1).phi;
    }
    stage_ = C * Q_;
    last_ = C * (half.decay * Q_);
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

std::pair<double, double> ExponentialStep::later(std::span<const double> u)
{
    double middle = 0.0, end = 0.0;
    for (std::size_t k = u.size(); k-- > 0;) {
        middle = 0.5 * middle + u[k];
        end += u[k];
    }
    return {middle, end};
}

double ExponentialStep::step(double* z, std::span<const double> u)
{
    const auto n = A_.rows(), outputs = y_.size(), laws = N_[0].size();
    const auto [middle, end] = later(u);
    from_.head(n) = Eigen::Map<const Eigen::VectorXd>(z, n);
    for (std::size_t k = 0; k < terms; ++k)
        from_[n + static_cast<Eigen::Index>(k)] = k < u.size() ? u[k] : 0.0;
    run_.setZero();
    addTallProduct(linear_.data(), linear_.rows(), linear_.cols(), from_.data(), 1, run_.data(), 0, linear_.rows());
    const auto atStart = run_.segment(n, outputs), halfway = run_.segment(n + outputs, outputs), atEnd = run_.segment(n + 2 * outputs, outputs);

    auto& [N1, N2, N3, N4] = N_;
    y_ = atStart;
    ask(u[0], N1.data());
    y_ = halfway + stage_.lazyProduct(N1);
    ask(middle, N2.data());
    y_ = halfway + stage_.lazyProduct(N2);
    ask(middle, N3.data());
    sums_.head(laws) = 2.0 * N3 - N1;
    y_ = atEnd + last_.lazyProduct(N1) + stage_.lazyProduct(sums_.head(laws));
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
    // N moves di/dt, dv/dt and the laws' memories alone, so its eigenvalues are those of its derivatives by i, v and these memories.
    const auto laws = N_[0].size(), memories = laws - rates;
    double fastest = 0.0;
    for (const auto& law : laws_) {
        const auto& extent = law.component->extent;
        for (const double i : {-extent.current, extent.current})
            for (int k = -4; k <= 4; ++k)
                for (const double v : {-extent.velocity, extent.velocity}) {
                    const auto at = [&](double current, double velocity, Eigen::Index memory) -> Eigen::VectorXd {
                        y_.setZero();
                        y_.head(3) << current, 0.25 * k * extent.displacement, velocity;
                        y_[3] = A_.row(0).head(3) * y_.head(3);
                        y_[4] = A_.row(2).head(3) * y_.head(3);
                        if (memory >= 0)
                            y_[motions + memory] = 1.0;   // what is affine in them does not mind the size
                        ask(0.0, N_[0].data());
                        return N_[0];
                    };
                    const double di = 1e-6 * extent.current, dv = 1e-6 * extent.velocity;
                    const Eigen::VectorXd here = at(i, v, -1);
                    Eigen::MatrixXd J(laws, laws);
                    J.col(0) = (at(i + di, v, -1) - here) / di;
                    J.col(1) = (at(i, v + dv, -1) - here) / dv;
                    for (Eigen::Index m = 0; m < memories; ++m)
                        J.col(rates + m) = at(i, v, m) - here;
                    if (J.allFinite())
                        fastest = std::max(fastest, spectralRadius(J));
                }
    }
    return fastest;
}

} // namespace excursion
