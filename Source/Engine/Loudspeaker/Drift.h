// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Fit.h"
#include "Engine/Loudspeaker/FitResponse.h"

#include <optional>
#include <string>
#include <vector>

namespace excursion {

/// A number of a driver then and now, each with its standard error (NaN: unknown).
struct Drifted {
    std::string name, unit;
    double before = 0.0, beforeError = 0.0, after = 0.0, afterError = 0.0;
    /// (after - before)/before
    double share() const { return after / before - 1.0; }
    /// |after - before| in standard errors of the difference; NaN where these are unknown
    double certainty() const;
};

/// What has become of a driver since its model was fitted. A few parameters change with temperature and age, and those
/// alone are fitted to a new take, which may be short; all others are held at what the model says:
///     min over p of  sum |Y_model(p, held) - Y_measured|^2 / sigma^2,   p of `drifting`.
/// A law that adds to one of these, such as K(x) = K + sum c_i p_i(x), keeps its shape and goes with it, c_i' = c_i
/// p'/p: a suspension that has become softer is softer everywhere. Errors of what was fitted anew are on condition that
/// what was held is right.
struct Drift {
    Model model;
    std::vector<Drifted> parameters;    ///< those that were fitted
    std::vector<Drifted> figures;       ///< f0 in Hz and the total Q that follow
    std::optional<double> warmer;       ///< K: of a copper coil whose Re has changed so much, (Re'/Re - 1)/0.0039
    std::optional<double> warmerError;  ///< K, standard error of that; nothing where Re's were unknown
    FitSummary search;
};

/// Re, Rms and K, those of them that the base has.
std::vector<std::string> driftingParameters(const Model&);

/// @param drifting  names of parameters of the base
/// Throws Error (usage) for a name that is none, (numerical) where the search fails; (cancelled).
Drift followDrift(const Model&, const Record&, const std::vector<std::string>& drifting, const FitOptions& = {},
                  const Progress& = {});
/// The same by responses, such as an impedance.
Drift followDrift(const Model&, const std::vector<ResponseTarget>&, const std::vector<std::string>& drifting);

}  // namespace excursion
