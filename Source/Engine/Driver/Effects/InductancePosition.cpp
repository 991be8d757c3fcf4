// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Driver/Curve.h"
#include "Engine/Driver/Effects/Effects.h"

namespace excursion {
namespace {

/// Le(x) = Le + c(x): flux c(x) i, hence a voltage d/dt[c(x) i] = c di/dt + c' v i, and from the coil's
/// magnetic coenergy W' = 1/2 Le(x) i^2 the reluctance force dW'/dx = 1/2 i^2 c'(x).
class InductancePosition final : public CurveLaw<InductancePosition> {
public:
    std::string id() const override { return "inductance-position"; }
    std::string title() const override { return "Inductance Le(x) with reluctance force"; }
    std::string physics() const override
    {
        return "The coil sees more iron inward than outward, so its inductance falls with x and the iron pulls it in.";
    }
    std::string symptoms() const override
    {
        return "residual voltage that grows with frequency and is scaled by a curve of x; a small residual force like the current squared";
    }
    std::string remedy() const override
    {
        return "Shorting rings or a copper cap near the gap flatten Le(x).";
    }
    bool electrical() const override { return true; }
    bool linear() const override { return false; }

    std::optional<LawInfo> law() const override { return LawInfo {"Le(x)", "H", "x", "m", "Le"}; }
    double lawAt(const Extent& e, const double* p, double x) const override
    {
        return curve::valueAt(e.degree, p, x, e.displacement);
    }

    template <class T>
    void addTo(const Extent& e, const T* c, const Motion<T>& at, const T*, T*, Balance<T>& sum) const
    {
        const auto [value, slope] = curve::at(e.degree, c, at.x, e.displacement);
        const T slopeCurrent = slope * at.i;
        sum.inductance += value;
        sum.fluxSlope += slopeCurrent;
        sum.force += 0.5 * slopeCurrent * at.i;
    }
};

} // namespace

const Effect& inductancePosition()
{
    static const InductancePosition effect;
    return effect;
}

} // namespace excursion
