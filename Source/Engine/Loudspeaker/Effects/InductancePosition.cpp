// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/Curve.h"
#include "Engine/Loudspeaker/Effects/Effects.h"

#include <cmath>
#include <numbers>
#include <string>

namespace excursion {
namespace {

/// Le(x) = Le + c(x), where c is the change of the flux that the coil's position makes and that follows the current at
/// once: inductance c, voltage c' v i, reluctance force 1/2 c' i^2.
///
/// Loops in the iron delay another part. The coil feeds a loop through the mutual inductance M and is fed by it through
/// the same M, which goes with the root of the coil's inductance, M(x)/M(0) = k(x), k^2 = 1 + d c(x). So where the
/// loops at rest are a low-pass G(s) of the current, they are k(x) G[k(x) i] in motion, of which G i belongs to the
/// linear eddy currents. The rest is this effect's,
///     flux    sum_n g_n (k h_n - j_n),   dh_n/dt = p_n (k i - h_n),   dj_n/dt = p_n (i - j_n),
///     force   k' i sum_n g_n h_n,
/// with inductances g_n = s_n/d, s_n >= 0 and d = exp(depth)/Le, where Le is as it was when the effect was sized: what
/// loop n delays changes with x by s_n c(x), and d only tells how that bends. A loop stores g_n h_n^2/2 and loses
/// g_n (dh_n/dt)^2/p_n: terminals and cone get what is left, so nothing is made of nothing. Models that scale the
/// loops' inductances and resistances by a curve instead feed them with k^2 and hear them at 1: `way` w lets data tell,
///     1 + (1 + w)(k - 1) on the way in, 1 + (1 - w)(k - 1) on the way out,   -1 <= w <= 1, 0 for a mutual inductance.
///
/// Without linear eddy currents there are no loops. Beforehand the fastest rate is 0.7 times the band's upper end, as
/// faster loops delay nothing within the band; the slowest is a quarter of its lower end, as the product of motion and
/// current reaches down to 0 Hz; the others are spread evenly between them on a logarithmic scale. The data moves each
/// by a factor exp(r_n): like the nodes of a Gauss rule, free rates do what takes about twice as many fixed ones.
class InductancePosition final : public EffectOf<InductancePosition> {
public:
    InductancePosition()
        : EffectOf({.id = "inductance-position",
                    .title = "Inductance Le(x) with reluctance force",
                    .physics = "The coil sees more iron inward than outward, so its inductance falls with x and the "
                               "iron pulls it in.",
                    .symptoms = "residual voltage that grows with frequency and is scaled by a curve of x; a small "
                                "residual force like the current squared",
                    .remedy = "Shorting rings or a copper cap near the gap flatten Le(x).",
                    .electrical = true,
                    .linear = false})
    {
    }

    std::optional<LawInfo> law() const override { return LawInfo {"Le(x)", "H", "x", "m", "Le"}; }
    double lawAt(const OperatingRange& e, const double* p, double x) const override
    {
        return curve::valueAt(e.degree, p, x, e.displacement);
    }
    /// Im u/(w i) of the loops with the coil held at x: sum_n g_n (in out - 1) p_n^2/(p_n^2 + w^2).
    double delayedLawAt(const OperatingRange& e, const double* p, double x, double frequency) const override
    {
        std::vector<double> c(static_cast<std::size_t>(coefficientCount(e)));
        prepareFor(e, p, c.data());
        const double* loop = c.data() + e.degree + 1;
        const auto at = couplingAt(loop, lawAt(e, p, x), 0.0);
        const double omega = 2.0 * std::numbers::pi * frequency;
        double sum = 0.0;
        for (int n = 0; n < loops; ++n, loop += 2)
            sum += loop[1] * (at.in * at.out - 1.0) / (1.0 + std::pow(omega / loop[0], 2));
        return sum;
    }

    std::vector<Parameter> parameters(const OperatingRange& e) const override
    {
        auto result = curve::parameters(e, "H");
        for (int n = 1; n <= loops; ++n)
            result.push_back({.name = "s" + std::to_string(n),
                              .unit = "1",
                              .lower = 0.0,
                              .upper = 1e3,
                              .relaxed = true,
                              .prior = plausibleShare});
        result.push_back({.name = "depth", .unit = "1", .lower = -3.0, .upper = 3.0, .relaxed = true, .prior = 0.5});
        result.push_back({.name = "way", .unit = "1", .lower = -1.0, .upper = 1.0, .relaxed = true, .prior = 0.5});
        for (int n = 1; n <= loops; ++n)
            result.push_back({.name = "r" + std::to_string(n),
                              .unit = "1",
                              .lower = -farthest,
                              .upper = fastestShift,
                              .relaxed = true,
                              .prior = plausibleShift});
        return result;
    }
    int memorySize(const OperatingRange& e) const override { return e.relaxed ? 2 * loops : 0; }
    int coefficientCount(const OperatingRange& e) const override { return e.degree + 1 + 2 * loops + 2; }

    /// The curve's, then each loop's rate and inductance, d = exp(depth)/Le and w.
    template <class T>
    void prepareFor(const OperatingRange& e, const T* p, T* c) const
    {
        using std::exp;
        curve::prepare(e.degree, p, c);
        double rate = 2.0 * std::numbers::pi * e.highFrequency * fastest;
        const T d = exp(p[e.degree + loops]) / e.scale;
        T* loop = c + e.degree + 1;
        const double spacing = std::pow(fastest * e.highFrequency / (slowest * e.lowFrequency), 1.0 / (loops - 1));
        for (int n = 0; n < loops; ++n, rate /= spacing) {
            *loop++ = rate * exp(p[e.degree + loops + 2 + n]);
            *loop++ = p[e.degree + n] / d;
        }
        *loop++ = d;
        *loop++ = p[e.degree + loops + 1];
    }

    template <class T>
    void addTo(const OperatingRange& e, const T* c, const Motion<T>& at, const T* memory, T* rate,
               Balance<T>& sum) const
    {
        const auto [value, slope] = curve::at(e.degree, c, at.x, e.displacement);
        sum.inductance += value;
        if (!e.relaxed) {
            sum.fluxSlope += slope * at.i;
            sum.force += 0.5 * slope * at.i * at.i;
            return;
        }
        const T* loop = c + e.degree + 1;
        const auto [in, out, outSlope, kSlope] = couplingAt(loop, value, slope);
        T held = T(0.0), delayed = T(0.0);
        for (int n = 0; n < loops; ++n, loop += 2) {
            const T &h = memory[2 * n], &j = memory[2 * n + 1];
            rate[2 * n] = loop[0] * (in * at.i - h);
            rate[2 * n + 1] = loop[0] * (at.i - j);
            held += loop[1] * h;
            delayed += loop[1] * (out * rate[2 * n] - rate[2 * n + 1]);
        }
        sum.fluxSlope += slope * at.i + outSlope * held;
        sum.drop += delayed;
        sum.force += (0.5 * slope * at.i + kSlope * held) * at.i;
    }

private:
    /// Of coil and loops, with the coil at one place.
    template <class T>
    struct Coupling {
        T in, out, outSlope, slope;
    };

    /// @param loop  the coefficients behind the curve's
    template <class T>
    static Coupling<T> couplingAt(const T* loop, const T& value, const T& slope)
    {
        using std::sqrt;
        const T &d = loop[2 * loops], &way = loop[2 * loops + 1];
        // A trial of a search may go where the coil would have no inductance left.
        const T squared = 1.0 + d * value;
        const bool lost = squared < T(leastCoupling * leastCoupling);
        const T k = lost ? T(leastCoupling) : sqrt(squared);
        const T kSlope = lost ? T(0.0) : 0.5 * d * slope / k;
        return {1.0 + (1.0 + way) * (k - 1.0), 1.0 + (1.0 - way) * (k - 1.0), (1.0 - way) * kSlope, kSlope};
    }

    static constexpr int loops = 5;
    static constexpr double fastest = 0.7, slowest = 0.25;  // rates at first, of the band's ends
    static constexpr double plausibleShare = 30.0;  // where the coil is little but a semi-inductance, of slow loops
    // Of a loop's ln rate. A faster loop would ask for shorter steps.
    static constexpr double plausibleShift = 0.8, farthest = 1.5, fastestShift = 1.0;
    static constexpr double leastCoupling = 0.2;
};

}  // namespace

const Effect& inductancePosition()
{
    static const InductancePosition effect;
    return effect;
}

}  // namespace excursion
