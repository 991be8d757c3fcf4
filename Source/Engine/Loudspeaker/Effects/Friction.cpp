// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/Effects/Effects.h"

#include <ceres/jet.h>

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace excursion {
namespace {

/// Hysteresis that depends on how far the cone went and hardly on how fast: Dahl's model (1968), one element per reach
/// r_k,
///     F = -(F_c/n) sum_k g_k,   dg_k/dt = (v - |v| g_k) / r_k,   k = 1 .. n,
/// g the share of its limit at speed that an element carries. After a turn an element follows like a spring of F_c/(n
/// r_k) and slips when the cone has gone a few r_k. How it begins to slip differs from one weave to the next, so the
/// rate is
///     dg_k/dt = (v - |v| sign(v) (1 - (1 - h(g_k sign(v)/G))^(1 + e))) / r_k,
///     h(s) = s (1 - q + q s^2), times 1 - 2 t where s < 0,   G = 1 + b exp(-(v/v_s)^2),   v_s = V 2^w/10,
/// with a knee q, 0 <= q <= 1, which holds longer and lets go at once; a share t, 0 <= t <= 1/2, that springs back
/// along a line after a turn, as in Bouc's and Wen's model (1976), of which more than 1/2 would make energy of nothing;
/// Dahl's exponent 1 + e, which is above 1 for what yields early and holds on late; and a limit that is higher by b for
/// a cone that creeps slower than v_s, as in the model of Canudas de Wit et al. (1995, IEEE Trans. Autom. Control 40).
/// All of these are 0 in Dahl's first model. The reaches lie evenly on a logarithmic axis, over `spread` octaves around
/// `reach`; several elements approach the distributed slip of Iwan's model (1966). |v| is rounded within a thousandth
/// of the visited velocity V (within a hundredth the motion would be wrong by -78 dB, which quiet takes show),
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
                {.name = "turn", .unit = "1", .lower = 0.0, .upper = 0.5, .prior = 0.25},
                {.name = "bend", .unit = "1", .lower = -0.6, .upper = 1.0, .prior = 0.5},
                {.name = "stick", .unit = "1", .lower = -0.5, .upper = 2.0, .prior = 0.3},
                {.name = "pace", .unit = "octaves", .lower = -5.0, .upper = 3.3, .prior = 1.5}};
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
    int coefficientCount(const OperatingRange&) const override { return reaches + elements; }

    /// Coefficients: the limit of one element, knee, turn, exponent, stick, 1/v_s, then 1/r_k.
    template <class T>
    void prepareFor(const OperatingRange& e, const T* p, T* c) const
    {
        using std::exp;
        c[0] = p[0] * (1.0 / elements);
        c[1] = p[3];
        c[2] = p[4];
        c[3] = 1.0 + p[5];
        c[4] = p[6];
        c[5] = exp(-std::numbers::ln2 * p[7]) * (10.0 / e.velocity);
        for (int k = 0; k < elements; ++k)
            c[reaches + k] = exp(std::numbers::ln2 * p[2] * (0.5 - k / (elements - 1.0))) / p[1];
    }

    template <class T>
    void addTo(const OperatingRange& e, const T* c, const Motion<T>& at, const T* memory, T* rate,
               Balance<T>& sum) const
    {
        const bool back = at.v < T(0.0);
        const T rounded = size(at.v, rounding * e.velocity), went = back ? -rounded : rounded;
        const T held = (back ? -1.0 : 1.0) / limit(c[4], at.v * c[5]);
        T carried = T(0.0);
        std::array<T, elements> left;
        for (std::size_t k = 0; k < elements; ++k) {
            const T s = memory[k] * held;
            const T share = s < T(0.0) ? (1.0 - 2.0 * c[2]) * s : s;
            left[k] = 1.0 - share * (1.0 + c[1] * (s * s - 1.0));
            carried += memory[k];
        }
        raise(left, c[3]);
        for (std::size_t k = 0; k < elements; ++k)
            rate[k] = (at.v - went * (1.0 - left[k])) * c[reaches + k];
        sum.force -= c[0] * carried;
    }

private:
    static constexpr int elements = 4, reaches = 6;  // coefficients before those of the reaches
    static constexpr double rounding = 0.001;        // of the visited velocity

    template <class T>
    static T size(const T& v, double width)
    {
        T positive = v < T(0.0) ? -v : v;
        if (positive > T(width))
            return positive;
        const T s = positive * (1.0 / width);
        return width * s * s * (3.0 - 3.0 * s + s * s);
    }

    using Powers = Eigen::Array<double, elements, 1>;
    // What is left of the limit, below which its powers are on a parabola to zero with the same value and slope, and
    // beyond zero on its tangent: a power has no slope there, or no end of it.
    static constexpr double nearLimit = 0.02;

    /// left^exponent with its slopes by both, of all elements at once, as powers are dear.
    struct Raised {
        Powers value, byLeft, byExponent;

        Raised(const Powers& left, double exponent)
        {
            const Powers above = left.max(nearLimit), logs = above.log();
            value = (exponent * logs).exp();
            byLeft = exponent * value / above;
            byExponent = value * logs;
            for (Eigen::Index k = 0; k < elements; ++k) {
                if (!(left[k] < nearLimit))
                    continue;
                const double s = left[k] / nearLimit, end = value[k], bent = s > 0.0 ? s * s : 0.0,
                             bentSlope = s > 0.0 ? 2.0 * s : 0.0;
                value[k] = end * ((2.0 - exponent) * s + (exponent - 1.0) * bent);
                byLeft[k] = end * (2.0 - exponent + (exponent - 1.0) * bentSlope) / nearLimit;
                byExponent[k] = value[k] * logs[k] + end * (bent - s);
            }
        }
    };

    static void raise(std::array<double, elements>& left, double exponent)
    {
        if (exponent == 1.0)
            return;
        Eigen::Map<Powers> values(left.data());
        values = Raised(values, exponent).value;
    }
    template <int slopes>
    static void raise(std::array<ceres::Jet<double, slopes>, elements>& left,
                      const ceres::Jet<double, slopes>& exponent)
    {
        if (exponent.a == 1.0 && exponent.v.isZero(0.0))
            return;
        Powers values;
        for (std::size_t k = 0; k < elements; ++k)
            values[static_cast<Eigen::Index>(k)] = left[k].a;
        const Raised raised(values, exponent.a);
        for (std::size_t k = 0; k < elements; ++k) {
            const auto at = static_cast<Eigen::Index>(k);
            left[k].a = raised.value[at];
            left[k].v = raised.byLeft[at] * left[k].v + raised.byExponent[at] * exponent.v;
        }
    }

    /// G, of the speed in units of v_s.
    template <class T>
    static T limit(const T& stick, const T& speed)
    {
        using std::exp;
        constexpr double nothing = 20.0;  // exp(-20)
        const T square = speed * speed;
        return square < T(nothing) ? 1.0 + stick * exp(-square) : T(1.0);
    }
};

}  // namespace

const Effect& friction()
{
    static const Friction effect;
    return effect;
}

}  // namespace excursion
