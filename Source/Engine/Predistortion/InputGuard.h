// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Predistortion/Oversampling.h"

#include <array>
#include <cmath>
#include <cstddef>

namespace excursion {

/// Keeps samples that no amplifier can deliver, or that are not finite, out of the filters. Such a sample is played as
/// silence, and its place is remembered.
struct InputGuard {
    double loudest;  ///< V (or N), see Plausible::input

    std::array<bool, Oversampling::longestBlock> faultAt {};  ///< one flag per sample of the latest block

    /// @param n  <= Oversampling::longestBlock samples
    void pass(const double* in, std::size_t n, double* out)
    {
        for (std::size_t k = 0; k < n; ++k) {
            faultAt[k] = !(std::abs(in[k]) < loudest);  // also for NaN
            out[k] = faultAt[k] ? 0.0 : in[k];
        }
    }
};

}  // namespace excursion
