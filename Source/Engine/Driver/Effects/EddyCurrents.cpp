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
/// with an error of about 2 exp(-pi^2/ln q) for the sum over all k. What it has below p_low and above p_high is
/// not dropped: the moments of these tails are geometric series, and the first three of each are matched by one more cell with a
/// series resistor (below) and a series inductor (above). So the element is K (jw)^a within 3.5e-4 from the lowest to the
/// highest frequency of interest and still has finite resistance and stiffness in the numerical sense.
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
        const int inner = innerCells(e);
        const double low = std::log(lowRate(e)), high = std::log(highRate(e)), step = (high - low) / inner;   // step: ln q
        const T factor = K * sin(std::numbers::pi * a) * (step / std::numbers::pi);
        const auto power = [](double logarithm, const T& exponent) { return exp(exponent * logarithm); };

        T* cell = c + 2;
        for (int k = 0; k < inner; ++k) {
            const double logRate = low + step * (k + 0.5);
            *cell++ = T(std::exp(logRate));
            *cell++ = factor * power(logRate, a);
        }
        // Tail below, s/(s + p) = 1 - p/s + p^2/s^2 - ...: the moments sum p_k^(a + n), k < 0, n = 0, 1, 2.
        const auto below = [&](double n) { return power(low - 0.5 * step, a + n) / (1.0 - exp(-(a + n) * step)); };
        const T belowRate = below(2) / below(1), belowR = below(1) / belowRate;
        *cell++ = belowRate;
        *cell++ = factor * belowR;
        c[0] = factor * (below(0) - belowR);
        // Tail above, s/(s + p) = s/p - s^2/p^2 + ...: the moments sum p_k^(a - n), k >= inner, n = 1, 2, 3.
        const auto above = [&](double n) { return power(high + 0.5 * step, a - n) / (1.0 - exp((a - n) * step)); };
        const T aboveRate = above(2) / above(3), aboveR = above(2) * aboveRate * aboveRate;
        *cell++ = aboveRate;
        *cell++ = factor * aboveR;
        c[1] = factor * (above(1) - aboveR / aboveRate);
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
    static double lowRate(const Extent& e) { return 2.0 * std::numbers::pi * e.lowFrequency * 0.15; }
    static double highRate(const Extent& e) { return 2.0 * std::numbers::pi * e.highFrequency * 2.5; }
    /// ln q of 1 and the margins of the two rates each leave an error below 3.5e-4; wider margins would make the fastest cell stiff.
    static int innerCells(const Extent& e)
    {
        return std::max(3, static_cast<int>(std::ceil(std::log(highRate(e) / lowRate(e)))));
    }
};

} // namespace

const Effect& eddyCurrents()
{
    static const EddyCurrents effect;
    return effect;
}

} // namespace excursion
