// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Linear/RootDistance.h"

#include "Engine/Linear/Response.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace excursion {
namespace {

constexpr double turn = 2.0 * std::numbers::pi;

/// A root turned by the angle between the nearer ray and the upper half of the imaginary axis: then it lies Im along,
/// and Re aside.
std::complex<double> alongRay(std::complex<double> root, double alpha)
{
    const std::complex<double> upper(root.real(), std::abs(root.imag()));
    return alpha == 1.0 ? upper : upper * std::polar(1.0, 0.25 * turn * (1.0 - alpha));
}

}  // namespace

double nearestFrequency(std::complex<double> root, double sampleRate, double alpha)
{
    if (sampleRate > 0.0)
        return std::abs(std::arg(1.0 + root)) / turn * sampleRate;
    const double along = alongRay(root, alpha).imag();
    return along > 0.0 ? std::pow(along, 1.0 / alpha) / turn : 0.0;
}

RootDistance distanceToBand(std::complex<double> root, double sampleRate, double low, double high, double alpha)
{
    RootDistance distance {std::numeric_limits<double>::infinity(), 0.0};
    for (const double f : {low, high}) {
        const auto point = evaluationPoint(f, sampleRate, alpha);
        for (const double d : {std::abs(point - root), std::abs(std::conj(point) - root)}) {
            distance.least = std::min(distance.least, d);
            distance.most = std::max(distance.most, d);
        }
    }
    const double f = nearestFrequency(root, sampleRate, alpha);
    if (sampleRate == 0.0) {
        if (f >= low && f <= high)
            distance.least = std::abs(alongRay(root, alpha).real());
        return distance;
    }
    const double radius = std::abs(1.0 + root), across = 0.5 * sampleRate - f;
    if (f >= low && f <= high)  // 1 - |z|, with the digits of a root near 1
        distance.least = std::abs(2.0 * root.real() + std::norm(root)) / (1.0 + radius);
    if (across >= low && across <= high)
        distance.most = 1.0 + radius;
    return distance;
}

}  // namespace excursion
