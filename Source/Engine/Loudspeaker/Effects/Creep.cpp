// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/Effects/Effects.h"

#include "Engine/Loudspeaker/Network.h"
#include "Engine/Loudspeaker/RelaxationSpectrum.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>

namespace excursion {
namespace {

/// A viscoelastic suspension is a spring with relaxing ones beside it (generalized Maxwell body):
///     F = K x + sum_k K_k (x - y_k),   dy_k/dt = 2 pi f_k (x - y_k),
/// which any linear suspension with positive relaxations is, a chain of Kelvin-Voigt cells too. Beforehand the
/// relaxation frequencies f_k lie evenly on a logarithmic axis, over `width` decades around 10^centre Hz, and K_k grows
/// like f_k^tilt, sum K_k = S. A wide even band is the logarithmic creep of Knudsen and Jensen (J. Audio Eng. Soc. 41,
/// 1993), a wide tilted one a fractional (spring-pot) suspension, a narrow one the three-parameter solid. From there
/// f_k and K_k depart as far as the data asks (RelaxationSpectrum.h).
class Creep final : public EffectOf<Creep>, public NetworkParts {
public:
    Creep()
        : EffectOf(
            {.id = "creep",
             .title = "Suspension creep",
             .physics = "The rubber and cloth of the suspension yield slowly: the compliance grows as frequency falls.",
             .symptoms =
                 "linear residual force below and around resonance, a stiffness that rises slowly with frequency",
             .remedy = "A surround and spider of less lossy material creep less.",
             .electrical = false,
             .linear = true})
    {
    }
    bool relaxes() const override { return true; }
    std::string sizedBy() const override { return "K"; }

    std::vector<Parameter> parameters(const OperatingRange& e) const override
    {
        Parameter strength, centre, width, tilt;
        strength.name = "S";
        strength.unit = "N/m";
        strength.lower = 0.0;
        strength.strength = true;
        // Relaxations far above resonance, where the mass rules, would else take any strength.
        strength.prior = 0.3 * e.scale;
        centre.name = "centre";
        centre.unit = "log10 Hz";
        centre.value = std::log10(e.lowFrequency);
        centre.lower = std::log10(e.lowFrequency) - 2.0;
        centre.upper = std::log10(e.lowFrequency) + 1.5;
        width.name = "width";
        width.unit = "decades";
        width.value = 2.0;
        width.even = true;  // with the signs of the odd departures, its own only mirrors the relaxations
        width.prior = 3.0;
        tilt.name = "tilt";
        tilt.unit = "1";
        tilt.prior = 0.5;
        std::vector<Parameter> result {strength, centre, width, tilt};
        for (auto& p : spectrum::parameters())
            result.push_back(std::move(p));
        return result;
    }
    std::vector<std::vector<double>> starts(const OperatingRange& e) const override
    {
        const double low = std::log10(e.lowFrequency);
        std::vector<std::vector<double>> result {
            {0.0, low, 3.0, 0.0}, {0.0, low + 0.3, 0.5, 0.0}, {0.0, low - 0.5, 0.5, 0.0}};
        for (auto& start : result)
            start.resize(shape + spectrum::departures, 0.0);
        return result;
    }

    /// No suspension stiffens threefold from a third of the lowest frequency on, nor by a half within the first decade
    /// from there: the air of a closed box that leaks does. What lies farther below the band does not show.
    bool plausible(const OperatingRange& e, const std::vector<Parameter>& own,
                   const std::vector<Parameter>& base) const override
    {
        constexpr double most = 3.0, mostWithinDecade = 1.5, below = 1.0 / 3.0;
        std::vector<double> values;
        for (const auto& p : own)
            values.push_back(p.value);
        const double atRest = parameterNamed(base, "K").value, low = below * e.lowFrequency;
        const auto stiffness = [&](double f) { return atRest + stiffnessAt(e, values.data(), f).real(); };
        return atRest + values[0] < most * stiffness(low) && stiffness(10.0 * low) < mostWithinDecade * stiffness(low);
    }

    /// By how much the stiffness rises over the lowest decade of the band: the rate of creep.
    std::vector<Figure> summary(const OperatingRange& e, const double* parameters) const override
    {
        return {{"creep rate", "N/m per decade",
                 stiffnessAt(e, parameters, 10.0 * e.lowFrequency).real()
                     - stiffnessAt(e, parameters, e.lowFrequency).real()}};
    }
    double addsTo(std::string_view base, const OperatingRange& e, const double* parameters,
                  double frequency) const override
    {
        const auto stiffness = stiffnessAt(e, parameters, frequency);
        return base == "K"     ? stiffness.real()
               : base == "Rms" ? stiffness.imag() / (2.0 * std::numbers::pi * frequency)
                               : 0.0;
    }

    int memorySize(const OperatingRange&) const override { return cells; }
    int coefficientCount(const OperatingRange&) const override { return 2 * cells; }

    /// Coefficients: the stiffness and the relaxation rate of each cell.
    template <class T>
    void prepareFor(const OperatingRange&, const T* p, T* c) const
    {
        using std::exp;
        T sum = T(0.0);
        for (int k = 0; k < cells; ++k) {
            const T logarithm = std::numbers::ln10 * p[2] * ((k + 0.5) / cells - 0.5);  // of f_k over the centre
            c[2 * k] = exp(p[3] * logarithm);
            c[2 * k + 1] = 2.0 * std::numbers::pi * exp(std::numbers::ln10 * p[1] + logarithm);
            sum += c[2 * k];
        }
        for (int k = 0; k < cells; ++k) {
            const auto departs = spectrum::departure(p + shape, k);
            c[2 * k] *= p[0] / sum * departs.weight;
            c[2 * k + 1] *= departs.rate;
        }
    }

    template <class T>
    void addTo(const OperatingRange&, const T* c, const Motion<T>& at, const T* memory, T* rate, Balance<T>& sum) const
    {
        T force = T(0.0);
        for (int k = 0; k < cells; ++k) {
            const T difference = at.x - memory[k];
            force += c[2 * k] * difference;
            rate[k] = c[2 * k + 1] * difference;
        }
        sum.force -= force;
    }

    /// Each cell a spring in series with a damper, K_k and K_k/(2 pi f_k).
    void draw(const OperatingRange&, const double* c, NetworkDrawing& into) const override
    {
        for (int k = 0; k < cells; ++k) {
            const auto between = "creep" + std::to_string(k + 1);
            into.spring(Network::cone, between, c[2 * k]);
            into.damper(between, Network::ground, c[2 * k] / c[2 * k + 1]);
        }
    }

private:
    std::complex<double> stiffnessAt(const OperatingRange& e, const double* parameters, double frequency) const
    {
        std::vector<double> c(static_cast<std::size_t>(coefficientCount(e)));
        prepareFor(e, parameters, c.data());
        const std::complex<double> s {0.0, 2.0 * std::numbers::pi * frequency};
        std::complex<double> sum = 0.0;
        for (std::size_t k = 0; k < c.size(); k += 2)
            sum += c[k] * s / (s + c[k + 1]);
        return sum;
    }

    static constexpr int shape = 4;                // parameters ahead of the departures
    static constexpr int cells = spectrum::cells;  // over five decades: a ripple below a thousandth of S
};

}  // namespace

const Effect& creep()
{
    static const Creep effect;
    return effect;
}

}  // namespace excursion
