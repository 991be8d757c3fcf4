// SPDX-License-Identifier: GPL-3.0-or-later
#include "Predistortion/Drivers.h"

#include "Engine/Error.h"
#include "Engine/Predistortion/Oversampling.h"

#include <catch2/catch.hpp>

using namespace excursion;

namespace {

std::vector<double> sine(std::size_t length, double frequency)
{
    std::vector<double> x(length);
    for (std::size_t n = 0; n < length; ++n)
        x[n] = std::sin(2.0 * std::numbers::pi * frequency * static_cast<double>(n));
    return x;
}

std::vector<double> up(Oversampling& filter, const std::vector<double>& x)
{
    const auto factor = static_cast<std::size_t>(filter.factor());
    std::vector<double> y(x.size() * factor);
    for (std::size_t n = 0; n < x.size(); n += 64)
        filter.up(x.data() + n, std::min<std::size_t>(64, x.size() - n), y.data() + n * factor);
    return y;
}

std::vector<double> down(Oversampling& filter, const std::vector<double>& y)
{
    const auto factor = static_cast<std::size_t>(filter.factor());
    std::vector<double> x(y.size() / factor);
    for (std::size_t n = 0; n < x.size(); n += 64)
        filter.down(y.data() + n * factor, std::min<std::size_t>(64, x.size() - n), x.data() + n);
    return x;
}

}  // namespace

TEST_CASE("Up and down again is a delay by the latency, up to 0.45 of the rate", "[oversampling]")
{
    for (const int factor : {1, 2, 4})
        for (const double frequency : {0.001, 0.1, 0.3, 0.44}) {
            INFO(factor << " times, " << frequency);
            Oversampling filter(factor);
            const auto x = sine(2048, frequency);
            const auto y = down(filter, up(filter, x));
            double worst = 0.0;
            for (std::size_t n = 512; n < x.size(); ++n)
                worst = std::max(worst, std::abs(y[n] - x[n - static_cast<std::size_t>(filter.latency())]));
            CHECK(worst < (factor == 1 ? 1e-15 : 2e-5));
        }
}

TEST_CASE("The way up adds no images, the way down no aliases", "[oversampling]")
{
    for (const int factor : {2, 4}) {
        Oversampling filter(factor);
        const auto wide = up(filter, sine(2048, 0.2));
        // What was asked for, at the higher rate: the same sine, delayed by what only a fit can tell.
        double c = 0.0, s = 0.0, power = 0.0;
        const std::size_t from = 512 * static_cast<std::size_t>(factor), count = wide.size() - from;
        for (std::size_t n = from; n < wide.size(); ++n) {
            const double phase = 2.0 * std::numbers::pi * 0.2 / factor * static_cast<double>(n);
            c += wide[n] * std::cos(phase) * 2.0 / static_cast<double>(count);
            s += wide[n] * std::sin(phase) * 2.0 / static_cast<double>(count);
            power += wide[n] * wide[n] * 2.0 / static_cast<double>(count);
        }
        CHECK(std::hypot(c, s) == Approx(1.0).margin(1e-3));
        std::vector<double> rest;
        for (std::size_t n = from; n < wide.size(); ++n) {
            const double phase = 2.0 * std::numbers::pi * 0.2 / factor * static_cast<double>(n);
            rest.push_back(wide[n] - c * std::cos(phase) - s * std::sin(phase));
        }
        CHECK(rms(rest) < 2e-3);  // the fit of a stretch that is no whole number of periods
        filter.reset();
        for (const double frequency : {0.56, 0.8, 0.95}) {  // of the lower rate
            const auto folded = down(filter, sine(2048 * static_cast<std::size_t>(factor), frequency / factor));
            CHECK(rms({folded.begin() + 512, folded.end()}) < 1e-5);
            filter.reset();
        }
    }
}

TEST_CASE("Oversampling by anything else is refused", "[oversampling]")
{
    for (const int factor : {-1, 0, 3, 8})
        CHECK_THROWS_AS(Oversampling(factor), Error);
}
