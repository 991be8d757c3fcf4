// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/ExponentialStep.h"

#include <span>
#include <vector>

namespace excursion {

/// ExponentialStep together with the derivatives S = dz/dtheta of the state by parameters of the model, which obey
///     dS/dt = A S + E (N_y C S + N_theta) + (dA/dtheta) z + (dB/dtheta) u
/// with the same A. So the same exponentials apply, for all parameters at once. The derivatives of the laws, N_y and
/// N_theta, come from the same physics run on jets, at the start, the middle and the end of a step.
class SensitivityStep {
public:
    /// @param active  the parameters to differentiate by, in the order of parametersOf(); those of the path act on no
    ///                state
    SensitivityStep(const Model&, double h, std::span<const Eigen::Index> active);

    int order() const { return motion_.order(); }

    /// Starts at state z with derivatives S (parameters x states).
    void begin(const Eigen::VectorXd& z, const Eigen::MatrixXd& S);

    /// See ExponentialStep.
    void letSlowStand(bool stands);

    /// One step; see ExponentialStep.
    void step(std::span<const double> u);

    double current() const { return motion_.current(); }            ///< A, at the latest step's end
    double displacement() const { return motion_.displacement(); }  ///< m
    double velocity() const { return motion_.velocity(); }          ///< m/s
    void state(Eigen::VectorXd& z) const { motion_.state(z); }
    /// parameters x states (i, x, v first, the laws' memories last), at the latest step's end
    auto slopes() const { return S_.topRows(count_); }
    /// The same in the order of Dynamics.
    void slopesByState(Eigen::MatrixXd& out) const;
    double acceleration() const { return acceleration_; }  ///< dv/dt at the latest step's start, m/s^2
    /// at the latest step's start, by parameter
    const Eigen::VectorXd& accelerationSlopes() const { return accelerationSlopes_; }

private:
    static constexpr int none = -1;

    /// Up to jetWidth directions in which one law is differentiated at once: motions and memories (places in y), or
    /// parameters.
    struct Chunk {
        std::size_t law;
        std::vector<Jet> coefficients;
        std::array<int, jetWidth> output, parameter;  ///< place in y, or column in S, of each direction; or none
        Balance<Jet> sum;
        std::vector<Jet> memory, rate;
    };
    /// The drive of S at one instant.
    struct Instant {
        Eigen::MatrixXd Ny;      ///< y x laws
        Eigen::MatrixXd Ntheta;  ///< parameters x laws
        Eigen::MatrixXd memory;  ///< parameters x the linear part's memories that parameters act upon
    };
    /// dA or dB by an active parameter, where it is not zero.
    struct Entry {
        /// states in the order of ExponentialStep; the column after A's last is B
        Eigen::Index parameter, row, column;
        double value;
    };

    /// @param columns  by parameter of a component: its column in S, or none
    void addLaw(std::size_t law, const std::vector<Eigen::Index>& columns);
    void addLinear(const Model&, const std::vector<std::vector<Eigen::Index>>& columnsByComponent);
    void look(const double* z, const double* memory, double u, Instant&);

    ExponentialStep motion_;
    Eigen::Index count_;
    std::vector<Chunk> chunks_;
    std::vector<Entry> entries_;
    std::vector<Eigen::Index> place_;             ///< by linear state: its column in Instant::memory, or none
    Eigen::VectorXd dInductance_, dMass_;         ///< of the linear part, by parameter
    std::vector<Eigen::Index> linearParameters_;  ///< columns of S whose parameters belong to the linear part
    double step_ = 0.0;
    // The free evolution of S, with columns in the order of ExponentialStep: states that drive coil and cone do not
    // depend on those that follow.
    Eigen::MatrixXd carryMoving_, carryFollowing_;  ///< -> S at the end, its first and its last columns
    /// -> (A_i z, A_v z) now, motions halfway, (A_i z, A_v z) at the end
    Eigen::MatrixXd carryMotions_;
    Eigen::MatrixXd stageWeights_, laterWeights_, quadratureWeights_;  ///< those of ExponentialStep, transposed
    std::array<Eigen::MatrixXd, 3> memoryQuadrature_;
    Eigen::MatrixXd memoryStage_, memoryLater_;
    Eigen::Index memoryFrom_ = 0, memoryTo_ = 0;  ///< rows of S whose parameters act upon memories
    double acceleration_ = 0.0;
    TiledProduct toHalfway_;
    Eigen::VectorXd middle_, remembered_;  ///< linear states and the laws' memories halfway
    Eigen::VectorXd y_, accelerationSlopes_;
    /// rows, one per parameter, are padded; S: the linear part's states, then the laws' memories
    Eigen::MatrixXd S_, run_, now_, later_, Y_, K_, twice_;
    std::array<Eigen::MatrixXd, 4> stage_;
    Instant start_, halfway_, end_;
    bool fresh_ = true;
};

}  // namespace excursion
