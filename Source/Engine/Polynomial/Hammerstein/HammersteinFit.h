// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Polynomial/Hammerstein/ParallelHammerstein.h"
#include "Engine/Polynomial/Pnlss/PnlssFit.h"

#include <string>
#include <vector>

namespace excursion {

struct HammersteinFitOptions {
    int degree = 3;               ///< N, 1 .. 20
    Eigen::Index length = 512;    ///< K, taps of a branch, at most; N K is at most 262144, see fitHammerstein()
    double regularization = 0.0;  ///< r; 0: chosen on the validation records, of 1e-10 .. 1e-2; without them 1e-8

    bool isValid(std::string* reason = nullptr) const;
};

/// What became of a fit: solved at once, or how the iteration ended, whose cost is the sum that fitHammerstein()
/// lowers.
struct HammersteinFit : SearchSummary {
    ParallelHammerstein model;
    double regularization = 0.0;  ///< r that was taken
    /// relative rms error [B 4.26]; validation NaN without records
    double estimationDb = 0.0, validationDb = 0.0;
};

/// A parallel Hammerstein model of any record, a multisine or music: all that is unknown is linear in the output, so
/// regularized least squares
///     sum_t (y(t) - y0 - sum_n sum_k c_n(k) P_n(u(t-k)))^2 + r T sum c^2 -> min,   T judged samples,
/// in polynomials P_1 .. P_N without constant that are orthonormal on the estimation records' input: powers of u are
/// nearly the same signal twice. P_n(u) of the samples before a record are 0, as a simulation from rest has it.
///
/// Up to N K = 4096 the normal equations are made in O(T K N^2) and solved by Cholesky's factors in O((N K)^3 / 3) for
/// each r. Taps ascend in the order of the unknowns, so that one factor serves all lengths: of K, K / sqrt 2, K / 2, ..
/// and of all r the one with the least error on the validation records is returned. Longer branches, as a resonance of
/// long memory at a high sample rate needs, are found by conjugate gradients at the full length K in O(N T log T) an
/// iteration (LongHammerstein), and the iteration with the least error on the validation records is returned: to stop
/// early regularizes as well. Throws Error (usage, data) for options or records that make no sense, (numerical) when
/// the equations have no solution in finite numbers.
HammersteinFit fitHammerstein(double sampleRate, const std::vector<InputOutputRecord>& estimation,
                              const std::vector<InputOutputRecord>& validation, const HammersteinFitOptions& = {},
                              const Progress& = {});

}  // namespace excursion
