// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Numerics/LaidRows.h"
#include "Engine/Predistortion/LinearMotion.h"
#include "Engine/Predistortion/Reference.h"

#include <Eigen/Core>

#include <vector>

namespace excursion {

/// How a cone shifts where an amplifier withholds the mean of the correction (LinearMotion::correction). What of it was
/// asked for is told, tick by tick. What of it will be asked for is unknown: it is taken to lie between none, what was
/// asked for lately, and the means of tones that go as far as the cone will.
///
/// Thread: after construction nothing allocates, locks or throws.
class ConeShift {
public:
    /// @param spacing  s, of step()
    /// @param tick     s, of tell()
    /// @param times    s, at which a cone that coasts from now on is looked at; ahead: at which a plan is
    ConeShift(const LinearMotion&, double spacing, double tick, const Eigen::VectorXd& times,
              const Eigen::VectorXd& ahead);

    bool happens() const { return happens_; }
    void reset();
    void tell(double correction);  ///< V, mean of a tick
    void step();

    /// Adds the shift so far, as it will be at the times if what was asked for lately goes on.
    /// @param coasting  Foresight::coasting at the times
    void addTo(Eigen::VectorXd& x, const LaidRows& coasting);

    /// The shift at the times of a plan by what will be asked for: its middle, and how far from that it may be.
    /// @param reach  m, how far the cone will go
    void foresee(double reach);
    const Eigen::VectorXd& middle() const { return middle_; }  ///< m
    const Eigen::VectorXd& range() const { return range_; }    ///< m

private:
    bool happens_;
    Reference soFar_;
    Eigen::VectorXd perVolt_, perVoltAhead_;  ///< m/V, of a correction that lasts, at the times
    double grid_;                             ///< m
    std::vector<double> least_, most_;        ///< V, see LinearMotion
    double share_;                            ///< that a tick has of the running mean
    double told_ = 0.0, lately_ = 0.0;        ///< V; lately_: running mean
    Eigen::VectorXd middle_, range_, coasted_;
};

}  // namespace excursion
