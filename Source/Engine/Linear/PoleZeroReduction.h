// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Linear/PoleZero.h"

#include <string>
#include <vector>

namespace excursion {

/// Smaller models by editing poles and zeros, each edit with a bound of what it does to the response [B 6.1.2,
/// 6.1.3].
///
/// Remote poles and zeros. |e^jw - r| of a root r lies between least = |1 - |r|| and most = 1 + |r| on the circle, so
/// leaving it out changes the gain by no more than a ripple, peak to peak, of
///     20 log10(most / least)                                        [B eq. 6.2]
/// Here least and most are taken over the band alone, which [B eq. 6.2] has for the whole circle, and gives continuous
/// time a meaning, where no root is remote from all of the axis. What is left out is the factor 1 - r/z (|r| < 1) or 1
/// - z/r, so the gain stays; z itself is a sample of delay, which the result tells and [B 6.1.2] calls a phase that is
/// to be verified case by case.
///
/// Pairs of a pole p and a zero q that nearly cancel: their factor is 1 + eps(w),
///     |eps| <= eps_sup = |p - q| / least(p)                         [B 6.7]
///     ripple <= 20 log10((1 + eps_sup) / (1 - eps_sup))             [B 6.9]
/// The angle is bounded by asin(eps_sup); [B 6.10] prints the arc tangent, which is a little less than what
/// can happen.
///
/// Conjugates go together, their ripples added. The relative change of the complex response, delay apart, is bounded,
/// too: remote roots by rho = min(|r|, 1/|r|), or w_max^alpha/|r| in continuous time,
///     |G_reduced / G - 1| <= prod(1 + rho_pole) / (prod(1 - rho_zero) prod(1 - eps_sup)) - 1
/// Both bounds include what the roots as they were found miss of the response before any goes: rounding, which is not
/// small where poles lie close together or the band far below the response's peak. Another 1e-6 may be rounding in the
/// model that is realized.
struct PoleZeroReductionOptions {
    double rippleDb = 1.0;             ///< bound of all steps together, peak to peak
    int order = 0;                     ///< go no lower than this
    bool remote = true, pairs = true;  ///< which kinds to use
    /// Hz, the band that counts; both 0: up to half the sample rate. Continuous time needs one
    double low = 0.0, high = 0.0;
    /// order of differentiation: the model is one in lambda = s^alpha, seen on (j w)^alpha [B 6.2.6]
    double alpha = 1.0;

    bool isValid(std::string* reason = nullptr) const;
};

struct PoleZeroReductionStep {
    std::vector<std::complex<double>> poles, zeros;  ///< taken out; lambda, see PoleZero.h
    bool cancelled = false;                          ///< a pair, not remote ones
    Eigen::Index order = 0;                          ///< afterwards
    double boundDb = 0.0;                            ///< ripple of this and all steps before it, peak to peak
    /// what it is in fact, between this model and the first one, on many frequencies of the band
    double rippleDb = 0.0;
    /// of the relative change of the complex response; infinite where a rho is 1 or more
    double errorBound = 0.0;
    double error = 0.0;  ///< what it is in fact, at most, the delay taken into account
};

struct PoleZeroReduction {
    StateSpace model;
    /// s: the model has the response times exp(-j w delay); below 0 when it comes earlier than the original
    double delay = 0.0;
    std::vector<PoleZeroReductionStep> steps;
    std::string reason = "nothing was taken out";
};

/// Takes out what ripples least for each pole that it saves, and goes on while the bounds together stay within
/// rippleDb. A zero goes alone only where a pole could not go otherwise: without it there would be more zeros than
/// poles. Throws Error (usage) for options that make no sense, (numerical) when the roots miss a tenth of the response
/// in the band, and as poleZeroGainOf() does.
PoleZeroReduction reduceByPolesAndZeros(const StateSpace&, const PoleZeroReductionOptions&);

}  // namespace excursion
