// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Signal/MinimumPhase.h"

#include <cmath>
#include <numbers>

namespace excursion {
namespace {

/// The integral of ln coth(|s|/2) from 0 to x >= 0: pi^2/4 - 2 sum over odd n of exp(-n x)/n^2.
double weightUpTo(double x)
{
    constexpr double whole = std::numbers::pi * std::numbers::pi / 4;
    if (x > 40.0)
        return whole;
    if (x < 0.25) {
        // ln coth(s/2) = ln(2/s) + s^2/12 - 7 s^4/1440 + ..
        return x <= 0.0 ? 0.0 : x * (1.0 + std::log(2.0 / x)) + x * x * x / 36 - 7 * x * x * x * x * x / 7200;
    }
    double sum = 0.0;
    for (int n = 1; n < 400; n += 2) {
        const double term = std::exp(-n * x) / (static_cast<double>(n) * n);
        sum += term;
        if (term < 1e-16)
            break;
    }
    return whole - 2.0 * sum;
}

double weight(double from, double to)
{
    const auto signedWeight = [](double x) { return x < 0 ? -weightUpTo(-x) : weightUpTo(x); };
    return signedWeight(to) - signedWeight(from);
}

}  // namespace

std::vector<double> minimumPhase(const std::vector<double>& frequency, const std::vector<double>& magnitude)
{
    std::vector<double> phase(frequency.size(), 0.0);
    std::vector<double> x, g;
    constexpr std::size_t many = 2000;  // beyond that the integral goes over every 48th of an octave
    for (std::size_t k = 0; k < frequency.size(); ++k) {
        const double at = std::log(frequency[k]);
        if (frequency.size() > many && k > 0 && k + 1 < frequency.size() && at - x.back() < std::numbers::ln2 / 48)
            continue;
        x.push_back(at);
        g.push_back(std::log(magnitude[k]));
    }
    const std::size_t points = x.size();
    if (points < 2)
        return phase;
    constexpr double halfOctave = 0.5 * std::numbers::ln2;
    std::size_t first = 1, last = points - 2;
    while (first + 1 < points && x[first] - x[0] < halfOctave)
        ++first;
    while (last > 0 && x[points - 1] - x[last] < halfOctave)
        --last;
    const double below = (g[first] - g[0]) / (x[first] - x[0]),
                 above = (g[points - 1] - g[last]) / (x[points - 1] - x[last]);
    constexpr double farAway = 60.0;  // where the weight has died away
    for (std::size_t k = 0; k < phase.size(); ++k) {
        const double here = std::log(frequency[k]);
        double sum = below * weight(-farAway, x[0] - here) + above * weight(x[points - 1] - here, farAway);
        double before = weight(0.0, x[0] - here);
        for (std::size_t n = 0; n + 1 < points; ++n) {
            const double after = weight(0.0, x[n + 1] - here);
            sum += (g[n + 1] - g[n]) / (x[n + 1] - x[n]) * (after - before);
            before = after;
        }
        phase[k] = sum / std::numbers::pi;
    }
    return phase;
}

}  // namespace excursion
