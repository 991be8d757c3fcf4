// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Linear/Decomposition.h"
#include "Engine/Linear/DelayedFit.h"
#include "Engine/Linear/PartialFractionFit.h"
#include "Engine/Linear/StateSpace.h"

#include <optional>
#include <string>
#include <vector>

namespace excursion {

/// Stable models in place of unstable ones [B 6.2]. A loudspeaker is stable, but noise and nonlinearity can put
/// poles of an unconstrained fit outside (6.2.1).

/// The model times an all-pass that moves each unstable pole to its mirror image 1/conj(p) or -conj(p) [B 6.24
/// to 6.28]. Zeros stay where they are, and so do the magnitudes of all responses: of a model with no more inputs than
/// outputs G M with M M^H = I on the frequency axis, which keeps every magnitude where there is one input; else M G,
/// which does so where there is one output.
///
/// No poles, zeros and gains, as in [B appendix D], whose polynomials lose all digits at high order, but a state
/// feedback on the unstable part (A, B): with A Y + Y A^T = B B^T, or A Y A^T - Y = B B^T, and X = Y^-1
///     continuous  F = -B^T X                          M = (A + B F, B, F, I)
///     discrete    F = -(I + B^T X B)^-1 B^T X A       M = (A + B F, B W, F, W),  W = (I + B^T X B)^-1/2
/// Of one pole W is 1/|p|, which undoes the gain that [B 6.27] tells. Poles on the border have no image: they are
/// pushed out by 1e-9 first and land as far inside. Throws as decomposed() does.
StateSpace mirroredByAllPass(const StateSpace&);

/// The same in lambda = s^alpha, of models with one input and output: unstable poles are reflected at the border of the
/// sector, |arg| = theta = alpha pi/2 [B 6.2.6], as mirrored(SecondOrderSections) does; zeros and gain stay. There is
/// no all-pass any more: for p = rho e^(j phi), phi in [0, theta], the reflection p' is as far from the upper ray as p
/// was, but its conjugate is not. That changes the magnitude at lambda = r e^(j theta) by
///     |lambda - conj(p)| / |lambda - conj(p')|
///         = ((r^2 + rho^2 - 2 r rho cos(theta + phi)) / (r^2 + rho^2 - 2 r rho cos(3 theta - phi)))^1/2,
/// the most at r = rho, and by nothing for alpha = 1. A pole on the positive axis goes to the negative one, where its
/// magnitude changes by tan(theta/2) at most. Throws as poleZeroGainOf() does.
StateSpace mirroredAtSector(const StateSpace&, double alpha);

/// The causal and stable part of z^-d G: of all stable models with that delay the nearest to the response of z^-d G in
/// the mean square over the whole axis. With d = 0 it is the stable part alone [B 6.32]; with d samples of delay
/// the response that the unstable part has ahead of time,
///     C (zI - A)^-1 B = -sum_{k>=0} z^k C A^-(k+1) B,
/// comes in as d + 1 taps, and what is left out falls as |p|^-d ([B 6.2.2 and 6.2.4] name the method, and give no
/// equation). [B 5.1.3] calls the stable part as such optimal; in discrete time that takes the tap at k = 0, -C A^-1 B,
/// which belongs into D.
/// @param delay  samples; has to be 0 in continuous time, where no finite order shifts a response
StateSpace stableProjection(const StateSpace&, Eigen::Index delay = 0);

enum class StabilizingMethod {
    mirror,   ///< mirroredByAllPass() or mirroredAtSector(), then a fit
    project,  ///< stableProjection(), then a fit
    delay,    ///< a fit of a stable model and a delay
    /// the stable part of decomposed() and nothing else, so that with the unstable one it adds up to the model
    decompose
};

struct StabilizeOptions {
    StabilizingMethod method = StabilizingMethod::mirror;
    bool refit = true;                 ///< after mirror and project; the delay is a fit in itself
    PoleRefinementOptions refinement;  ///< of the refit; always stable
    /// the delay to add; else the one that fits best is looked for, see DelayedFit.h
    std::optional<double> seconds;
    double alpha = 1.0;  ///< order of differentiation: the model is one in lambda = s^alpha

    bool isValid(std::string* reason = nullptr) const;
};

/// Where the model stands after each step.
struct StabilizationStep {
    std::string what;  ///< "as it came", "mirrored", "projected", "delayed", "stable part", "refitted"
    Eigen::Index order = 0;
    bool stable = false;
    double errorDb = 0.0;          ///< unweighted relative rms error to the response [B 4.26]
    double weightedErrorDb = 0.0;  ///< 10 log10 of PartialFractionFit::cost
};

struct Stabilization {
    StateSpace model;
    double delay = 0.0;                             ///< s: the model has the response times exp(-j w delay)
    std::optional<double> delayStandardError;       ///< standard error, where the delay was looked for
    std::optional<Decomposition> parts;             ///< where the model was decomposed
    std::vector<StabilizationStep> steps;           ///< in the order in which they were taken
    std::string reason = "nothing was stabilized";  ///< how it ended
};

/// Stabilizes and fits again, poles kept stable: with one input poles and all else by refinePoles(), with several B and
/// D by linear least squares. A model that is stable already is left alone.
/// @param data  what the model stands for: measured, or sampled(model)
/// Throws Error (usage) for options that make no sense or data that is not of the model's inputs and outputs, and as
/// decomposed() does.
Stabilization stabilized(const StateSpace&, const FrequencyData& data, const StabilizeOptions& = {},
                         const Progress& = {});

}  // namespace excursion
