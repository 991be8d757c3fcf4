// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/Curve.h"
#include "Engine/Loudspeaker/Effects/Effects.h"

#include <array>
#include <cmath>
#include <string>
#include <type_traits>

namespace excursion {
namespace {

/// Flux modulation: the coil's flux is (Le + c(i) g(x)) i, so that at rest Le(i) = Le + c(i) is flux per current and
/// what the voltage sees is
///     d(phi)/di = Le + g (c + i dc/di).
/// An even law saturates the iron; an odd one is the field of the coil that adds to the magnet's or takes from it. Iron
/// that the coil has left has less to saturate:
///     g(x) = 1 + sum_n q_n [T_n(s) - T_n(0)],  s = x/X within the visited range, n = 1 .. 10.
/// Where Le(x, i) is a product of both laws g is Le(x)/Le; where data does not tell, g is 1. It is 1, too, in a model
/// without Le(x), whose work it would do in a wrong shape. What changes with x makes a force, dg/dx int_0^i c j dj.
/// Beyond the visited range the flux goes on with the slope that it has at the end.
class InductanceCurrent final : public EffectOf<InductanceCurrent> {
public:
    InductanceCurrent()
        : EffectOf({.id = "inductance-current",
                    .title = "Flux modulation Le(i)",
                    .physics = "The coil's own field drives the iron in and out of saturation, so the inductance "
                               "changes with the current.",
                    .symptoms = "residual voltage that grows with frequency and is scaled by a curve of the current, "
                                "wherever the cone is; hardly any residual force",
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
        return i == 0.0 ? 0.0 : fluxAt(e, b.data(), i).flux / i;
    }

    std::vector<Parameter> parameters(const OperatingRange& e) const override
    {
        auto result = curve::parameters(e, "H");
        for (int n = 1; n <= places; ++n) {
            const double prior = curve::plausible(n, plausiblePlace);
            result.push_back({.name = "q" + std::to_string(n),
                              .unit = "1",
                              .lower = -mostPlace * prior,
                              .upper = mostPlace * prior,
                              .joint = true,
                              .prior = prior});
        }
        return result;
    }
    int coefficientCount(const OperatingRange& e) const override { return e.degree + 1 + places + 1; }

    /// The curve's, then those of the monomials of g - 1.
    template <class T>
    void prepareFor(const OperatingRange& e, const T* p, T* c) const
    {
        curve::prepare(e.degree, p, c);
        curve::prepare(places, p + e.degree, c + e.degree + 1);
    }

    template <class T>
    void addTo(const OperatingRange& e, const T* c, const Motion<T>& at, const T*, T*, Balance<T>& sum) const
    {
        const auto [place, slope] = curve::at(places, c + e.degree + 1, at.x, e.displacement);
        const auto own = fluxAt(e, c, at.i);
        sum.inductance += (1.0 + place) * own.slope;
        sum.fluxSlope += slope * own.flux;
        sum.force += slope * own.coenergy;
    }

private:
    static constexpr int places = 10;
    // While another law is missing, g would do its work with a small c: it is kept from what no iron does.
    static constexpr double plausiblePlace = 0.5, mostPlace = 3.0;

    template <class T>
    struct Flux {
        T flux, slope, coenergy;  ///< c i, c + i dc/di, int_0^i c j dj
    };
    template <class T>
    static Flux<T> fluxAt(const OperatingRange& e, const T* c, const T& i)
    {
        T s = i * (1.0 / e.current), beyond = T(0.0);
        if (s > T(1.0) || s < T(-1.0)) {
            const T end = s > T(0.0) ? T(1.0) : T(-1.0);
            beyond = (s - end) * e.current;
            s = end;
        }
        if constexpr (std::is_same_v<T, Tangent>) {  // see curve::polynomial()
            const double end = s.a, off = beyond.a;
            const auto bend = curve::bendAt(e.degree, c, end);
            double integral = 0.0;
            for (int j = e.degree; j >= 0; --j)
                integral = integral * end + c[j].a * (1.0 / (j + 2));
            const double flux = bend.value * end * e.current, fluxSlope = bend.value + end * bend.slope,
                         fluxCurvature = off == 0.0 ? (2.0 * bend.slope + end * bend.curvature) * (1.0 / e.current)
                                                    : 0.0,
                         fluxBeyond = flux + fluxSlope * off,
                         coenergy = integral * end * end * (e.current * e.current)
                                    + off * (flux + 0.5 * fluxSlope * off);
            return {curve::along(fluxBeyond, fluxSlope, i), curve::along(fluxSlope, fluxCurvature, i),
                    curve::along(coenergy, fluxBeyond, i)};
        }
        if constexpr (std::is_same_v<T, Jet>) {
            const double end = s.a;
            T value = T(0.0), slope = T(0.0), integral = T(0.0);
            double half = 0.0;  // of the curvature
            for (int j = e.degree; j >= 0; --j) {
                half = half * end + slope.a;
                slope = slope * end + value;
                value = value * end + c[j];
                integral = integral * end + c[j] * (1.0 / (j + 2));
            }
            const T flux = value * (end * e.current), fluxSlope = value + end * slope;
            const double off = beyond.a;
            Flux<T> at {flux + fluxSlope * off, fluxSlope,
                        integral * (end * end * e.current * e.current) + off * (flux + 0.5 * off * fluxSlope)};
            const double curvature = off == 0.0 ? 2.0 * (slope.a + end * half) / e.current : 0.0;
            at.coenergy.v += at.flux.a * i.v;
            at.flux.v += fluxSlope.a * i.v;
            at.slope.v += curvature * i.v;
            return at;
        }
        T value = T(0.0), slope = T(0.0), integral = T(0.0);
        for (int j = e.degree; j >= 0; --j) {
            slope = slope * s + value;
            value = value * s + c[j];
            integral = integral * s + c[j] * (1.0 / (j + 2));
        }
        const T flux = value * s * e.current, fluxSlope = value + s * slope;
        return {flux + fluxSlope * beyond, fluxSlope,
                integral * s * s * (e.current * e.current) + beyond * (flux + 0.5 * fluxSlope * beyond)};
    }
};

}  // namespace

const Effect& inductanceCurrent()
{
    static const InductanceCurrent effect;
    return effect;
}

}  // namespace excursion
