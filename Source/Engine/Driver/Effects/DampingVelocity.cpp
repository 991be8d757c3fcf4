// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Driver/Effects/Effects.h"

#include <array>
#include <cmath>

namespace excursion {
namespace {

/// Rms(v) = Rms + sum_{k=1..n} c_k s^k + a_1 w + a_3 w^3,  w = v/V,  s = sqrt(w^2 + e^2) - e,  e = 1/50.
/// Damping of air flow grows like |v|, which no short polynomial in v imitates: s is |w|, rounded at
/// rest so that the law stays differentiable. The odd terms let inward and outward differ.
class DampingVelocity final : public EffectOf<DampingVelocity> {
public:
    std::string id() const override { return "damping-velocity"; }
    std::string title() const override { return "Mechanical resistance Rms(v)"; }
    std::string physics() const override
    {
        return "Air pumped through narrow vents and the spider resists more than in proportion to the velocity.";
    }
    std::string symptoms() const override
    {
        return "residual force that is a curve of v alone, strongest around resonance, no residual voltage";
    }
    std::string remedy() const override
    {
        return "Larger or rounder vents under the dust cap and spider make Rms(v) constant.";
    }
    bool electrical() const override { return false; }
    bool linear() const override { return false; }

    std::vector<Parameter> parameters(const Extent& e) const override
    {
        std::vector<Parameter> result;
        const auto add = [&result](const std::string& name) {
            Parameter p;
            p.name = name;
            p.unit = "N s/m";
            p.strength = true;
            result.push_back(p);
        };
        for (int k = 1; k <= e.degree; ++k)
            add("c" + std::to_string(k));
        add("a1");
        add("a3");
        return result;
    }
    std::optional<LawInfo> law() const override { return LawInfo {"Rms(v)", "N s/m", "v", "m/s", "Rms"}; }
    double lawAt(const Extent& e, const double* p, double v) const override { return at(e, p, v); }
    int coefficientCount(const Extent& e) const override { return e.degree + 2; }

    template <class T>
    void prepareFor(const Extent& e, const T* p, T* c) const
    {
        std::copy(p, p + coefficientCount(e), c);
    }

    template <class T>
    void addTo(const Extent& e, const T* c, const Motion<T>& motion, const T*, T*, Balance<T>& sum) const
    {
        sum.force -= at(e, c, motion.v) * motion.v;
    }

private:
    template <class T>
    static T at(const Extent& e, const T* c, const T& v)
    {
        using std::sqrt;
        constexpr double rounding = 0.02;
        T w = v * (1.0 / e.velocity);
        if (w > T(1.0) || w < T(-1.0))
            w = w > T(0.0) ? T(1.0) : T(-1.0);
        const T square = w * w;
        const T s = sqrt(square + rounding * rounding) - rounding;
        T value = c[e.degree - 1];
        for (int k = e.degree - 2; k >= 0; --k)
            value = value * s + c[k];
        return value * s + w * (c[e.degree] + square * c[e.degree + 1]);
    }
};

} // namespace

const Effect& dampingVelocity()
{
    static const DampingVelocity effect;
    return effect;
}

} // namespace excursion
