// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"
#include "Engine/Predistortion/LinearMotion.h"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <vector>

namespace excursion {

/// A point of a motion, with the derivatives that an inversion needs.
struct MotionPoint {
    double x = 0.0;  ///< m
    double v = 0.0;  ///< m/s
    double a = 0.0;  ///< m/s^2
    double j = 0.0;  ///< m/s^3, da/dt; 0 for a driver without a coil, whose force needs none
    double i = 0.0;  ///< A, the current with which the linear driver gets there
};

/// The motion of the driver if it were linear: the linear part of the model (SmallSignal.h), dz/dt = A z + B u, solved
/// exactly from sample to sample for an input that is the cubic through the latest four samples,
///     z(n) = exp(A T) z(n-1) + sum_{k=0..3} g_k u(n-k).
/// Position, velocity, acceleration and jerk are read from the same state, so that each is the derivative of the one
/// before it: a = (A z + B u)_v, j = (A (A z + B u))_v. An inversion needs this consistency, and not agreement with the
/// linear driver to the last digit: the interpolation error, 0.03 (w T)^4 of the motion, is linear and cancels in the
/// inversion. The state is kept in the coordinates of the eigenvectors of A, where exp(A T) has only blocks of size one
/// and two. If the eigenvectors are so close to one another that digits would be lost (a driver with just critical
/// damping), the state is kept as it is.
class Reference {
public:
    /// @param sampleRate  Hz, of step()
    Reference(const Model&, double sampleRate);

    /// For any linear motion. Its points give x and i, in the same states as those of a driver.
    Reference(const LinearMotion&, double sampleRate);

    void reset();
    const MotionPoint& step(double u);  ///< V, or N for a driver without a coil; returns the motion at this sample

    /// As if the latest sample had been larger by this difference.
    const MotionPoint& correct(double difference);

    const MotionPoint& motion() const { return point_; }  ///< at the latest sample
    Eigen::Map<const Eigen::VectorXd> state() const { return {state_.data(), static_cast<Eigen::Index>(order_)}; }
    /// The state of SmallSignal.h per state that is kept here: z = basis state.
    const Eigen::MatrixXd& basis() const { return basis_; }

private:
    using Rows = std::vector<double>;

    /// @param outputs  x, v, a, j and i per state
    void prepare(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, Eigen::MatrixXd outputs, double sampleRate);

    std::size_t order_, rows_;  ///< rows_: the order, padded to a multiple of lanes
    bool electrical_ = false;
    Eigen::Index pairs_ = 0;  ///< number of blocks of two, at the state's beginning
    bool dense_ = false;
    Rows transition_;  ///< if dense, by columns
    Rows laid_;        ///< the rest of a step, four states at a time
    Rows byNow_;       ///< g_0
    double accelerationInput_ = 0.0, jerkInput_ = 0.0;
    Eigen::MatrixXd basis_;
    MotionPoint byInput_;            ///< direct contribution of u(n) to the motion
    std::array<double, 4> past_ {};  ///< u(n) .. u(n-3)
    Rows state_, next_;
    MotionPoint point_;
};

}  // namespace excursion
