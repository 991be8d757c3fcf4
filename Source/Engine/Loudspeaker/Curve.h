// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Effect.h"

#include <array>
#include <cmath>
#include <string>
#include <type_traits>

namespace excursion {

/// A smooth curve that is zero at rest,
///     c(q) = sum_{k=1..n} c_k [T_k(q/Q) - T_k(0)],   |q| <= Q,
/// with Chebyshev polynomials T_k, which keep the fit well conditioned at any useful degree. Beyond the visited range Q
/// the curve keeps its end value, because a polynomial is not valid where nothing was measured, unless the physics says
/// how it continues (see beyond). Coefficients are those of the monomials in q/Q, from degree 0 upwards (n + 1 of
/// them).
namespace curve {

inline constexpr int maximumDegree = 26;

/// Monomial coefficients b_0..b_n of sum c_k [T_k - T_k(0)], by the recurrence T_{k+1} = 2 s T_k - T_{k-1}.
template <class T>
void prepare(int n, const T* c, T* b)
{
    std::array<double, maximumDegree + 1> before {1.0}, now {0.0, 1.0}, next {};
    for (int j = 0; j <= n; ++j)
        b[j] = T(0.0);
    for (int k = 1; k <= n; ++k) {
        for (int j = 1; j <= k; ++j)
            if (now[static_cast<std::size_t>(j)] != 0.0)
                b[j] += now[static_cast<std::size_t>(j)] * c[k - 1];
        next.fill(0.0);
        for (int j = 0; j <= k && j < maximumDegree; ++j)
            next[static_cast<std::size_t>(j) + 1] = 2.0 * now[static_cast<std::size_t>(j)];
        for (int j = 0; j <= k; ++j)
            next[static_cast<std::size_t>(j)] -= before[static_cast<std::size_t>(j)];
        before = now;
        now = next;
    }
}

/// A polynomial of degree n with its first two derivatives by s, by Horner's scheme.
struct Bend {
    double value, slope, curvature;
};
[[gnu::always_inline]] inline Bend bendAt(int n, const Tangent* b, double s)
{
    double value = b[n].a, slope = 0.0, half = 0.0;
    for (int j = n - 1; j >= 0; --j) {
        half = half * s + slope;
        slope = slope * s + value;
        value = value * s + b[j].a;
    }
    return {value, slope, 2.0 * half};
}

/// What is `value` at q and has this slope there, on numbers that carry derivatives.
[[gnu::always_inline]] inline Tangent along(double value, double slope, const Tangent& q)
{
    return Tangent(value, slope * q.v);
}

/// A polynomial of degree n, by Horner's scheme. The chain rule is applied once, to the result and not at every step of
/// the scheme, which takes a third of the time. On Tangent coefficients depend neither on time nor on the current; on
/// Jet they have slopes of their own.
template <class T>
[[gnu::always_inline]] inline T polynomial(int n, const T* b, const T& s)
{
    if constexpr (std::is_same_v<T, Tangent>) {
        const auto bend = bendAt(n, b, s.a);
        return along(bend.value, bend.slope, s);
    } else if constexpr (std::is_same_v<T, Jet>) {
        T value = b[n];
        double slope = 0.0;
        for (int j = n - 1; j >= 0; --j) {
            slope = slope * s.a + value.a;
            value = value * s.a + b[j];
        }
        value.v += slope * s.v;
        return value;
    } else {
        T value = b[n];
        for (int j = n - 1; j >= 0; --j)
            value = value * s + b[j];
        return value;
    }
}

template <class T>
struct ValueAndSlope {
    T value, slope;  ///< slope with respect to q
};

/// Horner's scheme for the value and the slope at q. Inlined into its caller, so that it is compiled for the same
/// processor.
template <class T>
[[gnu::always_inline]] inline ValueAndSlope<T> at(int n, const T* b, const T& q, double range)
{
    T s = q * (1.0 / range);
    const bool outside = s > T(1.0) || s < T(-1.0);
    if (outside)
        s = s > T(0.0) ? T(1.0) : T(-1.0);
    if constexpr (std::is_same_v<T, Tangent>) {  // see polynomial()
        const auto bend = bendAt(n, b, s.a);
        return {along(bend.value, bend.slope, s),
                outside ? T(0.0) : along(bend.slope * (1.0 / range), bend.curvature * (1.0 / range), s)};
    }
    T value = b[n];
    T slope = T(0.0);
    if constexpr (std::is_same_v<T, Jet>) {
        double half = 0.0;  // of the curvature
        for (int j = n - 1; j >= 0; --j) {
            half = half * s.a + slope.a;
            slope = slope * s.a + value;
            value = value * s.a + b[j];
        }
        value.v += slope.a * s.v;
        slope.v += 2.0 * half * s.v;
    } else {
        for (int j = n - 1; j >= 0; --j) {
            slope = slope * s + value;
            value = value * s + b[j];
        }
    }
    return {value, outside ? T(0.0) : slope * (1.0 / range)};
}

/// The value at q alone.
template <class T>
[[gnu::always_inline]] inline T valueOn(int n, const T* b, const T& q, double range)
{
    T s = q * (1.0 / range);
    if (s > T(1.0) || s < T(-1.0))
        s = s > T(0.0) ? T(1.0) : T(-1.0);
    return polynomial(n, b, s);
}

/// The continuation of a curve beyond the visited range, from its end value. Its first two terms, which are determined
/// best, extend it:
///     max(0, c_1 (T_1(s) - T_1(+-1)) + c_2 (T_2(s) - T_2(1))),   1 < |s| <= 2,   s = q/Q,
/// and from twice the range on it is constant. A law that hardens continues to harden. It never softens where nothing
/// was measured.
template <class T>
[[gnu::always_inline]] inline T beyond(const T& c1, const T& c2, const T& q, double range)
{
    T s = q * (1.0 / range);
    if (s > T(2.0) || s < T(-2.0))
        s = s > T(0.0) ? T(2.0) : T(-2.0);
    if (!(s > T(1.0) || s < T(-1.0)))
        return T(0.0);
    const T rise = c1 * (s - (s > T(0.0) ? 1.0 : -1.0)) + 2.0 * c2 * (s * s - 1.0);
    return rise > T(0.0) ? rise : T(0.0);
}

inline double valueAt(int n, const double* c, double q, double range)
{
    std::array<double, maximumDegree + 1> b {};
    prepare(n, c, b.data());
    return at(n, b.data(), q, range).value;
}

/// The plausible size of a coefficient of degree k: the coefficients of a smooth law fall geometrically. This weak
/// prior yields to any data, but keeps the ends of the range, where a record has little data, from running off.
inline double plausible(int k, double scale) { return 2.0 * std::abs(scale) * std::pow(0.75, k); }

/// The n coefficients c_1..c_n as parameters, all strengths.
inline std::vector<Parameter> parameters(const OperatingRange& operatingRange, const std::string& unit)
{
    std::vector<Parameter> result;
    for (int k = 1; k <= operatingRange.degree; ++k) {
        Parameter p;
        p.name = "c" + std::to_string(k);
        p.unit = unit;
        p.strength = true;
        p.prior = plausible(k, operatingRange.scale);
        result.push_back(p);
    }
    return result;
}

}  // namespace curve

/// An effect that is only a law along one curve. Its parameters are those of the curve, its coefficients those of the
/// monomials. A subclass defines the law and how it uses the curve.
template <class Self>
class CurveLaw : public EffectOf<Self> {
public:
    using EffectOf<Self>::EffectOf;

    std::vector<Parameter> parameters(const OperatingRange& e) const override
    {
        return curve::parameters(e, this->law()->unit);
    }
    int coefficientCount(const OperatingRange& e) const override { return e.degree + 1; }

    template <class T>
    void prepareFor(const OperatingRange& e, const T* p, T* c) const
    {
        curve::prepare(e.degree, p, c);
    }
};

}  // namespace excursion
