// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Effect.h"
#include "Engine/Loudspeaker/Model.h"

#include <complex>
#include <string>
#include <vector>

namespace excursion {

/// The lossy inductance of a coil in a form that other programs take, fitted to Z_blocked - Re.
struct LossyForm {
    std::string id;                  ///< "lr2", "lr3", "semi-inductance", "wright", "thorborg-futtrup"
    std::string formula;             ///< in plain ASCII
    std::vector<Figure> parameters;  ///< SI; a K's unit is that of K w^n in ohm
    double errorPercent = 0.0;       ///< rms of |Z_form - Z|/|Z| of the whole blocked impedance, Re with it, over log f
    double worstDb = 0.0;            ///< largest | 20 log10 |Z_form/Z| |
};

struct LossyInductance {
    double low = 0.0, high = 0.0;  ///< Hz, the band of the fit
    double Re = 0.0;               ///< ohm, in every form
    bool lossless = false;         ///< the model's inductance is Le alone: there is nothing to fit
    double Le = 0.0;               ///< H, of a lossless one
    std::vector<LossyForm> forms;  ///< in the order of the list above
};

/// Fits to the model's blocked-coil impedance on 24 points an octave, all parameters positive,
///     lr2:               j w Le + j w L2 || R2
///     lr3:               j w Le + j w L2 || R2 + j w L3 || R3
///     semi-inductance:   K w^n exp(j n pi/2)                 (Leach, J. Audio Eng. Soc. 50, 2002)
///     wright:            Kr w^Er + j Kx w^Ex                 (Wright, J. Audio Eng. Soc. 38, 1990)
///     thorborg-futtrup:  j w Leb + j w Le || Ke (j w)^1/2 || Rss   (Thorborg and Futtrup, J. Audio Eng. Soc. 59, 2011)
/// by least squares of the relative error of the whole impedance.
/// @param low, high  Hz, at least an octave; 0: what the model was measured over, from three times its resonance, or 10
/// kHz where it does not say
/// @throws Error (data) for a model without a coil, (usage) for a band that is none
LossyInductance lossyInductance(const Model&, double low = 0.0, double high = 0.0);

/// Z of a form at w in rad/s, without Re.
std::complex<double> impedanceOf(const LossyForm&, double omega);

/// The lowest and highest frequency that the model's effects were fitted over, Hz; {10, 10000} of a base alone, whose
/// file does not say.
std::pair<double, double> bandOf(const Model&);

}  // namespace excursion
