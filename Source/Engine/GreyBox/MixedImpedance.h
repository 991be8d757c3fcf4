// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Linear/FrequencyData.h"
#include "Engine/Numerics/SearchSummary.h"

#include <array>
#include <complex>
#include <optional>
#include <string>

namespace excursion {

/// The electrical impedance of an electrodynamic driver with a semi-inductance [B 5.37], fractional and integer
/// orders side by side as [B 5.5] asks for:
///     Z(s) = R + L s^alpha + K s/(s^2 + (w0/Q) s + w0^2),     K = Bl^2/m,  w0 = sqrt(k/m),  w0/Q = r/m
/// [B 5.2] prints L in henry for any alpha; its unit is ohm s^alpha.
struct MixedImpedance {
    double resistance = 0.0;      ///< R, ohm
    double semiInductance = 0.0;  ///< L, ohm s^alpha
    double alpha = 0.5;
    double motional = 0.0;   ///< K, ohm/s
    double resonance = 0.0;  ///< w0/(2 pi), Hz
    double quality = 0.0;    ///< Q of the mechanics alone

    static constexpr int parameters = 6;

    std::complex<double> at(double frequency) const;

    /// In the order of the members.
    std::array<double, parameters> values() const
    {
        return {resistance, semiInductance, alpha, motional, resonance, quality};
    }
};

struct MixedImpedanceOptions {
    std::optional<double> alpha;  ///< empty: free
    int maximumIterations = 100;

    bool isValid(std::string* reason = nullptr) const;
};

/// Maximum likelihood for Gaussian noise: search() on sum |e|^2/sigma^2 over the logarithms of all
/// parameters, all of which are above 0, with an analytic Jacobian, from the best of a grid in alpha, w0 and Q with R,
/// L and K by linear least squares. Standard errors are the square roots of the diagonal of Fisher's inverse; where the
/// model leaves more than the noise, or no standard deviations are known, the noise is what is left over.
struct MixedImpedanceFit : SearchSummary {
    MixedImpedance model;
    MixedImpedance standardErrors;  ///< of each parameter; of a given alpha 0
    double errorDb = 0.0;           ///< unweighted relative rms error [B 4.26]
    /// sum |e|^2/sigma^2, about 1 a line when all but noise is explained; NaN without deviations
    double chiSquared = 0.0;
};

/// Throws Error (usage) for options, (data) for data that is not one output by one input or has fewer than 6 lines
/// above 0 Hz, (numerical) when no impedance of this kind resembles it.
MixedImpedanceFit fitMixedImpedance(const FrequencyData&, const MixedImpedanceOptions& = {});

}  // namespace excursion
