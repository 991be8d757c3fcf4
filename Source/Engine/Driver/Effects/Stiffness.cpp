// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Driver/Curve.h"
#include "Engine/Driver/Effects/Effects.h"

#include <numbers>
#include <string>

namespace excursion {
namespace {

/// K(x) = K + c(x). Where the suspension creeps, what yields lies in series with the spring that is bent, which so is
/// stretched by
///     s = x - sum_k w_k q_k,   dq_k/dt = p_k (x - q_k),   w_k >= 0,
/// and adds the force -c(s) s; the linear part of the yielding is the creep's. Without yields that is -c(x) x. The
/// rates are 11, 2 and a third of the band's lower end: around the resonance, where a bent spring makes its distortion.
/// A suspension that hardens goes on hardening beyond the visited range.
class Stiffness final : public EffectOf<Stiffness> {
public:
    std::string id() const override { return "stiffness"; }
    std::string title() const override { return "Stiffness K(x)"; }
    std::string physics() const override
    {
        return "The suspension hardens, or yields, as it is stretched, and need not do so alike on both sides.";
    }
    std::string symptoms() const override
    {
        return "residual force that is a curve of x alone, strongest at and below resonance, no residual voltage";
    }
    std::string remedy() const override
    {
        return "A wider surround roll or a softer, symmetric spider straightens K(x); an even part asks for a shifted "
               "rest position.";
    }
    bool electrical() const override { return false; }
    bool linear() const override { return false; }

    std::vector<Parameter> parameters(const Extent& e) const override
    {
        auto result = curve::parameters(e, "N/m");
        for (int k = 1; k <= yields; ++k)
            result.push_back({.name = "w" + std::to_string(k),
                              .unit = "1",
                              .lower = 0.0,
                              .upper = 1.0,
                              .relaxed = true,
                              .prior = plausibleYield});
        return result;
    }
    std::optional<LawInfo> law() const override { return LawInfo {"K(x)", "N/m", "x", "m", "K"}; }
    double lawAt(const Extent& e, const double* p, double x) const override
    {
        return curve::valueAt(e.degree, p, x, e.displacement)
               + curve::beyond(p[0], e.degree > 1 ? p[1] : 0.0, x, e.displacement);
    }
    int memorySize(const Extent& e) const override { return e.relaxed ? yields : 0; }
    bool remembersMotionAlone() const override { return true; }
    int coefficientCount(const Extent& e) const override { return e.degree + 3 + 2 * yields; }

    /// The curve's, its two ends', then each yield's rate and weight.
    template <class T>
    void prepareFor(const Extent& e, const T* p, T* c) const
    {
        curve::prepare(e.degree, p, c);
        c[e.degree + 1] = p[0];
        c[e.degree + 2] = e.degree > 1 ? p[1] : T(0.0);
        double rate = 2.0 * std::numbers::pi * e.lowFrequency * fastest;
        T* yield = c + e.degree + 3;
        for (int k = 0; k < yields; ++k, rate /= spacing) {
            *yield++ = T(rate);
            *yield++ = p[e.degree + k];
        }
    }

    template <class T>
    void addTo(const Extent& e, const T* c, const Motion<T>& at, const T* memory, T* rate, Balance<T>& sum) const
    {
        T stretch = at.x;
        const T* yield = c + e.degree + 3;
        for (int k = 0; k < memorySize(e); ++k, yield += 2) {
            rate[k] = yield[0] * (at.x - memory[k]);
            stretch -= yield[1] * memory[k];
        }
        const T difference = curve::at(e.degree, c, stretch, e.displacement).value
                             + curve::beyond(c[e.degree + 1], c[e.degree + 2], stretch, e.displacement);
        sum.force -= difference * stretch;
    }

private:
    static constexpr int yields = 3;
    static constexpr double plausibleYield = 0.3;
    static constexpr double fastest = 11.0;  // over the band's lower end
    static constexpr double spacing = 6.0;   // from one rate to the next
};

}  // namespace

const Effect& stiffness()
{
    static const Stiffness effect;
    return effect;
}

}  // namespace excursion
