// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Linearization/Reference.h"

#include "Engine/Dispatch.h"
#include "Engine/Driver/Linearize.h"
#include "Engine/Linearization/Cubic.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <unsupported/Eigen/MatrixFunctions>

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

/// How many digits the change to the eigenvectors may cost.
constexpr double worstCondition = 1e6;

/// Sizes of the states with which rows and columns of A have like sums (Osborne, J. ACM 7, 1960), so that the condition of its
/// eigenvectors does not hang on units.
Eigen::VectorXd balance(Eigen::MatrixXd A)
{
    Eigen::VectorXd size = Eigen::VectorXd::Ones(A.rows());
    for (int round = 0; round < 50; ++round)
        for (Eigen::Index k = 0; k < A.rows(); ++k) {
            const double own = std::abs(A(k, k));
            const double column = A.col(k).cwiseAbs().sum() - own, row = A.row(k).cwiseAbs().sum() - own;
            if (column <= 0.0 || row <= 0.0)
                continue;
            const double factor = std::sqrt(row / column);
            A.col(k) *= factor;
            A.row(k) /= factor;
            size[k] *= factor;
        }
    return size;
}

/// Real eigenvectors, of unit length: first the pairs (real and imaginary part), then the real ones.
Eigen::MatrixXd eigenvectors(const Eigen::MatrixXd& A, Eigen::Index& pairs)
{
    const Eigen::EigenSolver<Eigen::MatrixXd> solver(A);
    const auto n = A.rows();
    Eigen::MatrixXd vectors(n, n);
    Eigen::Index column = 0;
    for (const bool complex : {true, false}) {
        for (Eigen::Index k = 0; k < n; ++k) {
            const double turn = solver.eigenvalues()[k].imag();
            const Eigen::VectorXcd vector = solver.eigenvectors().col(k);
            if (complex && turn > 0.0) {
                vectors.col(column++) = vector.real();
                vectors.col(column++) = vector.imag();
            } else if (!complex && turn == 0.0) {
                vectors.col(column++) = vector.real();
            }
        }
        if (complex)
            pairs = column / 2;
    }
    return vectors;
}

std::vector<double> padded(const Eigen::VectorXd& values, std::size_t rows)
{
    std::vector<double> result(values.data(), values.data() + values.size());
    result.resize(rows, 0.0);
    return result;
}

/// What is laid out for four states: the diagonal of the transition, what each takes of its neighbour in a block of two, g_0 .. g_3 and the five outputs.
constexpr std::size_t laidRows = 2 + 4 + 5;

/// One step of the state, and the five sums of what is read from it.
EXCURSION_DISPATCH void advance(std::size_t rows, const double* laid, const double* past, double* state, double* motion)
{
    Four sums[5] = {};
    for (std::size_t row = 0; row < rows; row += 4) {
        const auto* const four = reinterpret_cast<const Four*>(laid + laidRows * row);
        auto& here = *reinterpret_cast<Four*>(state + row);
        Four next = four[0] * here + four[1] * __builtin_shufflevector(here, here, 1, 0, 3, 2);
        for (int k = 0; k < 4; ++k)
            next += past[k] * four[2 + k];
        here = next;
        for (int k = 0; k < 5; ++k)
            sums[k] += next * four[6 + k];
    }
    for (int k = 0; k < 5; ++k)
        motion[k] = (sums[k][0] + sums[k][1]) + (sums[k][2] + sums[k][3]);
}

} // namespace

Reference::Reference(const Model& model, double sampleRate) : electrical_(model.electrical())
{
    const auto linear = linearize(linearPart(model));
    const auto& A = linear.A;
    const auto n = A.rows();
    order_ = static_cast<std::size_t>(n);
    rows_ = (order_ + lanes - 1) / lanes * lanes;

    // The input on the step, s = 0 .. 1, is a chain of integrators beside the state: u and its derivatives with respect to s.
    Eigen::MatrixXd chain = Eigen::MatrixXd::Zero(n + 4, n + 4);
    chain.topLeftCorner(n, n) = A / sampleRate;
    chain.block(0, n, n, 1) = linear.B / sampleRate;
    for (Eigen::Index k = 0; k < 3; ++k)
        chain(n + k, n + k + 1) = 1.0;
    const Eigen::MatrixXd solution = chain.exp();
    Eigen::MatrixXd transition = solution.topLeftCorner(n, n), inputs(n, 4), outputs = Eigen::MatrixXd::Zero(5, n);
    for (std::size_t sample = 0; sample < 4; ++sample) {
        std::array<double, 4> u {};
        u[sample] = 1.0;
        const auto cubic = Cubic::through(u[3], u[2], u[1], u[0]);
        inputs.col(static_cast<Eigen::Index>(sample)) = solution.block(0, n, n, 4)
                                                      * Eigen::Vector4d(cubic.c[0], cubic.c[1], 2.0 * cubic.c[2], 6.0 * cubic.c[3]);
    }
    outputs(0, 1) = outputs(1, 2) = outputs(4, 0) = 1.0;
    outputs.row(2) = A.row(2);
    outputs.row(3) = A.row(2) * A;
    accelerationInput_ = linear.B[2];
    jerkInput_ = A.row(2).dot(linear.B);

    const auto size = balance(A);
    Eigen::MatrixXd vectors = eigenvectors(size.cwiseInverse().asDiagonal() * A * size.asDiagonal(), pairs_);
    const Eigen::VectorXd singular = Eigen::JacobiSVD<Eigen::MatrixXd>(vectors).singularValues();
    basis_ = Eigen::MatrixXd::Identity(n, n);
    dense_ = !(singular[0] < worstCondition * singular[n - 1]);
    if (dense_) {
        pairs_ = 0;
        for (Eigen::Index column = 0; column < n; ++column) {
            const auto rows = padded(transition.col(column), rows_);
            transition_.insert(transition_.end(), rows.begin(), rows.end());
        }
    } else {
        vectors = size.asDiagonal() * vectors;
        basis_ = vectors;
        const Eigen::FullPivLU<Eigen::MatrixXd> solver(vectors);
        transition = solver.solve(transition * vectors).eval();
        inputs = solver.solve(inputs).eval();
        outputs = (outputs * vectors).eval();
    }
    // A dense transition is made by itself, and leaves what is laid out with a diagonal of ones.
    Rows diagonal(rows_, dense_ ? 1.0 : 0.0), turn(rows_, 0.0);
    if (!dense_) {
        diagonal = padded(transition.diagonal(), rows_);
        for (std::size_t k = 0; k < 2 * static_cast<std::size_t>(pairs_); k += 2) {
            const auto first = static_cast<Eigen::Index>(k);
            turn[k] = 0.5 * (transition(first, first + 1) - transition(first + 1, first));
            turn[k + 1] = -turn[k];
        }
    }
    std::vector<Rows> laid {diagonal, turn};
    for (Eigen::Index k = 0; k < inputs.cols(); ++k)
        laid.push_back(padded(inputs.col(k), rows_));
    for (Eigen::Index k = 0; k < outputs.rows(); ++k)
        laid.push_back(padded(outputs.row(k).transpose(), rows_));
    for (std::size_t row = 0; row < rows_; row += lanes)
        for (const auto& values : laid)
            laid_.insert(laid_.end(), values.begin() + static_cast<std::ptrdiff_t>(row), values.begin() + static_cast<std::ptrdiff_t>(row + lanes));
    byNow_ = laid[2];
    const Eigen::VectorXd direct = outputs * inputs.col(0);
    byInput_ = {direct[0], direct[1], direct[2] + accelerationInput_, electrical_ ? direct[3] + jerkInput_ : 0.0, direct[4]};
    state_.assign(rows_, 0.0);
    next_.assign(rows_, 0.0);
}

void Reference::reset()
{
    std::fill(state_.begin(), state_.end(), 0.0);
    past_ = {};
    point_ = {};
}

const MotionPoint& Reference::step(double u)
{
    past_ = {u, past_[0], past_[1], past_[2]};
    std::array<double, 5> motion {};
    if (dense_) {
        std::fill(next_.begin(), next_.end(), 0.0);
        for (std::size_t k = 0; k < order_; ++k)
            for (std::size_t row = 0; row < rows_; ++row)
                next_[row] += state_[k] * transition_[k * rows_ + row];
        state_.swap(next_);
    }
    advance(rows_, laid_.data(), past_.data(), state_.data(), motion.data());
    point_ = {motion[0], motion[1], motion[2] + accelerationInput_ * u, electrical_ ? motion[3] + jerkInput_ * u : 0.0, motion[4]};
    return point_;
}

const MotionPoint& Reference::correct(double difference)
{
    past_[0] += difference;
    for (std::size_t row = 0; row < rows_; ++row)
        state_[row] += difference * byNow_[row];
    const auto add = [difference](double& value, double byInput) { value += difference * byInput; };
    add(point_.x, byInput_.x);
    add(point_.v, byInput_.v);
    add(point_.a, byInput_.a);
    add(point_.j, byInput_.j);
    add(point_.i, byInput_.i);
    return point_;
}

} // namespace excursion
