// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/BlackBox/Stimulus.h"
#include "Engine/Polynomial/Block/BlockModel.h"
#include "Engine/Polynomial/FractionalPnlss/FractionalPnlss.h"
#include "Engine/Polynomial/Hammerstein/ParallelHammerstein.h"
#include "Engine/Polynomial/Narx/Narx.h"

#include <string>

namespace excursion {

/// A model without physics, of one input and one output, in the one form in which all classes of them are played and
/// inverted (discrete time):
///     z = S x + T u + G q,   q = R p(z, u),   x(t+1) = A x + B u + E q,   y = C x + D u + F q
/// with K monomials p in what the nonlinearity sees, z and the input, and as few combinations q of them as E and F ask
/// for. G is zero except of fractional orders, whose steps are implicit.
struct BlackBox {
    std::string name;           ///< of the model
    std::string kind;           ///< what it is, "polynomial state space"
    std::string input, output;  ///< quantities, "voltage"
    StateSpace linear;          ///< A, B, C, D and the sample rate
    Eigen::MatrixXd S, T;       ///< seen x n, seen x 1
    Exponents exponents;        ///< K x (seen + 1)
    Eigen::MatrixXd R;          ///< r x K
    Eigen::MatrixXd E, F, G;    ///< n x r, 1 x r, seen x r
    Stimulus stimulus;          ///< what it was fitted under

    Eigen::Index seen() const { return S.rows(); }
    Eigen::Index combinations() const { return R.rows(); }

    /// Shapes fit, all is finite and the linear part is stable. @param reason  where not null: one sentence
    bool isValid(std::string* reason = nullptr) const;
};

/// The same models in this form; name, quantities and stimulus are left empty. Throws Error (data) for a model with
/// several inputs or outputs.
BlackBox blackBoxOf(const Pnlss&);
BlackBox blackBoxOf(const FractionalPnlss&, const FractionalGrid&);
BlackBox blackBoxOf(const BlockModel&);
BlackBox blackBoxOf(const Narx&);

/// The filters of all branches together become one state space whose inputs are the powers, by Kung's method (the
/// truncated singular value decomposition of the Hankel matrix of their taps, of which every `stride`-th shift is a
/// state's readout), with an error of at most -60 dB of the taps' energy, weighted with the powers of the stimulus.
/// Throws Error (data) where 60 states do not reach that.
BlackBox blackBoxOf(const ParallelHammerstein&, const Stimulus&);

}  // namespace excursion
