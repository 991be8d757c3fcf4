// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>
#include <string>
#include <vector>

namespace excursion {

struct ExponentialSweepOptions {
    double sampleRate = 48000.0;  ///< Hz
    double bandLow = 20.0;        ///< f1, Hz, where it begins
    double bandHigh = 8000.0;     ///< f2, Hz, where it ends; below half the sample rate
    /// wished; synchronization moves it by half a period of f1 times ln(f2/f1) at most
    double seconds = 10.0;
    double peak = 1.0;  ///< a, V
    /// s, raised cosines; what is excited while they last has less than the peak
    double fadeIn = 0.0, fadeOut = 0.0;

    /// @param reason  where not null: one sentence that says what is wrong
    bool isValid(std::string* reason = nullptr) const;
};

/// A synchronized exponential sweep (Novak, Lotton & Simon 2015; [B 3.3] has Farina's, which is not synchronized)
///     x(t) = a sin(2 pi f1 L exp(t/L)),  0 <= t < T = L ln(f2/f1),  instantaneous frequency f1 exp(t/L),
/// with f1 L whole. Then the m-th harmonic is the sweep itself, earlier by L ln m, whatever m: sin(m phi(t)) = x(t + L
/// ln m) / a, so harmonics are told apart in time and keep their phases.
class ExponentialSweep {
public:
    /// Throws Error (usage) when the options are not valid.
    explicit ExponentialSweep(const ExponentialSweepOptions&);

    const ExponentialSweepOptions& options() const { return options_; }
    double rate() const { return L_; }    ///< L, s
    double seconds() const;               ///< T, s
    double advance(int harmonic) const;   ///< L ln m, s
    std::vector<double> samples() const;  ///< V, ceil(T fs) of them, faded

    /// The Fourier transform at f > 0 in V s, of the sweep without its ends: t from -infinity to infinity.
    ///     X(f) = a/2 sqrt(L/f) exp(j (nu (1 - ln(f/f1)) + 1/(12 nu) + 1/(360 nu^3) - pi/4)),  nu = 2 pi f L
    /// The first term is the stationary phase of Novak et al. (their eq. 42); the next two are those of Stirling's
    /// series, as the transform is (a L / 2j) Gamma(-j nu) (2 pi f1 L)^(j nu) exp(nu pi/2) but for a tail of the size
    /// of exp(-pi nu). The ends, even if faded, ripple near f1 and f2.
    std::complex<double> spectrum(double frequency) const;

private:
    ExponentialSweepOptions options_;
    double L_;
};

}  // namespace excursion
