// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Design/StrokeLimits.h"

#include "Engine/Loudspeaker/Dynamics.h"
#include "Engine/Loudspeaker/Laws.h"
#include "Engine/Loudspeaker/Resonance.h"
#include "Engine/Numerics/LuFactors.h"
#include "Engine/Take/Air.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

namespace excursion {
namespace {

constexpr int points = 401;  // of a law over the range, odd: rest is one of them

/// A curve over [-X, X], given at equally spaced places.
struct Curve {
    std::vector<double> x, y, error;  ///< error: standard error of y, NaN unknown
    std::size_t rest() const { return x.size() / 2; }
};

std::optional<Curve> lawAlongX(const Model& model, std::string_view base)
{
    for (const auto& law : laws(model, points))
        if (law.info.base == base && law.info.argument == "x") {
            Curve curve {law.argument, law.value, {}};
            for (const double halfWidth : law.halfWidth)
                curve.error.push_back(halfWidth / 1.96);
            return curve;
        }
    return std::nullopt;
}

/// The first place from rest to one side where the curve passes a value, between two points by a straight line.
std::optional<double> crossing(const Curve& c, double value, int side)
{
    auto k = static_cast<int>(c.rest());
    for (int next = k + side; next >= 0 && next < static_cast<int>(c.x.size()); k = next, next += side) {
        const auto a = static_cast<std::size_t>(k), b = static_cast<std::size_t>(next);
        if ((c.y[a] - value) * (c.y[b] - value) <= 0.0 && c.y[a] != c.y[b])
            return c.x[a] + (value - c.y[a]) / (c.y[b] - c.y[a]) * (c.x[b] - c.x[a]);
    }
    return std::nullopt;
}

/// @param threshold  %, on a curve in %
StrokeLimit limitOf(const Curve& percent, double threshold, std::string name, std::string criterion)
{
    StrokeLimit limit {std::move(name), std::move(criterion), {}, {}, percent.y.front(), percent.y.back()};
    if (const auto x = crossing(percent, threshold, -1))
        limit.inward = -*x;
    limit.outward = crossing(percent, threshold, +1);
    return limit;
}

/// 100 y/y(0), or its reciprocal.
Curve inPercent(Curve curve, bool reciprocal)
{
    const double rest = curve.y[curve.rest()];
    for (auto& y : curve.y)
        y = 100.0 * (reciprocal ? rest / y : y / rest);
    return curve;
}

/// Impedance of the coil held fast at x, for small currents: with the rates of current and memories (i, m) linear in
/// them,
///     1/Z = (1 0 ...) (j w I - A)^-1 B.
std::complex<double> blockedImpedance(const Model& model, const Dynamics<double>& dynamics, double x, double frequency)
{
    // what the take visited, once there is an effect
    const double small = 1e-3 * model.components.back().operatingRange.current;
    const auto order = static_cast<std::size_t>(dynamics.order());
    std::vector<std::size_t> states {0};
    for (std::size_t k = 3; k < order; ++k)
        states.push_back(k);
    const auto n = static_cast<Eigen::Index>(states.size());
    const auto rates = [&](std::size_t state, double value, double u) {
        std::vector<double> z(order, 0.0), dz(order, 0.0);
        z[1] = x;
        z[state] += value;
        dynamics.rates(z.data(), u, dz.data());
        return dz;
    };
    // A difference to both sides is exact for what is linear, and leaves third powers of a small current where it is
    // not.
    Eigen::MatrixXcd system(n, n);
    Eigen::VectorXcd drive(n);
    const auto above = rates(1, 0.0, 1.0), below = rates(1, 0.0, -1.0);
    for (Eigen::Index r = 0; r < n; ++r)
        drive[r] = 0.5 * (above[states[static_cast<std::size_t>(r)]] - below[states[static_cast<std::size_t>(r)]]);
    for (Eigen::Index c = 0; c < n; ++c) {
        const auto state = states[static_cast<std::size_t>(c)];
        const auto up = rates(state, small, 0.0), down = rates(state, -small, 0.0);
        for (Eigen::Index r = 0; r < n; ++r) {
            const auto row = states[static_cast<std::size_t>(r)];
            system(r, c) = -(up[row] - down[row]) / (2.0 * small);
        }
    }
    system.diagonal().array() += std::complex<double>(0.0, 2.0 * std::numbers::pi * frequency);
    return 1.0 / ComplexLu(system).solve(drive)[0];
}

/// |Z(x) - Z(0)| over |Z(0)|, %; empty where no effect moves it.
std::optional<Curve> impedanceChange(const Model& model, double range, double frequency)
{
    std::vector<double> values;
    for (const auto* p : parametersOf(model))
        values.push_back(p->value);
    const Dynamics<double> dynamics(model, values);
    const auto rest = blockedImpedance(model, dynamics, 0.0, frequency);
    Curve curve;
    constexpr int coarse = 41;
    for (int n = 0; n < coarse; ++n) {
        curve.x.push_back(range * (2.0 * n / (coarse - 1) - 1.0));
        curve.y.push_back(100.0 * std::abs(blockedImpedance(model, dynamics, curve.x.back(), frequency) - rest)
                          / std::abs(rest));
    }
    constexpr double something = 0.1;  // %
    if (*std::max_element(curve.y.begin(), curve.y.end()) < something)
        return std::nullopt;
    return curve;
}

/// Standard error of the place where the curve has a value, from that of its height and its slope there.
double placeError(const Curve& c, double x)
{
    const double step = c.x[1] - c.x[0];
    const auto k = std::clamp<std::size_t>(static_cast<std::size_t>(std::lround((x - c.x.front()) / step)), 1,
                                           c.x.size() - 2);
    return c.error[k] * 2.0 * step / std::abs(c.y[k + 1] - c.y[k - 1]);
}

std::optional<Estimate> offsetOf(const Curve& Bl)
{
    const double level = std::max(Bl.y.front(), Bl.y.back());
    const double most = *std::max_element(Bl.y.begin(), Bl.y.end());
    if (!(most > level))
        return std::nullopt;
    const bool outwardEnd = Bl.y.back() >= Bl.y.front();
    const double end = outwardEnd ? Bl.x.back() : Bl.x.front();
    // From the other end inward: the outermost place on that side.
    std::optional<double> place;
    for (std::size_t n = 0; n + 1 < Bl.x.size() && !place; ++n) {
        const auto a = outwardEnd ? n : Bl.x.size() - 1 - n, b = outwardEnd ? n + 1 : Bl.x.size() - 2 - n;
        if (Bl.y[a] <= level && Bl.y[b] > level)
            place = Bl.x[a] + (level - Bl.y[a]) / (Bl.y[b] - Bl.y[a]) * (Bl.x[b] - Bl.x[a]);
    }
    if (!place)
        return std::nullopt;
    return Estimate {0.5 * (end + *place), 0.5 * std::hypot(placeError(Bl, end), placeError(Bl, *place))};
}

Estimate asymmetryOf(const Curve& K)
{
    const double in = K.y.front(), out = K.y.back(), sum = in + out;
    return {200.0 * (in - out) / sum, 400.0 * std::hypot(out * K.error.front(), in * K.error.back()) / (sum * sum)};
}

}  // namespace

std::optional<double> StrokeLimit::stroke() const
{
    if (inward && outward)
        return std::min(*inward, *outward);
    return inward ? inward : outward;
}

const StrokeLimit* StrokeLimits::tightest() const
{
    const StrokeLimit* best = nullptr;
    for (const auto& limit : limits)
        if (limit.stroke() && (!best || *limit.stroke() < *best->stroke()))
            best = &limit;
    return best;
}

StrokeLimits strokeLimits(const Model& model)
{
    StrokeLimits result;
    for (const auto& component : model.components)
        if (const auto law = component.effect->law(); law && law->argument == "x")
            result.range = std::max(result.range, component.operatingRange.displacement);
    if (result.range == 0.0)
        for (const auto& component : model.components)
            result.range = std::max(result.range, component.operatingRange.displacement);
    constexpr double toneOverResonance = 8.5;
    result.resonance = resonanceOf(model);
    result.tone = toneOverResonance * result.resonance;

    if (const auto Bl = lawAlongX(model, "Bl")) {
        result.limits.push_back(limitOf(inPercent(*Bl, false), 82.0, "force factor Bl(x)", "falls to 82 %"));
        result.gapCentre = offsetOf(*Bl);
    }
    if (const auto K = lawAlongX(model, "K")) {
        result.limits.push_back(limitOf(inPercent(*K, true), 75.0, "compliance 1/K(x)", "falls to 75 %"));
        result.stiffnessAsymmetry = asymmetryOf(*K);
    }
    if (model.electrical())
        if (const auto change = impedanceChange(model, result.range, result.tone))
            result.limits.push_back(limitOf(*change, 10.0, "impedance", "changes by 10 %"));

    // A tone f carried by a peak excursion X has two sidebands of pi f X/c each (their rms sum is the distortion).
    constexpr double allowed = 0.1;
    const double percentPerMetre = 100.0 * std::numbers::sqrt2 * std::numbers::pi * result.tone / speedOfSound;
    const double X = 100.0 * allowed / percentPerMetre, atEnd = percentPerMetre * result.range;
    StrokeLimit doppler {"Doppler shift", "makes 10 % distortion", {}, {}, atEnd, atEnd};
    doppler.inward = doppler.outward = X;  // geometry: it holds beyond the range, too
    result.limits.push_back(doppler);
    return result;
}

}  // namespace excursion
