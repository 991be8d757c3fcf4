// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/Curve.h"
#include "Engine/Loudspeaker/Effects/Effects.h"

#include <numbers>
#include <string>

namespace excursion {
namespace {

/// K(x) = K + c(x): the force -c(x) x beside that of the base. Where the suspension creeps, what yields lies in series
/// with the spring that is bent: it takes from the stretch what the force of the whole, K x + ..., makes of it, and so
/// delays and filters what the bend adds. With the linear yields W of a force K x (the creep's own, of which
/// sum_k w_k p_k/(s + p_k) is a picture within the band),
///     s = x - sum_k w_k h_k,   force -c(s) s + K sum_k w_k (h_k - q_k),
///     dh_k/dt = p_k (x + c(s) s/K - h_k),   dq_k/dt = p_k (x - q_k),   w_k >= 0,
/// as 1/(1 + K Y) = 1 - W for a compliance Y in series with K. The rates are beforehand 6 and two thirds of the band's
/// lower end, around the resonance, where a bent spring makes its distortion, and depart from there by a factor
/// exp(r_k), as far as the data asks. A suspension that hardens goes on hardening beyond the visited range.
class Stiffness final : public EffectOf<Stiffness> {
public:
    Stiffness()
        : EffectOf(
            {.id = "stiffness",
             .title = "Stiffness K(x)",
             .physics =
                 "The suspension hardens, or yields, as it is stretched, and need not do so alike on both sides.",
             .symptoms =
                 "residual force that is a curve of x alone, strongest at and below resonance, no residual voltage",
             .remedy = "A wider surround roll or a softer, symmetric spider straightens K(x); an even part asks for a "
                       "shifted rest position.",
             .electrical = false,
             .linear = false})
    {
    }

    std::vector<Parameter> parameters(const OperatingRange& e) const override
    {
        auto result = curve::parameters(e, "N/m");
        for (int k = 1; k <= yields; ++k)
            result.push_back({.name = "w" + std::to_string(k),
                              .unit = "1",
                              .lower = 0.0,
                              .upper = 1.0,
                              .relaxed = true,
                              .prior = plausibleYield});
        for (int k = 1; k <= yields; ++k)
            result.push_back({.name = "r" + std::to_string(k),
                              .unit = "1",
                              .lower = -farthest,
                              .upper = farthest,
                              .relaxed = true,
                              .prior = plausibleShift});
        return result;
    }
    std::optional<LawInfo> law() const override { return LawInfo {"K(x)", "N/m", "x", "m", "K"}; }
    double lawAt(const OperatingRange& e, const double* p, double x) const override
    {
        return curve::valueAt(e.degree, p, x, e.displacement)
               + curve::beyond(p[0], e.degree > 1 ? p[1] : 0.0, x, e.displacement);
    }
    int memorySize(const OperatingRange& e) const override { return e.relaxed ? 2 * yields : 0; }
    int coefficientCount(const OperatingRange& e) const override { return e.degree + 3 + 2 * yields; }

    /// The curve's, its two ends', then each yield's rate and weight.
    template <class T>
    void prepareFor(const OperatingRange& e, const T* p, T* c) const
    {
        using std::exp;
        curve::prepare(e.degree, p, c);
        c[e.degree + 1] = p[0];
        c[e.degree + 2] = e.degree > 1 ? p[1] : T(0.0);
        double rate = 2.0 * std::numbers::pi * e.lowFrequency * fastest;
        T* yield = c + e.degree + 3;
        for (int k = 0; k < yields; ++k, rate /= spacing) {
            *yield++ = rate * exp(p[e.degree + yields + k]);
            *yield++ = p[e.degree + k];
        }
    }

    template <class T>
    void addTo(const OperatingRange& e, const T* c, const Motion<T>& at, const T* memory, T* rate,
               Balance<T>& sum) const
    {
        const int n = memorySize(e) / 2;
        const T* yield = c + e.degree + 3;
        T stretch = at.x, yielded = T(0.0);
        for (int k = 0; k < n; ++k) {
            const T &h = memory[k], &q = memory[n + k];
            stretch -= yield[2 * k + 1] * h;
            yielded += yield[2 * k + 1] * (h - q);
        }
        const T difference = curve::valueOn(e.degree, c, stretch, e.displacement)
                             + curve::beyond(c[e.degree + 1], c[e.degree + 2], stretch, e.displacement);
        const T bent = difference * stretch;
        for (int k = 0; k < n; ++k) {
            const T &h = memory[k], &q = memory[n + k];
            rate[k] = yield[2 * k] * (at.x + bent / e.scale - h);
            rate[n + k] = yield[2 * k] * (at.x - q);
        }
        sum.force += e.scale * yielded - bent;
    }

private:
    static constexpr int yields = 2;
    static constexpr double plausibleYield = 0.3;
    static constexpr double plausibleShift = 0.8, farthest = 1.5;  // of a yield's ln rate
    static constexpr double fastest = 6.0;                         // over the band's lower end
    static constexpr double spacing = 9.0;                         // from one rate to the next
};

}  // namespace

const Effect& stiffness()
{
    static const Stiffness effect;
    return effect;
}

}  // namespace excursion
