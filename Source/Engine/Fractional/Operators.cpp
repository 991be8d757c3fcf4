// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Fractional/Operators.h"

#include "Engine/Error.h"
#include "Engine/Fractional/Gamma.h"
#include "Engine/Signal/Convolution.h"

#include <cmath>
#include <limits>

namespace excursion {
namespace {

void require(bool valid, const char* what)
{
    if (!valid)
        throw Error(Error::Kind::usage, what);
}

/// (n+1)^p - 2 n^p + (n-1)^p; far out by its series, as the difference loses n^2 in digits.
double secondDifference(double n, double p)
{
    if (n < 32.0)
        return std::pow(n + 1.0, p) - 2.0 * std::pow(n, p) + std::pow(n - 1.0, p);
    double term = 0.5 * p * (p - 1.0) / (n * n), sum = 0.0;  // binom(p, 2m) n^-2m
    for (int m = 2; m <= 14; m += 2) {
        sum += term;
        term *= (p - m) * (p - m - 1.0) / ((m + 1.0) * (m + 2.0) * n * n);
    }
    return 2.0 * std::pow(n, p) * sum;
}

/// (n-1)^p - (n - p) n^(p-1): the weight of the first sample.
double firstWeight(double n, double p)
{
    if (n < 32.0)
        return std::pow(n - 1.0, p) - (n - p) * std::pow(n, p - 1.0);
    double term = 0.5 * p * (p - 1.0) / (n * n), sum = 0.0;  // binom(p, m) (-n)^-m, m >= 2
    for (int m = 2; m <= 14; ++m) {
        sum += term;
        term *= -(p - m) / ((m + 1.0) * n);
    }
    return std::pow(n, p) * sum;
}

/// The derivative of order 1 or 2 by differences of second order.
std::vector<double> difference(std::span<const double> f, int order, double T)
{
    const auto N = f.size();
    std::vector<double> d(N);
    for (std::size_t n = 1; n + 1 < N; ++n)
        d[n] = order == 1 ? (f[n + 1] - f[n - 1]) / (2.0 * T) : (f[n + 1] - 2.0 * f[n] + f[n - 1]) / (T * T);
    const auto end = [&](double a, double b, double c, double e, double sign) {
        return order == 1 ? sign * (-3.0 * a + 4.0 * b - c) / (2.0 * T) : (2.0 * a - 5.0 * b + 4.0 * c - e) / (T * T);
    };
    d[0] = end(f[0], f[1], f[2], f[3], 1.0);
    d[N - 1] = end(f[N - 1], f[N - 2], f[N - 3], f[N - 4], -1.0);
    return d;
}

void requireDerivative(std::span<const double> f, double alpha, double interval)
{
    require(alpha > 0.0 && alpha <= 2.0 && interval > 0.0,
            "A fractional derivative needs an order above 0 and at most 2, and an interval above 0 s.");
    if (f.size() < 4)
        throw Error(Error::Kind::data,
                    "A fractional derivative needs 4 samples, but there are " + std::to_string(f.size()) + ".");
}

}  // namespace

std::vector<double> gruenwaldWeights(double alpha, std::size_t count)
{
    std::vector<double> w(count, 1.0);
    for (std::size_t j = 1; j < count; ++j)
        w[j] = w[j - 1] * (static_cast<double>(j) - 1.0 - alpha) / static_cast<double>(j);
    return w;
}

std::vector<double> gruenwaldLetnikov(std::span<const double> f, double alpha, double interval)
{
    require(std::abs(alpha) <= 10.0 && interval > 0.0,
            "A Gruenwald-Letnikov difference needs an order of -10 to 10 and an interval above 0 s.");
    auto result = convolved(gruenwaldWeights(alpha, f.size()), f);
    const double scale = std::pow(interval, -alpha);
    for (auto& y : result)
        y *= scale;
    return result;
}

std::vector<double> fractionalIntegral(std::span<const double> f, double alpha, double interval)
{
    require(alpha > 0.0 && alpha <= 10.0 && interval > 0.0,
            "A fractional integral needs an order above 0 and at most 10, and an interval above 0 s.");
    const auto N = f.size();
    if (N == 0)
        return {};
    std::vector<double> w(N, 1.0);
    for (std::size_t j = 1; j < N; ++j)
        w[j] = secondDifference(static_cast<double>(j), alpha + 1.0);
    // The first sample has half a hat only, and so weights of its own.
    std::vector<double> later(f.begin(), f.end());
    later[0] = 0.0;
    auto result = convolved(w, later);
    const double scale = std::pow(interval, alpha) * reciprocalGamma(alpha + 2.0);
    result[0] = 0.0;
    for (std::size_t n = 1; n < N; ++n)
        result[n] = scale * (result[n] + firstWeight(static_cast<double>(n), alpha + 1.0) * f[0]);
    return result;
}

std::vector<double> caputoDerivative(std::span<const double> f, double alpha, double interval)
{
    requireDerivative(f, alpha, interval);
    const int n = alpha <= 1.0 ? 1 : 2;
    const auto slope = difference(f, n, interval);
    return alpha == n ? slope : fractionalIntegral(slope, n - alpha, interval);
}

std::vector<double> riemannLiouvilleDerivative(std::span<const double> f, double alpha, double interval)
{
    auto result = caputoDerivative(f, alpha, interval);
    const int n = alpha <= 1.0 ? 1 : 2;
    for (int k = 0; k < n; ++k) {
        const double start = (k == 0 ? f[0] : difference(f, 1, interval)[0]) * reciprocalGamma(k + 1.0 - alpha);
        if (start == 0.0)
            continue;
        for (std::size_t i = 0; i < f.size(); ++i)
            result[i] += start * std::pow(static_cast<double>(i) * interval, k - alpha);
    }
    return result;
}

}  // namespace excursion
