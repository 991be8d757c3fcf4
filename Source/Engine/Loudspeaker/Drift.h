// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Fit.h"
#include "Engine/Loudspeaker/FitResponse.h"

#include <optional>
#include <string>
#include <vector>

namespace excursion {

/// A number of a driver before and after, each with its standard error (NaN: unknown).
struct Drifted {
    std::string name, unit;
    double before = 0.0, beforeError = 0.0, after = 0.0, afterError = 0.0;
    /// (after - before)/before
    double share() const { return after / before - 1.0; }
    /// |after - before| in standard errors of the difference; NaN if these are unknown
    double certainty() const;
};

/// The drift of a driver since its model was fitted. A few parameters change with temperature and age. Only those are
/// fitted to a new take, which may be short. All others are held at the model's values:
///     min over p of  sum |Y_model(p, held) - Y_measured|^2 / sigma^2,   p of `drifting`.
/// A law that adds to one of these, such as K(x) = K + sum c_i p_i(x), keeps its shape and scales with it, c_i' = c_i
/// p'/p: a suspension that has become softer is softer everywhere. The errors of the fitted parameters assume that the
/// held parameters are right.
struct Drift {
    Model model;
    std::vector<Drifted> parameters;  ///< the fitted parameters
    std::vector<Drifted> figures;     ///< the resulting f0 in Hz and total Q
    std::optional<double> warmer;  ///< K: temperature rise of a copper coil with this change of Re, (Re'/Re - 1)/0.0039
    std::optional<double> warmerError;  ///< K, its standard error; nothing if those of Re were unknown
    FitSummary search;
};

/// Those of Re, Rms and K that the base has.
std::vector<std::string> driftingParameters(const Model&);

/// @param drifting  names of parameters of the base
/// Throws Error (usage) for an unknown name, (numerical) if the search fails; (cancelled).
Drift followDrift(const Model&, const Record&, const std::vector<std::string>& drifting, const FitOptions& = {},
                  const Progress& = {});
/// The same from responses, such as an impedance.
Drift followDrift(const Model&, const std::vector<ResponseTarget>&, const std::vector<std::string>& drifting);

}  // namespace excursion
