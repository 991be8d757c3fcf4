// SPDX-License-Identifier: GPL-3.0-or-later
// A model knows what its fit has played. What a programme holds above that is neither its place nor its correction.
#include "BlackBox/RandomModels.h"

#include "Engine/BlackBox/RateConverter.h"
#include "Engine/BlackBox/RegionLimiter.h"

#include <catch2/catch.hpp>

#include <algorithm>

using namespace excursion;

namespace {

constexpr double rate = 48000.0;

/// The box with a resonance far above its stimulus, which the nonlinearity sees, as a fit that nothing tells of that
/// band may find one.
BlackBox withAccident(const BlackBox& box)
{
    const double w = 2.0 * std::numbers::pi * 19000.0 / rate, radius = 0.995;
    const auto n = box.linear.A.rows(), seen = box.seen();
    auto result = box;
    result.linear.A = Eigen::MatrixXd::Zero(n + 2, n + 2);
    result.linear.A.topLeftCorner(n, n) = box.linear.A;
    result.linear.A.bottomRightCorner(
        2, 2) = radius * Eigen::Matrix2d {{std::cos(w), -std::sin(w)}, {std::sin(w), std::cos(w)}};
    const auto longer = [](Eigen::MatrixXd M) {
        M.conservativeResizeLike(Eigen::MatrixXd::Zero(M.rows() + 2, M.cols()));
        return M;
    };
    result.linear.B = longer(box.linear.B);
    result.linear.B(n, 0) = box.linear.B.norm();
    result.linear.C = longer(box.linear.C.transpose()).transpose();
    result.S = Eigen::MatrixXd::Zero(seen + 2, n + 2);
    result.S.topLeftCorner(seen, n) = box.S;
    result.S.bottomRightCorner(2, 2).setIdentity();
    result.T = longer(box.T);
    result.E = longer(box.E);
    result.G = longer(box.G);
    result.exponents = Exponents::Zero(box.exponents.rows(), seen + 3);
    result.exponents.leftCols(seen) = box.exponents.leftCols(seen);
    result.exponents.rightCols(1) = box.exponents.rightCols(1);
    return result;
}

/// The least factor under a programme.
double leastFactor(const BlackBox& box, const std::vector<double>& programme)
{
    RegionLimiter limiter(box, visitedBy(box), rate);
    double least = 1.0;
    for (const double sample : programme)
        least = std::min(least, limiter.step(sample));
    return least;
}

}  // namespace

TEST_CASE("Hiss above what a fit has played does not turn a black box down", "[protection]")
{
    const auto stimulus = pinkStimulus(1.5);
    const auto box = withAccident(boxOf(randomPnlss(11, rate, stimulus), stimulus));
    REQUIRE(box.isValid());
    const auto music = playedAs(stimulus, rate, 16384, 3);
    std::vector<double> quiet, hissing;
    for (std::size_t n = 0; n < music.size(); ++n) {
        const double fade = std::min(1.0, static_cast<double>(n) / 4000.0);
        quiet.push_back(0.5 * fade * music[n]);
        hissing.push_back(0.5 * fade * music[n]
                          + 0.3 * fade * std::sin(2.0 * std::numbers::pi * 19000.0 * static_cast<double>(n) / rate));
    }
    CHECK(leastFactor(box, quiet) == 1.0);
    CHECK(leastFactor(box, hissing) == 1.0);
    // what it does know counts as before
    auto loud = music;
    for (auto& sample : loud)
        sample *= 2.0;
    CHECK(leastFactor(box, loud) < 0.7);
}

TEST_CASE("A converter leaves out what its listener does not know, and keeps the rest in its place", "[rates]")
{
    for (const double to : {48000.0, 44100.0, 24000.0}) {
        constexpr double highest = 3000.0;
        // Largest difference of what comes out from the same tone, at the times of the outputs.
        const auto apart = [&](double frequency, double gain) {
            RateConverter converter(rate, to, highest);
            const double w = 2.0 * std::numbers::pi * frequency;
            double worst = 0.0;
            int out = 0;
            for (int n = 0; n < 9600; ++n) {
                converter.push(std::sin(w * n / rate));
                for (double y = 0.0; converter.pull(y); ++out)
                    if (out > converter.reach())
                        worst = std::max(worst, std::abs(y - gain * std::sin(w * out / to)));
            }
            return worst;
        };
        INFO(to);
        for (const double f : {20.0, 1000.0, 3000.0})
            CHECK(apart(f, 1.0) < 1e-4);
        for (const double f : {6000.0, 9000.0, 20000.0})
            CHECK(apart(f, 0.0) < 5e-5);
    }
    CHECK(RateConverter(48000.0, 48000.0, 20000.0).reach() == 0);
}
