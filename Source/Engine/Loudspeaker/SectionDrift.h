// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/FedLaws.h"
#include "Engine/Loudspeaker/Residual.h"

#include <Eigen/Core>

#include <complex>
#include <vector>

namespace excursion {

/// What K and Re of a section are more than those of the model, and the residuals without that. A suspension that has
/// been worked is softer for a while, and a coil that has been played is warmer: between the sections of a take both
/// move by tenths of a per cent, which at -50 dB and less no other parameter can follow. To first order a drift by
/// (kappa, rho) acts as the force -kappa K X on the cone and the voltage -rho Re I at the terminals, through the linear
/// part. With their residuals a = [a_K, a_R] of all channels together,
///     (kappa, rho) = -M^-1 a^T r,   M = a^T a + diag(1/sigma^2),
///     r <- r + a (kappa, rho),   J <- J - a M^-1 a^T J,
/// so that slopes are those of a model whose drift follows (variable projection, Golub & Pereyra 1973, SIAM J. Numer.
/// Anal. 10; what the moves themselves cost is left out, as it is next to nothing). sigma: 2 % of K, 0.5 % of Re. K and
/// Re of the model are those of the first section of the quietest level that fits see: there nothing is worked yet, and
/// what is not told against one section would be told of none.
class SectionDrift {
public:
    using Spectrum = std::vector<std::complex<double>>;

    struct Amount {
        double stiffness = 0.0, resistance = 0.0;  ///< shares of K and Re
    };

    /// Whether a section of a record may drift: all but that to which the model's K and Re belong.
    static bool mayDrift(const Record&, const Section&);

    /// @param paths  of the record's channels
    /// @param i, x   current (A) and displacement (m) of the cone in the section, DFT of the window
    SectionDrift(const Model&, const Record&, const Residual&, const Paths& paths, const Spectrum& i,
                 const Spectrum& x);

    /// Adds to the prediction what the drift makes of it.
    /// @param predicted  [channel]
    /// @param r          [channel], its residuals
    Amount follow(std::vector<Spectrum>& predicted, std::vector<Eigen::VectorXd>& r) const;
    /// Takes out of slopes what the drift follows. @param J  [channel]
    void takeOut(std::vector<Eigen::MatrixXd>& J) const;

private:
    const Residual& residual_;
    std::vector<std::vector<Spectrum>> acts_;  ///< [parameter][channel]
    std::vector<Eigen::MatrixXd> a_;           ///< [channel]
    Eigen::MatrixXd inverse_;                  ///< M^-1
};

}  // namespace excursion
