// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Predistortion/Reference.h"

#include "Engine/Loudspeaker/SmallSignal.h"
#include "Engine/Numerics/Exponential.h"
#include "Engine/Numerics/Lanes.h"
#include "Engine/Predistortion/CubicDrive.h"
#include "Engine/Predistortion/Modes.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace excursion {
namespace {

std::vector<double> padded(const Eigen::VectorXd& values, std::size_t rows)
{
    std::vector<double> result(values.data(), values.data() + values.size());
    result.resize(rows, 0.0);
    return result;
}

/// One step by the latest four samples, and the five outputs that are read from the state.
EXCURSION_DISPATCH void advance(std::size_t rows, const double* laid, const double* past, double* state, double* motion)
{
    advanceLaid<4, 5>(rows, laid, past, state, motion);
}

}  // namespace

Reference::Reference(const Model& model, double sampleRate) : electrical_(model.electrical())
{
    const auto linear = smallSignal(linearPart(model));
    const auto& A = linear.A;
    Eigen::MatrixXd outputs = Eigen::MatrixXd::Zero(5, A.rows());
    outputs(0, 1) = outputs(1, 2) = outputs(4, 0) = 1.0;
    outputs.row(2) = A.row(2);
    outputs.row(3) = A.row(2) * A;
    accelerationInput_ = linear.B[2];
    jerkInput_ = A.row(2).dot(linear.B);
    prepare(A, linear.B, std::move(outputs), sampleRate);
}

Reference::Reference(const LinearMotion& motion, double sampleRate)
{
    Eigen::MatrixXd outputs = Eigen::MatrixXd::Zero(5, motion.A.rows());
    outputs.row(0) = motion.displacement;
    if (motion.current.size() > 0)
        outputs.row(4) = motion.current;
    prepare(motion.A, motion.B, std::move(outputs), sampleRate);
}

void Reference::prepare(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, Eigen::MatrixXd outputs, double sampleRate)
{
    const auto n = A.rows();
    order_ = static_cast<std::size_t>(n);
    rows_ = roundedUpToLanes(order_);

    auto [transition, phi] = exponential(A, B, 1.0 / sampleRate, 4);
    Eigen::MatrixXd inputs = bySamples(phi);

    const auto modes = modesOf(A);
    dense_ = !modes.apart;
    if (dense_) {
        basis_ = Eigen::MatrixXd::Identity(n, n);
        for (Eigen::Index column = 0; column < n; ++column) {
            const auto rows = padded(transition.col(column), rows_);
            transition_.insert(transition_.end(), rows.begin(), rows.end());
        }
    } else {
        basis_ = modes.basis;
        pairs_ = modes.pairs;
        transition = (modes.inverse * transition * basis_).eval();
        inputs = (modes.inverse * inputs).eval();
        outputs = (outputs * basis_).eval();
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
    laid_ = laidOut(laid);
    byNow_ = laid[2];
    const Eigen::VectorXd direct = outputs * inputs.col(0);
    byInput_ = {direct[0], direct[1], direct[2] + accelerationInput_, electrical_ ? direct[3] + jerkInput_ : 0.0,
                direct[4]};
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
    point_ = {motion[0], motion[1], motion[2] + accelerationInput_ * u, electrical_ ? motion[3] + jerkInput_ * u : 0.0,
              motion[4]};
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

}  // namespace excursion
