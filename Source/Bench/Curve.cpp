// SPDX-License-Identifier: GPL-3.0-or-later
#include "Bench/Curve.h"

#include <array>
#include <cmath>
#include <numbers>

namespace excursion::bench {
namespace {

using Shape = Curve::Shape;

Curve::Point evaluate(Shape shape, double y, double a, double e)
{
    switch (shape) {
    case Shape::erfGap:
        return {std::erf(y + e) - std::erf(y - e),
                2.0 * std::numbers::inv_sqrtpi * (std::exp(-(y + e) * (y + e)) - std::exp(-(y - e) * (y - e)))};
    case Shape::logisticGap: {
        const double right = 1.0 / (1.0 + std::exp(y - e)), left = 1.0 / (1.0 + std::exp(-y - e));
        return {left * right, left * right * (right - left)};
    }
    case Shape::quarticGap: {
        const double f = 1.0 / (1.0 + y * y * y * y);
        return {f, -4.0 * y * y * y * f * f};
    }
    case Shape::gaussianGap: {
        const double f = std::exp(-y * y);
        return {f, -2.0 * y * f};
    }
    case Shape::coshSpring: {
        const double up = std::exp(y), down = 1.0 / up;
        return {0.5 * (up + down), 0.5 * (up - down)};
    }
    case Shape::expSpring: {
        const double root = std::sqrt(y * y + e * e), f = std::exp(root);
        return {f, f * y / root};
    }
    case Shape::rationalSpring: {
        const double below = 1.0 / (1.0 + e * y * y);
        return {(1.0 + y * y) * below, 2.0 * y * (1.0 - e) * below * below};
    }
    case Shape::skewedSpring: {
        const double up = std::exp(y), down = std::exp(-e * y);
        return {0.5 * (up + down), 0.5 * (up - e * down)};
    }
    case Shape::tanhStep: {
        const double t = std::tanh(y);
        return {1.0 - a * t, -a * (1.0 - t * t)};
    }
    case Shape::arctanStep:
        return {1.0 - a * 2.0 * std::numbers::inv_pi * std::atan(y), -a * 2.0 * std::numbers::inv_pi / (1.0 + y * y)};
    case Shape::rootStep: {
        const double inverse = 1.0 / std::sqrt(1.0 + y * y);
        return {1.0 - a * y * inverse, -a * inverse * inverse * inverse};
    }
    case Shape::saturation: {
        const double inverse = 1.0 / std::sqrt(1.0 + y * y);
        return {inverse, -y * inverse * inverse * inverse};
    }
    case Shape::rootDrag: {
        const double root = std::sqrt(1.0 + y * y);
        return {1.0 + a * (root - 1.0), a * y / root};
    }
    case Shape::powerDrag: {
        const double size = std::abs(y);
        if (size < 1e-100)
            return {1.0, 0.0};
        const double p = std::pow(size, e), below = 1.0 / (1.0 + p);
        return {1.0 + a * p * below, a * e * p / y * below * below};
    }
    case Shape::tanhDrag: {
        const double t = std::tanh(y * y);
        return {1.0 + a * t, 2.0 * a * y * (1.0 - t * t)};
    }
    }
    return {1.0, 0.0};
}

bool hasAmount(Shape shape) { return shape >= Shape::tanhStep && shape != Shape::saturation; }

}  // namespace

Curve::Point Curve::at(double y) const { return evaluate(shape, y, amount, extra); }

double Curve::value(double q) const { return at((q - centre) / width).value / at(-centre / width).value; }

double Curve::slope(double q) const { return at((q - centre) / width).slope / (width * at(-centre / width).value); }

double Curve::change(double range) const
{
    double largest = 0.0;
    for (int n = -40; n <= 40; ++n)
        largest = std::max(largest, std::abs(value(range * n / 40.0) - 1.0));
    return largest;
}

Curve Curve::scaledTo(double strength, double range) const
{
    Curve curve = *this;
    // Bisection on the logarithm: a larger amount, or a smaller width, always changes more.
    double low = std::log(hasAmount(shape) ? 1e-4 : 0.02 * range),
           high = std::log(hasAmount(shape) ? 20.0 : 1e3 * range);
    for (int n = 0; n < 60; ++n) {
        const double middle = 0.5 * (low + high);
        if (hasAmount(shape))
            curve.amount = std::copysign(std::exp(middle), amount);
        else
            curve.width = std::exp(middle);
        const double reached = curve.change(range);
        const bool more = !(reached < strength);
        (more == hasAmount(shape) ? high : low) = middle;
    }
    return curve;
}

std::string_view name(Shape shape)
{
    static constexpr std::array<std::string_view, 15> names {
        "erf-gap",    "logistic-gap",    "quartic-gap",   "gaussian-gap", "cosh-spring",
        "exp-spring", "rational-spring", "skewed-spring", "tanh-step",    "arctan-step",
        "root-step",  "saturation",      "root-drag",     "power-drag",   "tanh-drag"};
    return names[static_cast<std::size_t>(shape)];
}

}  // namespace excursion::bench
