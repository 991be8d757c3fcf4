// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/BlackBox/Stimulus.h"
#include "Engine/Polynomial/Block/BlockModel.h"
#include "Engine/Polynomial/FractionalPnlss/FractionalPnlss.h"
#include "Engine/Polynomial/Hammerstein/ParallelHammerstein.h"
#include "Engine/Polynomial/Narx/Narx.h"

#include <string>

namespace excursion {

/// A model without physics, with one input and one output, in discrete time. All classes are played and inverted in
/// this form:
///     z = S x + T u + G q,   q = R p(z, u),   x(t+1) = A x + B u + E q,   y = C x + D u + F q
/// with K monomials p in the quantities that the nonlinearity sees, z and the input, and as few combinations q of them
/// as E and F need. G is zero except for fractional orders, whose steps are implicit.
struct BlackBox {
    std::string name;           ///< name of the model
    std::string kind;           ///< its class, "polynomial state space"
    std::string input, output;  ///< quantities, "voltage"
    StateSpace linear;          ///< A, B, C, D and the sample rate
    Eigen::MatrixXd S, T;       ///< seen x n, seen x 1
    Exponents exponents;        ///< K x (seen + 1)
    Eigen::MatrixXd R;          ///< r x K
    Eigen::MatrixXd E, F, G;    ///< n x r, 1 x r, seen x r
    Stimulus stimulus;          ///< the input of its fit

    Eigen::Index seen() const { return S.rows(); }
    Eigen::Index combinations() const { return R.rows(); }

    /// True if the shapes match, all numbers are finite and the linear part is stable. @param reason if not null: one
    /// sentence
    bool isValid(std::string* reason = nullptr) const;
};

/// Converts a model to this form. Name, quantities and stimulus are left empty. Throws Error (data) for a model with
/// several inputs or outputs.
BlackBox blackBoxOf(const Pnlss&);
BlackBox blackBoxOf(const FractionalPnlss&, const FractionalGrid&);
BlackBox blackBoxOf(const BlockModel&);
BlackBox blackBoxOf(const Narx&);

/// The filters of all branches become one state space whose inputs are the powers. The method is Kung's: the truncated
/// singular value decomposition of the Hankel matrix of the taps, of which every `stride`-th shift is a state's
/// readout. The error is at most -60 dB of the taps' energy, weighted with the powers of the stimulus. Throws Error
/// (data) if 60 states do not reach that.
BlackBox blackBoxOf(const ParallelHammerstein&, const Stimulus&);

}  // namespace excursion
