// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Polynomial/Pnlss/Pnlss.h"
#include "Engine/Polynomial/InputOutputRecord.h"

#include <optional>

namespace excursion {

/// Whether what a model leaves of a record is noise, or follows from the input: noise is what nothing made of the input
/// can tell.
///
/// The residual e is whitened by an autoregressive filter A of its own (Burg 1975), A e regressed on the states, the
/// input and their monomials at a few lags, and both parts of it, told and untold, are taken back through 1/A. So the
/// colour of the noise does not matter, and a residual of slow motion counts with all of its power. What chance tells,
/// the share of regressors in the samples, is taken off. What a wider model near this one would explain is told as well
/// (see TangentTest.h). The untold part is an estimate of the noise, from above. The test sees what such regressors
/// see: a residual that follows from the input by dynamics that the model has not, or by a bend that no polynomial of
/// two degrees more shows, may pass for noise.
struct UntoldNoise {
    double db = 0.0;  ///< power of what is not told, dB of the output [B 4.26]: the noise is no more than that
    /// the same where the tangent takes of noise what it takes of white noise. Slow noise and slow motion that the
    /// model lacks may lie between both, and cannot be told apart.
    double leastDb = 0.0;

    /// Whether an error is at the noise; empty where that cannot be told.
    std::optional<bool> reachedBy(double errorDb) const;
};

/// @param initial  first states of the records, where there are any
/// Empty where the model runs away or the record has too few samples.
std::optional<UntoldNoise> untoldNoise(const Pnlss&, const std::vector<InputOutputRecord>&,
                                       const std::vector<Eigen::VectorXd>& initial);

/// An error is at the noise when it is no more than this above it; less where the residual itself told the noise.
constexpr double atNoiseDb = 3.0, atUntoldDb = 2.0;

/// By how much the error of a sample that no fit saw is above that of one that was fitted, dB, from the relative errors
/// of both [B 4.26].
double heldOutDb(double estimationDb, const std::vector<InputOutputRecord>& estimation, double validationDb,
                 const std::vector<InputOutputRecord>& validation);

/// More than this above it, an error at the noise says that the fit explains these samples, not the system.
constexpr double heldOutMostDb = 6.0;

/// No recorded signal resolves an error below this, nor need a fit go further.
constexpr double exactDb = -120.0;

/// Whether what was held out is explained as well as what was fitted, or exactly.
bool isHeld(double estimationDb, const std::vector<InputOutputRecord>& estimation, double validationDb,
            const std::vector<InputOutputRecord>& validation);

}  // namespace excursion
