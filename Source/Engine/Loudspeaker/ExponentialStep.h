// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"
#include "Engine/Numerics/TiledProduct.h"

#include <Eigen/Core>

#include <array>
#include <span>
#include <utility>
#include <vector>

namespace excursion {

/// One step of a model's simulation by exponential time differencing (ETDRK4: Cox & Matthews 2002, J. Comput. Phys.
/// 176). The equations of Dynamics are split,
///     dz/dt = A z + B u + E N,
/// into the linear part A, B of the base, the ladders and the relaxations, and the contributions N of the laws to a few
/// rates: di/dt, dv/dt, and the rates of their own memories, if any. The linear part is exact for inputs that are
/// polynomials on the step, no matter how stiff it is. The laws' part is of fourth order. N depends on only a few
/// outputs,
///     y = (i, x, v, A_i z, A_v z, the laws' memories) = C z,
/// so the stages within a step are found from y alone, and a step costs little more than one product of exp(A h) and z.
/// Zeros in that product are skipped: a state that drives neither coil nor cone (a mode that is only heard) follows the
/// others and does not act on them, and only the laws change the laws' memories.
///
/// Thread: after construction nothing allocates, locks or throws.
class ExponentialStep {
public:
    static constexpr int terms = 7;  ///< coefficients of an input polynomial
    static constexpr std::array<double, 1> fullSpeed {1.0};

    /// @param model  it need not outlive this
    /// @param h      step, s
    ExponentialStep(const Model& model, double h);
    ExponentialStep(const ExponentialStep&) = delete;  // the laws point into the model

    /// Length of the state z = (i, x, v, memories in order), as in Dynamics.
    int order() const { return static_cast<int>(z_.size()); }

    /// Starts at state z; at first it is at rest.
    void begin(const Eigen::VectorXd& z);

    /// Goes on from where a step of the same model and another length is.
    void takeOver(const ExponentialStep& other) { z_ = other.z_; }

    /// While a drive leads in, what is slow (Effect::slow) can stand still.
    void letSlowStand(bool stands) { slowStands_ = stands; }

    /// Advances by h, and returns dv/dt at the step's start, m/s^2.
    /// @param u  coefficients of the input on the step, u(s) = sum u_k s^k, 0 <= s <= 1, V (or N); at most `terms`
    double step(std::span<const double> u);

    double current() const { return z_[0]; }       ///< A
    double displacement() const { return z_[1]; }  ///< m
    double velocity() const { return z_[2]; }      ///< m/s
    void state(Eigen::VectorXd& z) const;

    /// The eigenvalue of dN/d(i, v, the laws' memories) that is largest in size over the visited range (1/s). Up to 2/h
    /// steps are stable; where the linear part is fast as well they may be beyond it (isStable).
    double fastestLaw();

    /// Where the laws are looked at: all over the visited range, or where (x/X)^2 + (i/I)^2 <= 1. Beyond that a fit
    /// knows little of a law, as the largest current seldom meets the largest excursion.
    enum class Places { all, likely };
    /// What the laws do about a place.
    struct LawSlope {
        const OperatingRange* range;             ///< of a law; it lives as long as this step
        double current, displacement, velocity;  ///< of the place, shares of the range
        Eigen::MatrixXd slope;                   ///< J = dN/dy there, rates and the laws' memories x y
    };
    /// It depends on no step.
    /// @param speeds  shares of the velocity's range, both ways
    std::vector<LawSlope> lawSlopes(Places = Places::all, std::span<const double> speeds = fullSpeed);

    /// Whether the difference between two motions grows no more within a step than the equations let it grow, about a
    /// place. The laws are linear about a place, N = J y, and the step is a matrix there,
    /// whose eigenvalues tell. What loops in the iron take from the coil is stiff and exact, but for the share
    /// by which a law changes the inductance: if it changes from L0 to L, a long step multiplies what it was by
    /// 2 q^4 - q^2, q = L0/L - 1, no matter how fast the loops are.
    /// @param slope  of lawSlopes()
    bool isStable(const Eigen::MatrixXd& slope) const;
    /// About each of these places.
    bool isStable(const std::vector<LawSlope>&) const;

private:
    friend class ExponentialAdams;
    friend class SensitivityStep;

    static constexpr Eigen::Index rates = 2;    // di/dt and dv/dt lead N
    static constexpr Eigen::Index motions = 5;  // i, x, v, A_i z and A_v z lead y

    using Motions = Eigen::Matrix<double, motions, 1>;

    struct Law {
        const Component* component;
        std::vector<double> coefficients;
        Eigen::Index memory;  ///< where its memory starts among the laws' memories
        Eigen::Index slow;    ///< its size if it is slow (Effect::slow), else none
    };

    /// Whether it is a law with an effect on the motion.
    static bool isLaw(const Component&);

    /// The input halfway and at the end of the step.
    static std::pair<double, double> later(std::span<const double> u);
    /// m/s^2, direct effect of the input
    double motion(double u) const { return electrical_ ? 0.0 : u / mass_; }
    void ask(double u, double* N);

    /// Columns for the linear part's states, then inputs, as `from_` has them.
    Eigen::MatrixXd arranged(const Eigen::MatrixXd& map) const;

    /// What the laws make of (i, v, their memories), which are all that N moves.
    Eigen::MatrixXd among(const Eigen::MatrixXd& J) const;
    /// How the difference d of two motions near a place goes on, of (the states that act, the laws' memories):
    /// dd/dt = rate d, and d(h) = step d(0).
    struct Difference {
        Eigen::MatrixXd rate, step;
    };
    Difference differenceNear(const Eigen::MatrixXd& J) const;

    const Model model_;
    std::vector<Law> laws_;
    bool electrical_, slowStands_ = false;
    double step_;                           ///< s
    double inductance_ = 0.0, mass_ = 0.0;  ///< of the linear part
    double byVoltage_ = 0.0;                ///< 1/inductance_
    // The linear part's states: first those that act on coil and cone, led by i, x and v, then those that only follow.
    Eigen::Index moving_ = 0;
    /// of the linear part's states, and of the laws' memories, in the state
    std::vector<Eigen::Index> linearPlace_, lawPlace_;
    Eigen::MatrixXd A_;
    Eigen::MatrixXd C_;  ///< linear states -> (i, x, v, A_i z, A_v z)
    Eigen::MatrixXd E_;  ///< contribution of the laws to di/dt and dv/dt
    /// (linear states, u) -> linear states at the end, halfway, without the laws
    Eigen::MatrixXd whole_, halfway_;
    /// (E_'s rates at the start, sum of both halfway, at the end) -> their contribution to the linear states
    Eigen::MatrixXd quadrature_;
    Eigen::MatrixXd Q_;                                   ///< int exp(A t) E dt over h/2
    Eigen::Matrix<double, motions, rates> stage_, last_;  ///< C Q and C exp(A h/2) Q

    TiledProduct carry_, drive_;  ///< of from_, and of the laws' rates, to run_
    std::vector<double> from_;    ///< moving, u, following
    /// moving at the end, (A_i z, A_v z) at the start, motions halfway, (A_i z, A_v z) at the end, following at the end
    std::vector<double> run_;
    Eigen::VectorXd z_;  ///< linear states, then the laws' memories
    Eigen::VectorXd y_;
    std::array<Eigen::VectorXd, 4> N_;
};

}  // namespace excursion
