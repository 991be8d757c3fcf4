// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Polynomial/Pnlss/Pnlss.h"

#include <string>

namespace excursion {

/// A polynomial NARX model of one input and one output ([B 3.2], without its noise model; Billings 2013), in discrete
/// time:
///     y(t) = sum_k c_k m_k(y(t-1) .. y(t-na), u(t-1) .. u(t-nb), u(t))
/// with monomials m_k of any degree, 0 (a constant) and 1 among them. Its past outputs are its own: a simulation, not a
/// prediction.
struct Narx {
    double sampleRate = 0.0;       ///< Hz
    int outputLags = 0;            ///< na
    int inputLags = 0;             ///< nb
    Exponents exponents;           ///< K x (na + nb + 1), columns in the order above
    Eigen::VectorXd coefficients;  ///< K: c

    Eigen::Index parameters() const { return coefficients.size(); }

    /// @param reason  where not null: one sentence that says what is wrong
    bool isValid(std::string* reason = nullptr) const;
};

/// The same model as PNLSS: its states are the lags, x(t) = (y(t-1) .. y(t-na), u(t-1) .. u(t-nb)), and the first row
/// of E and the one of F are alike.
Pnlss pnlssOf(const Narx&);

/// Whether it is stable around rest: by the terms of degree 1. Far from rest only a simulation can tell.
bool isStable(const Narx&);

}  // namespace excursion
