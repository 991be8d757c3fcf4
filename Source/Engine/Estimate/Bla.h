// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Estimate/Frf.h"
#include "Engine/Take/Measurement.h"

#include <optional>
#include <vector>

namespace excursion {

/// The best linear approximation (BLA) of one channel from M realizations of P steady periods, on the excited
/// lines [B 4.2.2, appendix A] (Pintelon & Schoukens 2012, 4.3):
///     G_m = Ybar_m / Ubar_m,           averages over the P periods of realization m
///     G   = 1/M sum_m G_m              frf.value
/// Measured input: U is what the input channel holds, not what was sent to the amplifier, so each G_m is
/// referred to the measured phase of that realization. [B 4.2.2] assumes that U has no noise. Here U may
/// have noise: Ybar/Ubar is the errors-in-variables estimate, consistent for P -> infinity as long as the
/// excited lines of U stand 10 dB above its noise; its variance counts the noise of both channels and
/// their correlation to first order, from the scatter of the equation error over the periods,
///     varNoise(G_m) = 1/(P (P-1)) sum_p |Y_mp - G_m U_mp|^2 / |Ubar_m|^2,
/// which is VarN of [B appendix A] when U repeats exactly.
struct BlaResult {
    Quantity output = Quantity::current, input = Quantity::voltage;
    int level = 0;
    int realizations = 0, periods = 0;

    /// noiseVariance and totalVariance are variances of the mean G, thus 1/M of a single G_m's:
    ///     noiseVariance = 1/M^2 sum_m varNoise(G_m)                 empty when P = 1
    ///     totalVariance = 1/(M (M-1)) sum_m |G_m - G|^2             empty when M = 1 (Varbla)
    Frf frf;

    /// max(totalVariance - noiseVariance, 0), the part of the mean's variance that is due to
    /// nonlinearity. Empty unless P > 1 and M > 1.
    std::vector<double> nonlinearVariance;

    /// M * nonlinearVariance: the stochastic nonlinear distortion in one realization, E|G_S|^2.
    std::vector<double> stochasticNonlinear;

    /// gamma^2 = |sum Y conj(U)|^2 / (sum |Y|^2 sum |U|^2), sums over all periods of all realizations:
    /// 1 - gamma^2 is the share of the output's power, noise and distortion, not coherent with the input.
    /// Empty when M P = 1.
    std::vector<double> coherence;
};

/// @param output  the channel to explain
/// @param level   index into Excitation::levels
/// @param input   the channel it is explained by; by default Measurement::input()
/// @throws Error (data) when a channel, the periods or the lines are missing, or a line of the input is empty
BlaResult bla(const Measurement&, Quantity output, int level, std::optional<Quantity> input = std::nullopt);

}  // namespace excursion
