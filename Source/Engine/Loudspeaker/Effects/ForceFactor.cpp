// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/Curve.h"
#include "Engine/Loudspeaker/Effects/Effects.h"

namespace excursion {
namespace {

/// Bl(x) = Bl + c(x): force c(x) i, motion voltage c(x) v. The same curve stands in both equations, because
/// the motor converts without loss.
class ForceFactor final : public CurveLaw<ForceFactor> {
public:
    ForceFactor()
        : CurveLaw(
            {.id = "force-factor",
             .title = "Force factor Bl(x)",
             .physics =
                 "The coil leaves the gap: force per ampere and motion voltage per m/s change with its position.",
             .symptoms = "residual force in step with the current and residual voltage in step with the velocity, both "
                         "scaled by the same curve of x",
             .remedy = "A longer coil or gap, or a centred rest position, flattens Bl(x); its offset shows how far to "
                       "shift the coil.",
             .electrical = true,
             .linear = false})
    {
    }

    std::optional<LawInfo> law() const override { return LawInfo {"Bl(x)", "N/A", "x", "m", "Bl"}; }
    double lawAt(const OperatingRange& e, const double* p, double x) const override
    {
        return curve::valueAt(e.degree, p, x, e.displacement);
    }

    template <class T>
    void addTo(const OperatingRange& e, const T* c, const Motion<T>& at, const T*, T*, Balance<T>& sum) const
    {
        const T difference = curve::valueOn(e.degree, c, at.x, e.displacement);
        sum.force += difference * at.i;
        sum.drop += difference * at.v;
    }
};

}  // namespace

const Effect& forceFactor()
{
    static const ForceFactor effect;
    return effect;
}

}  // namespace excursion
