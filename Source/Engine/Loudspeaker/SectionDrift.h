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
/// part. Both go on within a section: a change by (kappa', rho') from window to window leaves in the mean of the
/// periods a ramp times what (kappa', rho') would do if it stayed,
///     ramp(n) = (n + 1/2)/N - 1/2,
/// as a driver forgets much sooner than these move. Most of that lies between the lines that were played. With their
/// residuals a = [a_K, a'_K, a_R, a'_R] of all channels together,
///     d = (kappa, kappa', rho, rho') = -M^-1 a^T r,   M = a^T a + diag(1/sigma^2),
///     r <- r + a d,   J <- J - a M^-1 a^T J,
/// so that slopes are those of a model whose drift follows (variable projection, Golub & Pereyra 1973, SIAM J. Numer.
/// Anal. 10; what the moves themselves cost is left out, as it is next to nothing). sigma: 2 % of K and 0.5 % of Re,
/// and a tenth of that from window to window. K and Re of the model are those of the first section of the quietest
/// level that fits see: there nothing is worked yet, and what is not told against one section would be told of none.
class SectionDrift {
public:
    using Spectrum = std::vector<std::complex<double>>;

    struct Amount {
        double stiffness = 0.0, resistance = 0.0;  ///< shares of K and Re
        /// [channel], sum |d Y|^2 over the played lines of what a window differs by from the next one
        std::vector<double> onTheWay {};
    };

    /// @param paths  of the record's channels
    /// @param i, x   current (A) and displacement (m) of the cone in the section, DFT of the window
    SectionDrift(const Model&, const Record&, const Section&, const Residual&, const Paths& paths, const Spectrum& i,
                 const Spectrum& x);

    /// Adds to the prediction what the drift makes of it.
    /// @param predicted  [channel]
    /// @param r          [channel], its residuals
    Amount follow(std::vector<Spectrum>& predicted, std::vector<Eigen::VectorXd>& r) const;
    /// Takes out of slopes what the drift follows. @param J  [channel]
    void takeOut(std::vector<Eigen::MatrixXd>& J) const;

private:
    /// What moves, and what it does.
    struct Motion {
        double Amount::*amount;
        double sigma;               ///< expected
        std::vector<Spectrum> act;  ///< [channel]
        bool onTheWay;              ///< within the window
    };

    const Section& section_;
    const Residual& residual_;
    std::vector<Motion> motions_;
    std::vector<Eigen::MatrixXd> a_;  ///< [channel]
    Eigen::MatrixXd inverse_;         ///< M^-1
};

}  // namespace excursion
