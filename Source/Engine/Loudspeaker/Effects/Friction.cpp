// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/Effects/Effects.h"

#include <cmath>
#include <numbers>

namespace excursion {
namespace {

/// Hysteresis that depends on how far the cone went and not on how fast: Dahl's model (1968), one element per reach
/// r_k,
///     F = -(F_c/n) sum_k g_k,   dg_k/dt = (v - |v| g_k) / r_k,   k = 1 .. n,
/// g the share of its limit that an element carries. After a turn an element follows like a spring of F_c/(n r_k) and
/// slips when the cone has gone a few r_k. How it begins to slip differs from one weave to the next, so the rate is
///     dg_k/dt = (v - ((1 - t) |v| g_k + t v |g_k|) (1 - q + q g_k^2)) / r_k,   0 <= q <= 1, 0 <= t <= 1/2,
/// with a knee q, which holds longer and lets go at once, and a share t that springs back along a line after a turn, as
/// in Bouc's and Wen's model (1976), of which more than 1/2 would make energy of nothing; both are 0 in Dahl's. The
/// reaches lie evenly on a logarithmic axis, over `spread` octaves around
/// `reach`; several elements approach the distributed slip of Iwan's model (1966). |v| is rounded within a thousandth
/// of the visited velocity (within a hundredth the motion would be wrong by -78 dB, which quiet takes show),
///     |v| = V s^2 (3 - 3 s + s^2),  s = |v|/V < 1,
/// where it has two continuous derivatives and vanishes at rest, so that a cone that stands still forgets nothing.
class Friction final : public EffectOf<Friction> {
public:
    Friction()
        : EffectOf(
            {.id = "friction",
             .title = "Suspension hysteresis (friction)",
             .physics = "Fibres of the spider and surround rub and slip: after every turn of the cone a force builds "
                        "up against it and then holds.",
             .symptoms = "residual force that follows the sign of the velocity, as large at low as at high frequencies "
                         "and the same at all levels: stiffer and more damped where the cone moves little",
             .remedy = "Impregnation of the spider, glue joints and lead-out wires rub; a smoother weave or less "
                       "doping lowers the loss.",
             .electrical = false,
             .linear = false})
    {
    }
    /// To undo what hysteresis holds the voltage would have to hold it in silence, too.
    bool undone() const override { return false; }
    Evidence evidence() const override { return Evidence::loop; }
    std::string sizedBy() const override { return "K"; }

    std::vector<Parameter> parameters(const OperatingRange& e) const override
    {
        const double springForce = e.scale * e.displacement, X = e.displacement;
        constexpr double anySpread = 3.0;
        return {{.name = "Fc", .unit = "N", .lower = 0.0, .strength = true, .prior = springForce},
                {.name = "reach", .unit = "m", .value = 0.08 * X, .lower = 2e-3 * X, .upper = 2.0 * X},
                {.name = "spread", .unit = "octaves", .value = 2.0, .even = true, .prior = anySpread},
                {.name = "knee", .unit = "1", .lower = 0.0, .upper = 1.0, .prior = 0.5},
                {.name = "turn", .unit = "1", .lower = 0.0, .upper = 0.5, .prior = 0.25}};
    }

    /// It slips from the first tenth of the way on, at once, or hardly at all: what derivatives show at one start tells
    /// nothing of the others.
    std::vector<std::vector<double>> starts(const OperatingRange& e) const override
    {
        auto all = Effect::starts(e);
        for (const double reach : {0.6, 0.01}) {
            all.push_back(all.front());
            all.back()[1] = reach * e.displacement;
        }
        return all;
    }

    int memorySize(const OperatingRange&) const override { return elements; }
    int coefficientCount(const OperatingRange&) const override { return 3 + elements; }

    /// Coefficients: the limit of one element, knee, turn, then 1/r_k.
    template <class T>
    void prepareFor(const OperatingRange&, const T* p, T* c) const
    {
        using std::exp;
        c[0] = p[0] * (1.0 / elements);
        c[1] = p[3];
        c[2] = p[4];
        for (int k = 0; k < elements; ++k)
            c[3 + k] = exp(std::numbers::ln2 * p[2] * (0.5 - k / (elements - 1.0))) / p[1];
    }

    template <class T>
    void addTo(const OperatingRange& e, const T* c, const Motion<T>& at, const T* memory, T* rate,
               Balance<T>& sum) const
    {
        const T speed = (1.0 - c[2]) * size(at.v, rounding * e.velocity), straight = c[2] * at.v;
        T carried = T(0.0);
        for (int k = 0; k < elements; ++k) {
            const T& g = memory[k];
            const T slips = speed * g + (g < T(0.0) ? -straight : straight) * g;
            rate[k] = (at.v - slips * (1.0 + c[1] * (g * g - 1.0))) * c[3 + k];
            carried += g;
        }
        sum.force -= c[0] * carried;
    }

private:
    static constexpr int elements = 4;
    static constexpr double rounding = 0.001;  // of the visited velocity

    template <class T>
    static T size(const T& v, double width)
    {
        T positive = v < T(0.0) ? -v : v;
        if (positive > T(width))
            return positive;
        const T s = positive * (1.0 / width);
        return width * s * s * (3.0 - 3.0 * s + s * s);
    }
};

}  // namespace

const Effect& friction()
{
    static const Friction effect;
    return effect;
}

}  // namespace excursion
