// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Numerics/Search.h"
#include "Engine/Polynomial/Pnlss/PnlssFitOptions.h"
#include "Engine/Polynomial/Pnlss/Recursion.h"
#include "Engine/Polynomial/InputOutputRecord.h"

#include <limits>
#include <optional>
#include <vector>

namespace excursion {

/// The simulation error of a PNLSS model on its records, weighted along the spectrum where that is asked for, to be
/// lowered in its free coefficients and, where they are estimated, the first states of the records. The model, the
/// records and the options have to outlive it.
class SimulationError final : public SearchProblem {
public:
    SimulationError(const std::vector<InputOutputRecord>&, const PnlssFitOptions&, const Pnlss& structure);

    Eigen::Index parameters() const;
    /// @param initialStates  one a record; empty: zero. Of no account where they are not estimated
    Eigen::VectorXd valuesOf(const Pnlss&, const std::vector<Eigen::VectorXd>& initialStates = {}) const;
    Pnlss modelAt(const Eigen::VectorXd& values) const;

    /// One a record; empty where they are not estimated.
    std::vector<Eigen::VectorXd> initialStates(const Eigen::VectorXd& values) const;

    /// From now on a simulation that follows the measured output, with `strength` times the gain of a stationary Kalman
    /// filter that is made for states of the size that the linear model moves at the measured input. 0: a pure
    /// simulation.
    void guide(double strength, const Eigen::VectorXd& values);

    /// From now on no state may go further than a thousand times what the states do at these values. False where the
    /// model runs away there.
    bool holdBack(const Eigen::VectorXd& values);

    double cost(const Eigen::VectorXd& values) override;
    Eigen::MatrixXd factor(const Eigen::VectorXd& values) override;

    /// e'' by central differences; J^T e'' by the adjoint recursion.
    Eigen::VectorXd curvature(const Eigen::VectorXd& values, const Eigen::VectorXd& step) override;

private:
    double cost(const Pnlss&, const Eigen::VectorXd& values);
    bool play(const Pnlss&, const Eigen::VectorXd& values);  // all records; false where the model runs away
    Eigen::VectorXd initialState(const Eigen::VectorXd& values, std::size_t record) const;
    Eigen::VectorXd movement() const;  // of the last cost(), rms of each state
    Eigen::MatrixXd weighted(const Eigen::MatrixXd& columns) const;
    std::optional<Recursion::Guide> guideOf(const InputOutputRecord&) const;

    const Pnlss& structure_;
    const std::vector<InputOutputRecord>& records_;
    const PnlssFitOptions& options_;
    Recursion recursion_;
    Eigen::Index n_;
    double power_ = 0.0;
    double bound_ = std::numeric_limits<double>::infinity();
    Eigen::MatrixXd gain_;                                       // empty: not guided
    std::vector<Eigen::MatrixXd> states_, outputs_;              // of the last simulation
    std::vector<Eigen::MatrixXd> linearStates_, linearOutputs_;  // of that at which factor() made the error linear
};

}  // namespace excursion
