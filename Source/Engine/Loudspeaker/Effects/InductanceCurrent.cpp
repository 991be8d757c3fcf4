// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/Curve.h"
#include "Engine/Loudspeaker/Effects/Effects.h"

#include <array>

namespace excursion {
namespace {

/// Flux modulation: the coil's flux is (Le + c(i)) i, so that Le(i) = Le + c(i) is flux per current and what the
/// voltage sees is
///     d(phi)/di = Le + c(i) + i dc/di.
/// An even law saturates the iron; an odd one is the field of the coil that adds to the magnet's or takes from it. The
/// flux depends on no position, so it makes no force; beside Le(x) the two differences add. Beyond the visited range
/// the flux goes on with the slope that it has at the end.
class InductanceCurrent final : public CurveLaw<InductanceCurrent> {
public:
    InductanceCurrent()
        : CurveLaw({.id = "inductance-current",
                    .title = "Flux modulation Le(i)",
                    .physics = "The coil's own field drives the iron in and out of saturation, so the inductance "
                               "changes with the current.",
                    .symptoms = "residual voltage that grows with frequency and is scaled by a curve of the current, "
                                "wherever the cone is; no residual force",
                    .remedy = "Shorting rings hold the flux still; iron that is saturated by the magnet alone has "
                              "little left to change.",
                    .electrical = true,
                    .linear = false})
    {
    }

    std::optional<LawInfo> law() const override { return LawInfo {"Le(i)", "H", "i", "A", "Le"}; }
    double lawAt(const OperatingRange& e, const double* p, double i) const override
    {
        std::array<double, curve::maximumDegree + 1> b {};
        curve::prepare(e.degree, p, b.data());
        if (std::abs(i) <= e.current)
            return curve::at(e.degree, b.data(), i, e.current).value;
        const double end = i > 0.0 ? e.current : -e.current;
        return (curve::at(e.degree, b.data(), end, e.current).value * end + fluxSlope(e, b.data(), end) * (i - end))
               / i;
    }

    template <class T>
    void addTo(const OperatingRange& e, const T* c, const Motion<T>& at, const T*, T*, Balance<T>& sum) const
    {
        sum.inductance += fluxSlope(e, c, at.i);
    }

private:
    /// c + i dc/di
    template <class T>
    static T fluxSlope(const OperatingRange& e, const T* c, T i)
    {
        if (i > T(e.current) || i < T(-e.current))
            i = i > T(0.0) ? T(e.current) : T(-e.current);
        const auto [value, slope] = curve::at(e.degree, c, i, e.current);
        return value + i * slope;
    }
};

}  // namespace

const Effect& inductanceCurrent()
{
    static const InductanceCurrent effect;
    return effect;
}

}  // namespace excursion
