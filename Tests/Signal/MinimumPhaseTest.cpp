// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Signal/MinimumPhase.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace {

using Complex = std::complex<double>;

/// The largest difference in degrees from the phase of a response in closed form, an octave and more from the ends.
template <class Response>
double worstDegrees(Response response, double step, double low = 10.0, double high = 20000.0)
{
    std::vector<double> frequency, magnitude;
    for (double f = low; f < high; f *= std::exp2(step)) {
        frequency.push_back(f);
        magnitude.push_back(std::abs(response(Complex(0.0, 2 * std::numbers::pi * f))));
    }
    const auto phase = excursion::minimumPhase(frequency, magnitude);
    double worst = 0.0;
    for (std::size_t k = 0; k < frequency.size(); ++k)
        if (frequency[k] > 2 * low && frequency[k] < high / 2)
            worst = std::max(worst,
                             std::abs(phase[k] - std::arg(response(Complex(0.0, 2 * std::numbers::pi * frequency[k]))))
                                 * 180 / std::numbers::pi);
    return worst;
}

}  // namespace

TEST_CASE("The minimum phase of a magnitude is that of poles and zeros in the left half plane", "[import]")
{
    CHECK(worstDegrees([](Complex s) { return s * 1e-3; }, 1.0 / 12) < 1e-9);  // a power of f is exact
    CHECK(worstDegrees([](Complex s) { return 5.0 / (s * s); }, 1.0 / 12) < 1e-9);
    CHECK(worstDegrees([](Complex) { return Complex(7.0); }, 1.0 / 3) < 1e-9);
    const auto loudspeaker = [](Complex s) { return 6.0 + s * 0.5e-3 + 36.0 / (1.5 + s * 0.015 + 1500.0 / s); };
    CHECK(worstDegrees(loudspeaker, 1.0 / 24) < 2.5);
    CHECK(worstDegrees(loudspeaker, 1.0 / 96) < 2.5);
    CHECK(worstDegrees(loudspeaker, 1.0 / 500) < 2.5);  // more points than the integral takes
    CHECK(worstDegrees([](Complex s) { return 1.0 / (1.0 + s / 2000.0 + s * s / 4e6); }, 1.0 / 24) < 1.5);
}

TEST_CASE("What one line at an end is off by does not tilt the phase in the middle")
{
    for (const bool top : {true, false}) {
        std::vector<double> frequency, magnitude;
        for (double f = 20.0; f < 20000.0; f *= std::exp2(1.0 / 24.0)) {
            frequency.push_back(f);
            magnitude.push_back(1.0);
        }
        (top ? magnitude.back() : magnitude.front()) = 1.06;  // 0.5 dB
        const auto phase = excursion::minimumPhase(frequency, magnitude);
        for (std::size_t k = 0; k < frequency.size(); ++k)
            if (frequency[k] > 300.0 && frequency[k] < 1500.0)
                CHECK(std::abs(phase[k]) < 0.02);
    }
}
