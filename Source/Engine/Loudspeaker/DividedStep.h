// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/StepDivision.h"
#include "Engine/Loudspeaker/StepParts.h"

#include <Eigen/Core>

#include <span>

namespace excursion {

/// ExponentialStep in as many parts as the place asks for (StepDivision). The input of a part is the step's own
/// polynomial, on that part.
class DividedStep {
public:
    /// @param model     it must outlive this
    /// @param division  of the same model; it must outlive this
    /// @param h         whole step, s
    DividedStep(const Model& model, const StepDivision& division, double h);

    /// See ExponentialStep.
    void begin(const Eigen::VectorXd& z);
    void letSlowStand(bool stands);

    /// One whole step.
    /// @param u  see ExponentialStep::step
    /// @returns dv/dt at the step's start, m/s^2
    double step(std::span<const double> u);

    double current() const { return now_->current(); }            ///< A
    double displacement() const { return now_->displacement(); }  ///< m
    double velocity() const { return now_->velocity(); }          ///< m/s
    void state(Eigen::VectorXd& z) const { now_->state(z); }

private:
    void goOnWith(int power);

    const StepDivision& division_;
    StepParts steps_;
    int power_ = 0;
    ExponentialStep* now_;
    double before_ = 0.0;  // A, at the last step's start
    bool slowStands_ = false;
};

}  // namespace excursion
