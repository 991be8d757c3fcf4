// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/Curve.h"
#include "Engine/Loudspeaker/Effects/Effects.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace excursion {
namespace {

/// m of DampingVelocity, by its n.
constexpr int sided(int n) { return std::max(3, n / 2); }

/// Rms(v) = Rms + sum_{k=1..n} c_k [T_k(y) - T_k(-1)] + w (a_1 + a_3 w^2 + sum_{k=1,3,4..m} b_k [T_k(y) - T_k(0)]),
/// w = v/V,   y = 2 s - 1,   s = sqrt((w - w_0)^2 + e^2) - sqrt(w_0^2 + e^2),   e = 1/50,   m = max(3, n/2),
/// with Chebyshev polynomials T_k. Damping of air flow grows like |v|, which no short polynomial in v imitates: s is
/// |w|, rounded at rest so that the law stays differentiable. The terms with w let inward and outward differ, as a vent
/// does that resists otherwise from its other side: soon after rest, which no short polynomial in v imitates either.
/// w_0 is where the flow is least resisted, near rest. Beyond the visited range, up to twice it, a law that rises goes
/// on in proportion to |v|.
class DampingVelocity final : public EffectOf<DampingVelocity> {
public:
    DampingVelocity()
        : EffectOf(
            {.id = "damping-velocity",
             .title = "Mechanical resistance Rms(v)",
             .physics =
                 "Air pumped through narrow vents and the spider resists more than in proportion to the velocity.",
             .symptoms = "residual force that is a curve of v alone, strongest around resonance, no residual voltage",
             .remedy = "Larger or rounder vents under the dust cap and spider make Rms(v) constant.",
             .electrical = false,
             .linear = false})
    {
    }

    std::vector<Parameter> parameters(const OperatingRange& e) const override
    {
        std::vector<Parameter> result;
        result = curve::parameters(e, "N s/m");
        for (const int k : {1, 3}) {
            Parameter p = result.front();
            p.name = "a" + std::to_string(k);
            p.prior = curve::plausible(k, e.scale);
            result.push_back(p);
        }
        Parameter centre;
        centre.name = "centre";
        centre.unit = "1";
        centre.lower = -0.4;
        centre.upper = 0.4;
        centre.prior = 0.3;
        result.push_back(centre);
        for (int k = 1; k <= sided(e.degree); ++k)
            if (k != 2)  // nearly that of a3
                result.push_back(
                    {.name = "b" + std::to_string(k), .unit = "N s/m", .prior = curve::plausible(k + 1, e.scale)});
        return result;
    }
    std::optional<LawInfo> law() const override { return LawInfo {"Rms(v)", "N s/m", "v", "m/s", "Rms"}; }
    double lawAt(const OperatingRange& e, const double* p, double v) const override
    {
        std::array<double, curve::maximumDegree + sided(curve::maximumDegree) + 6> c {};
        prepareFor(e, p, c.data());
        return at(e, c.data(), v);
    }
    int coefficientCount(const OperatingRange& e) const override { return e.degree + sided(e.degree) + 6; }

    template <class T>
    void prepareFor(const OperatingRange& e, const T* p, T* c) const
    {
        using std::sqrt;
        // Powers of y = 2 s - 1: those of s would cancel to the square of the digits.
        const int n = e.degree;
        curve::prepare(n, p, c);
        c[0] = T(0.0);  // no difference at rest, y = -1
        for (int j = 1; j <= n; ++j)
            c[0] += j % 2 == 0 ? -c[j] : c[j];
        c[n + 1] = p[n];
        c[n + 2] = p[n + 1];
        c[n + 3] = p[n + 2];
        c[n + 4] = sqrt(p[n + 2] * p[n + 2] + rounding * rounding);
        std::array<T, sided(curve::maximumDegree)> b {p[n + 3], T(0.0)};
        std::copy(p + n + 4, p + n + 2 + sided(n), b.begin() + 2);
        curve::prepare(sided(n), b.data(), c + n + 5);
    }

    template <class T>
    void addTo(const OperatingRange& e, const T* c, const Motion<T>& motion, const T*, T*, Balance<T>& sum) const
    {
        sum.force -= at(e, c, motion.v) * motion.v;
    }

private:
    static constexpr double rounding = 0.02;

    template <class T>
    [[gnu::always_inline]] static T at(const OperatingRange& e, const T* c, const T& v)
    {
        using std::sqrt;
        T w = v * (1.0 / e.velocity);
        T reach = T(1.0);
        if (w > T(1.0) || w < T(-1.0)) {
            reach = w > T(0.0) ? w : -w;
            if (reach > T(2.0))
                reach = T(2.0);
            w = w > T(0.0) ? T(1.0) : T(-1.0);
        }
        const int n = e.degree;
        const T square = w * w, off = w - c[n + 3];
        const T s = sqrt(off * off + rounding * rounding) - c[n + 4];
        const T y = 2.0 * s - 1.0;
        T value = curve::polynomial(n, c, y);
        value += w * (c[n + 1] + square * c[n + 2] + curve::polynomial(sided(n), c + n + 5, y));
        return value > T(0.0) ? value * reach : value;
    }
};

}  // namespace

const Effect& dampingVelocity()
{
    static const DampingVelocity effect;
    return effect;
}

}  // namespace excursion
