// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Driver/Curve.h"
#include "Engine/Driver/Effects/Effects.h"

#include <cmath>
#include <numbers>
#include <string>

namespace excursion {
namespace {

/// Le(x) = Le + c(x), where c is the change of the flux that the coil's position makes. Not all of that flux follows
/// the current at once: loops in the iron, which move away from the coil with the rest, delay a part of it. So the flux
/// is c(x) F with
///     F = i + sum_k w_k j_k,   dj_k/dt = p_k (i - j_k),   w_k >= 0,
/// a voltage d/dt[c F] = c dF/dt + c' v F. The power u i that is neither stored, c (1/2 i^2 + sum w_k j_k^2/2), nor
/// lost in the loops, c sum w_k p_k (i - j_k)^2, moves the cone: the force is c'(x) (1/2 i^2 + sum w_k (j_k i - 1/2
/// j_k^2)), without loops the reluctance force of the magnetic coenergy. The curve is that of the flux that follows at
/// once. The rates are a third, an 18th and a 108th of the band's upper end: what is faster follows about at once as
/// far as the band shows, and a factor of six from one to the next leaves little of a power law.
class InductancePosition final : public EffectOf<InductancePosition> {
public:
    std::string id() const override { return "inductance-position"; }
    std::string title() const override { return "Inductance Le(x) with reluctance force"; }
    std::string physics() const override
    {
        return "The coil sees more iron inward than outward, so its inductance falls with x and the iron pulls it in.";
    }
    std::string symptoms() const override
    {
        return "residual voltage that grows with frequency and is scaled by a curve of x; a small residual force like "
               "the current squared";
    }
    std::string remedy() const override { return "Shorting rings or a copper cap near the gap flatten Le(x)."; }
    bool electrical() const override { return true; }
    bool linear() const override { return false; }

    std::optional<LawInfo> law() const override { return LawInfo {"Le(x)", "H", "x", "m", "Le"}; }
    double lawAt(const Extent& e, const double* p, double x) const override
    {
        return curve::valueAt(e.degree, p, x, e.displacement);
    }

    std::vector<Parameter> parameters(const Extent& e) const override
    {
        auto result = curve::parameters(e, "H");
        for (int k = 1; k <= loops; ++k)
            result.push_back(
                {.name = "w" + std::to_string(k), .unit = "1", .lower = 0.0, .upper = 1e3, .prior = plausibleWeight});
        return result;
    }
    int memorySize(const Extent&) const override { return loops; }
    bool remembersMotionAlone() const override { return true; }
    int coefficientCount(const Extent& e) const override { return e.degree + 1 + 2 * loops; }

    /// The curve's, then each loop's rate and weight.
    template <class T>
    void prepareFor(const Extent& e, const T* p, T* c) const
    {
        curve::prepare(e.degree, p, c);
        double rate = 2.0 * std::numbers::pi * e.highFrequency / 3.0;
        T* loop = c + e.degree + 1;
        for (int k = 0; k < loops; ++k, rate /= spacing) {
            *loop++ = T(rate);
            *loop++ = p[e.degree + k];
        }
    }

    template <class T>
    void addTo(const Extent& e, const T* c, const Motion<T>& at, const T* memory, T* rate, Balance<T>& sum) const
    {
        const auto [value, slope] = curve::at(e.degree, c, at.x, e.displacement);
        T flux = at.i, delayed = T(0.0), work = 0.5 * at.i * at.i;
        const T* loop = c + e.degree + 1;
        for (int k = 0; k < loops; ++k, loop += 2) {
            rate[k] = loop[0] * (at.i - memory[k]);
            flux += loop[1] * memory[k];
            delayed += loop[1] * rate[k];
            work += loop[1] * memory[k] * (at.i - 0.5 * memory[k]);
        }
        sum.inductance += value;
        sum.fluxSlope += slope * flux;
        sum.drop += value * delayed;
        sum.force += slope * work;
    }

private:
    static constexpr int loops = 3;
    // that of the slowest loop beside a coil that is nothing but a semi-inductance
    static constexpr double plausibleWeight = 30.0;
    static constexpr double spacing = 6.0;  // from one rate to the next
};

}  // namespace

const Effect& inductancePosition()
{
    static const InductancePosition effect;
    return effect;
}

}  // namespace excursion
