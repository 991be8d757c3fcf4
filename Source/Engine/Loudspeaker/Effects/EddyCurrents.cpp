// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/Effects/Effects.h"

#include "Engine/Loudspeaker/Network.h"
#include "Engine/Loudspeaker/RelaxationSpectrum.h"
#include "Engine/Numerics/LadderCells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

namespace excursion {
namespace {

/// Currents in the iron, Z(s) = sum_k R_k s/(s + p_k) with R_k > 0: resistors in parallel with inductors, as any set of
/// passive loops that couple to the coil. Beforehand it is a semi-inductance Z(s) = K s^a [B 5], drawn by the ladder of
/// Engine/Numerics/LadderCells.h with its tails as one cell with a series resistor (below) and one with a series
/// inductor (above). So the element is K (jw)^a within 3.5e-4 from the lowest to the highest frequency of interest and
/// still has finite resistance and stiffness in the numerical sense.
/// The fastest cells below the upper tail, those that the impedance shows, depart from the law in rate and weight as
/// far as the data asks (RelaxationSpectrum.h): real coils follow K s^a within a few to thirty percent. A cell's memory
/// is the current j_k through its inductor: dj_k/dt = p_k (i - j_k), voltage R_k (i - j_k).
class EddyCurrents final : public EffectOf<EddyCurrents>, public NetworkParts {
public:
    EddyCurrents()
        : EffectOf({.id = "eddy-currents",
                    .title = "Eddy currents (semi-inductance)",
                    .physics = "Currents induced in the iron make the coil's impedance rise about like a fractional "
                               "power of frequency, K s^a.",
                    .symptoms = "linear residual voltage well above resonance, with a steady slope of the magnitude "
                                "and a phase that stays below 90 degrees",
                    .remedy = "It is no fault; a copper ring lowers it and makes it more linear.",
                    .electrical = true,
                    .linear = true})
    {
    }

    bool relaxes() const override { return true; }

    std::vector<Parameter> parameters(const OperatingRange&) const override
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
        std::vector<Parameter> result {K, a};
        for (auto& p : spectrum::parameters())
            result.push_back(std::move(p));
        return result;
    }
    /// Along the law, and as one loop with a time constant somewhere in the band, as of a copper ring.
    std::vector<std::vector<double>> starts(const OperatingRange&) const override
    {
        std::vector<std::vector<double>> result;
        for (const double a : {0.5, 0.65, 0.8}) {
            result.emplace_back(2 + spectrum::departures, 0.0);
            result.back()[1] = a;
        }
        constexpr double flat = 0.9;  // exponent: slow cells have little weight
        for (const int cell : {1, 3, 5, 6, 7}) {
            result.push_back({0.0, flat});
            const auto alone = spectrum::nearlyAlone(cell);
            result.back().insert(result.back().end(), alone.begin(), alone.end());
        }
        return result;
    }

    /// K and a of the straight line through log|Z| over log w in the band, and how far |Z| lies from it (rms).
    std::vector<Figure> summary(const OperatingRange& e, const double* parameters) const override
    {
        if (!(parameters[0] > 0.0))
            return {{"K", "ohm s^a", 0.0}, {"a", "1", parameters[1]}, {"departure", "%", 0.0}};
        std::vector<double> c(static_cast<std::size_t>(coefficientCount(e)));
        prepareFor(e, parameters, c.data());
        constexpr int points = 60;
        double mean = 0.0, slope = 0.0, spread = 0.0, rest = 0.0;
        std::array<double, points> across {}, up {};
        const double low = std::log(2.0 * std::numbers::pi * e.lowFrequency),
                     high = std::log(2.0 * std::numbers::pi * e.highFrequency);
        for (std::size_t n = 0; n < points; ++n) {
            across[n] = (high - low) * ((static_cast<double>(n) + 0.5) / points - 0.5);
            up[n] = std::log(std::abs(impedance(e, c.data(), {0.0, std::exp(across[n] + 0.5 * (low + high))})));
            mean += up[n] / points;
            slope += across[n] * up[n];
            spread += across[n] * across[n];
        }
        slope /= spread;
        for (std::size_t n = 0; n < points; ++n)
            rest += std::pow(up[n] - mean - slope * across[n], 2) / points;
        return {{"K", "ohm s^a", std::exp(mean - slope * 0.5 * (low + high))},
                {"a", "1", slope},
                {"departure", "%", 100.0 * std::sqrt(rest)}};
    }

    double addsTo(std::string_view base, const OperatingRange& e, const double* parameters,
                  double frequency) const override
    {
        if (base != "Le" || !(parameters[0] > 0.0))
            return 0.0;
        std::vector<double> c(static_cast<std::size_t>(coefficientCount(e)));
        prepareFor(e, parameters, c.data());
        const double omega = 2.0 * std::numbers::pi * frequency;
        return impedance(e, c.data(), {0.0, omega}).imag() / omega;
    }

    int memorySize(const OperatingRange& e) const override { return innerCells(e) + 2; }
    int coefficientCount(const OperatingRange& e) const override { return 2 + 2 * memorySize(e); }

    /// Coefficients: series resistance, series inductance, then per cell its rate p_k and resistance R_k.
    template <class T>
    void prepareFor(const OperatingRange& e, const T* parameters, T* c) const
    {
        const T &K = parameters[0], &a = parameters[1];
        const int inner = innerCells(e), first = inner - spectrum::cells;
        // step: ln q
        const double low = std::log(lowRate(e)), high = std::log(highRate(e)), step = (high - low) / inner;
        const T factor = ladderFactor(K, a, step);

        T* cell = c + 2;
        for (int k = 0; k < inner; ++k) {
            const double logRate = low + step * (k + 0.5);
            const auto departs = k < first ? spectrum::Departure<T> {T(1.0), T(1.0)}
                                           : spectrum::departure(parameters + 2, k - first);
            *cell++ = std::exp(logRate) * departs.rate;
            *cell++ = factor * ladderWeight(logRate, a) * departs.weight;
        }
        const auto below = ladderBelow(low - 0.5 * step, a, step), above = ladderAbove(high + 0.5 * step, a, step);
        *cell++ = below.rate;
        *cell++ = factor * below.resistance;
        *cell++ = above.rate;
        *cell++ = factor * above.resistance;
        c[0] = factor * below.constant;
        c[1] = factor * above.constant;
    }

    template <class T>
    void addTo(const OperatingRange& e, const T* c, const Motion<T>& at, const T* memory, T* rate,
               Balance<T>& sum) const
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

    void draw(const OperatingRange& e, const double* c, NetworkDrawing& into) const override
    {
        into.resistor(c[0]);
        into.inductor(c[1]);
        for (int k = 0; k < memorySize(e); ++k)
            into.cell(c[3 + 2 * k], c[3 + 2 * k] / c[2 + 2 * k]);
    }

private:
    std::complex<double> impedance(const OperatingRange& e, const double* c, std::complex<double> s) const
    {
        std::complex<double> sum = c[0] + s * c[1];
        for (int k = 0; k < memorySize(e); ++k)
            sum += c[3 + 2 * k] * s / (s + c[2 + 2 * k]);
        return sum;
    }

    static double lowRate(const OperatingRange& e) { return 2.0 * std::numbers::pi * e.lowFrequency * 0.15; }
    static double highRate(const OperatingRange& e) { return 2.0 * std::numbers::pi * e.highFrequency * 2.5; }
    /// ln q of 1 and the margins of the two rates each leave an error below 3.5e-4; wider margins would make the
    /// fastest cell stiff.
    static int innerCells(const OperatingRange& e)
    {
        return std::max(spectrum::cells, static_cast<int>(std::ceil(std::log(highRate(e) / lowRate(e)))));
    }
};

}  // namespace

const Effect& eddyCurrents()
{
    static const EddyCurrents effect;
    return effect;
}

}  // namespace excursion
