// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Driver/Effects/Effects.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace excursion {
namespace {

/// Semi-inductance Z(s) = K s^a (seed chapter 5), realized in time by a ladder. From
///     s^a = (sin(pi a)/pi) int_0^inf p^(a-1) s/(s + p) dp,     0 < a < 1,
/// the trapezoidal rule in log p gives one resistor in parallel with one inductor per cell,
///     R_k s/(s + p_k),   R_k = K (sin(pi a)/pi) p_k^a ln q,   p_k = p_0 q^k,
/// with an error of about 2 exp(-pi^2/ln q). What the cells leave out below p_low and above p_high is
/// not dropped: each tail's first moments are matched by one more cell with a series resistor (below) and a series
/// inductor (above), so that the element is K (jw)^a from a fraction of the lowest to beyond the highest frequency
/// of interest and still has finite resistance and stiffness in the numerical sense.
/// A cell's memory is the current j_k through its inductor: dj_k/dt = p_k (i - j_k), voltage R_k (i - j_k).
class EddyCurrents final : public EffectOf<EddyCurrents> {
public:
    std::string id() const override { return "eddy-currents"; }
    std::string title() const override { return "Eddy currents (semi-inductance)"; }
    std::string physics() const override
    {
        return "Currents induced in the iron make the coil's impedance rise like a fractional power of frequency, K s^a.";
    }
    std::string symptoms() const override
    {
        return "linear residual voltage well above resonance, with equal slopes of magnitude and a constant phase below 90 degrees";
    }
    std::string remedy() const override
    {
        return "It is no fault; a copper ring lowers it and makes it more linear.";
    }
    bool electrical() const override { return true; }
    bool linear() const override { return true; }

    std::vector<Parameter> parameters(const Extent&) const override
    {
        Parameter K, a;
        K.name = "Ks";
        K.unit = "ohm s^a";
        K.lower = 0.0;
        K.strength = true;
        a.name = "a";
        a.unit = "1";
        a.value = 0.7;
        a.lower = 0.3;
        a.upper = 0.98;
        return {K, a};
    }
    std::vector<std::vector<double>> starts(const Extent&) const override { return {{0.0, 0.5}, {0.0, 0.65}, {0.0, 0.8}}; }

    int memorySize(const Extent& e) const override { return innerCells(e) + 2; }
    int coefficientCount(const Extent& e) const override { return 2 + 2 * memorySize(e); }

    /// Coefficients: series resistance, series inductance, then per cell its rate p_k and resistance R_k.
    template <class T>
    void prepareFor(const Extent& e, const T* parameters, T* c) const
    {
        using std::exp;
        using std::sin;
        const T &K = parameters[0], &a = parameters[1];
        const T factor = K * sin(std::numbers::pi * a) / std::numbers::pi;
        const int inner = innerCells(e);
        const double low = std::log(lowRate(e)), high = std::log(highRate(e)), step = (high - low) / inner;
        const auto power = [](double logarithm, const T& exponent) { return exp(exponent * logarithm); };

        T* cell = c + 2;
        for (int k = 0; k < inner; ++k) {
            const double logRate = low + step * (k + 0.5);
            *cell++ = T(std::exp(logRate));
            *cell++ = factor * power(logRate, a) * step;
        }
        // Tail below: moments int p^(a-1) p^n dp over (0, p_low), n = 0, 1, 2, in powers of 1/s.
        const T below1 = power(low, a + 1.0) / (a + 1.0), below2 = power(low, a + 2.0) / (a + 2.0);
        const T belowRate = below2 / below1, belowR = below1 / belowRate;
        *cell++ = belowRate;
        *cell++ = factor * belowR;
        c[0] = factor * (power(low, a) / a - belowR);
        // Tail above: moments int p^(a-1) p^-n dp over (p_high, inf), n = 1, 2, 3, in powers of s.
        const T above2 = power(high, a - 2.0) / (2.0 - a), above3 = power(high, a - 3.0) / (3.0 - a);
        const T aboveRate = above2 / above3, aboveR = above2 * aboveRate * aboveRate;
        *cell++ = aboveRate;
        *cell++ = factor * aboveR;
        c[1] = factor * (power(high, a - 1.0) / (1.0 - a) - aboveR / aboveRate);
    }

    template <class T>
    void addTo(const Extent& e, const T* c, const Motion<T>& at, const T* memory, T* rate, Balance<T>& sum) const
    {
        sum.inductance += c[1];
        T voltage = c[0] * at.i;
        const T* cell = c + 2;
        for (int k = 0, n = memorySize(e); k < n; ++k, cell += 2) {
            const T through = at.i - memory[k];
            voltage += cell[1] * through;
            rate[k] = cell[0] * through;
        }
        sum.drop += voltage;
    }

private:
    static double lowRate(const Extent& e) { return 2.0 * std::numbers::pi * e.lowFrequency * 0.3; }
    static double highRate(const Extent& e) { return 2.0 * std::numbers::pi * e.highFrequency * 1.6; }
    /// Two cells a decade and a little more: ln q near 1.05 leaves an error below -75 dB.
    static int innerCells(const Extent& e)
    {
        return std::max(3, static_cast<int>(std::ceil(std::log(highRate(e) / lowRate(e)) / 1.05)));
    }
};

} // namespace

const Effect& eddyCurrents()
{
    static const EddyCurrents effect;
    return effect;
}

} // namespace excursion
