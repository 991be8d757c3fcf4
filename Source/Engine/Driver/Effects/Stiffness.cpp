// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Driver/Curve.h"
#include "Engine/Driver/Effects/Effects.h"

namespace excursion {
namespace {

/// K(x) = K + c(x): restoring force -c(x) x besides the base's -K x. A suspension that hardens goes on hardening beyond the
/// visited range.
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
        return "A wider surround roll or a softer, symmetric spider straightens K(x); an even part asks for a shifted rest position.";
    }
    bool electrical() const override { return false; }
    bool linear() const override { return false; }

    std::vector<Parameter> parameters(const Extent& e) const override { return curve::parameters(e, "N/m"); }
    std::optional<LawInfo> law() const override { return LawInfo {"K(x)", "N/m", "x", "m", "K"}; }
    double lawAt(const Extent& e, const double* p, double x) const override
    {
        return curve::valueAt(e.degree, p, x, e.displacement) + curve::beyond(p[0], e.degree > 1 ? p[1] : 0.0, x, e.displacement);
    }
    int coefficientCount(const Extent& e) const override { return e.degree + 3; }

    template <class T>
    void prepareFor(const Extent& e, const T* p, T* c) const
    {
        curve::prepare(e.degree, p, c);
        c[e.degree + 1] = p[0];
        c[e.degree + 2] = e.degree > 1 ? p[1] : T(0.0);
    }

    template <class T>
    void addTo(const Extent& e, const T* c, const Motion<T>& at, const T*, T*, Balance<T>& sum) const
    {
        const T difference = curve::at(e.degree, c, at.x, e.displacement).value
                             + curve::beyond(c[e.degree + 1], c[e.degree + 2], at.x, e.displacement);
        sum.force -= difference * at.x;
    }
};

} // namespace

const Effect& stiffness()
{
    static const Stiffness effect;
    return effect;
}

} // namespace excursion
