// SPDX-License-Identifier: GPL-3.0-or-later
// What of the scatter of periods is noise, and what is drift.
#include "Estimate/LevelsTake.h"

#include "Engine/Estimate/MakeRecord.h"
#include "Engine/Signal/Fft.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

using namespace excursion;
using namespace excursion::levelsTake;

TEST_CASE("The noise of a record is the noise that was added", "[record]")
{
    constexpr double noise = 0.02;
    const auto record = makeRecord(take(1, noise));
    for (const auto& section : record.sections) {
        // E|DFT of white noise|^2 = N sigma^2, less by the number of periods that are averaged.
        const double truth = fold * fold * N * noise * noise / periods;
        double mean = 0.0, meanInput = 0.0;
        const auto [first, last] = record.lineRange(section);
        for (auto k = first; k <= last; ++k) {
            mean += section.deviation[0][k] * section.deviation[0][k] / static_cast<double>(last - first + 1);
            meanInput += section.inputVariance[k] / static_cast<double>(last - first + 1);
        }
        CHECK(mean == Approx(truth).epsilon(0.08));
        CHECK(meanInput == Approx(0.01 * truth).epsilon(0.08));
        // Smoothing leaves no line that is believed to be far better than it is.
        CHECK(*std::min_element(section.deviation[0].begin() + 5, section.deviation[0].begin() + N / 2 - 5)
              > 0.6 * std::sqrt(truth));
        // Where nothing was played the input is silent, not noisy.
        const auto U = fft(section.input);
        double even = 0.0, odd = 0.0;
        for (std::size_t k = 4; k <= 400; k += 2) {
            even += std::norm(U[k]);
            odd += std::norm(U[k + 1]);
        }
        CHECK(even < 1e-8 * odd);
    }
}

TEST_CASE("What drifts is no noise to a model that follows it", "[record]")
{
    constexpr double noise = 1e-4, drift = 0.01;  // of the current, a period
    auto drifting = take(1, noise);
    auto& current = drifting.channels[1].samples;
    for (std::size_t n = 0; n < current.size(); ++n)
        current[n] *= 1.0 + drift * static_cast<double>(n / N % (settle + periods));
    const double truth = fold * std::sqrt(N * noise * noise / periods);
    auto record = makeRecord(drifting);
    const auto& section = record.sections.back();
    const auto lines = [&](const Section& of, double least, double most) {
        for (int k = 3; k <= 401; ++k) {
            const double deviation = of.deviation[0][static_cast<std::size_t>(k)];
            CHECK(deviation > (k % 2 == 1 ? least : 0.5 * truth));
            CHECK(deviation < (k % 2 == 1 ? most : 2.0 * truth));
        }
    };
    lines(section, 20.0 * truth, 1e3 * truth);
    takeDriftOutOfNoise(record);
    lines(section, 0.5 * truth, 2.0 * truth);
}

TEST_CASE("Where every line is played what drifts is what is smooth in frequency", "[record]")
{
    constexpr double noise = 1e-4, drift = 0.01;
    const double truth = fold * std::sqrt(N * noise * noise / periods);
    auto still = take(1, noise, 401, 1), drifting = still;
    auto& current = drifting.channels[1].samples;
    const auto& voltage = drifting.channels[0].samples;
    for (std::size_t n = 12; n < current.size(); ++n)  // by another response than its own
        current[n] += drift * static_cast<double>(n / N % (settle + periods))
                      * (0.25 * voltage[n] - 0.15 * voltage[n - 5] + 0.1 * voltage[n - 12]);
    const auto check = [&](const Measurement& measured, int from, int to) {
        auto record = makeRecord(measured);
        for (int k = 3; k <= 401; ++k)
            if (&measured == &drifting)
                CHECK(record.sections.back().deviation[0][static_cast<std::size_t>(k)] > 5.0 * truth);
        takeDriftOutOfNoise(record);
        for (int k = from; k <= to; ++k) {
            CHECK(record.sections.back().deviation[0][static_cast<std::size_t>(k)] > 0.6 * truth);
            CHECK(record.sections.back().deviation[0][static_cast<std::size_t>(k)] < 1.5 * truth);
        }
        return record;
    };
    check(still, 3, 401);
    check(drifting, 3, 401);
    auto humming = drifting;  // on one line, at another phase in each period
    for (std::size_t n = 0; n < current.size(); ++n)
        humming.channels[1].samples[n] += 0.01
                                          * std::cos(2.0 * std::numbers::pi * 200.0 * static_cast<double>(n % N) / N
                                                     + 2.4 * static_cast<double>(n / N * (n / N)));
    const auto record = check(humming, 3, 150);
    CHECK(record.sections.back().deviation[0][200] > 0.3 * fold * 0.01 * N / 2.0 / std::sqrt(periods));
}

TEST_CASE("A few played lines far apart share their scatter all the same", "[record]")
{
    constexpr double noise = 0.02;
    auto sparse = take(1, noise);
    sparse.excitation->settlePeriods = settle + periods - 2;
    sparse.excitation->periods = 2;
    sparse.excitation->lines = {3, 7, 15, 31, 63, 127, 191, 255, 319, 401};
    const auto record = makeRecord(sparse);
    const double truth = fold * std::sqrt(N * noise * noise / 2.0);
    for (const auto& section : record.sections)
        for (const int k : section.excited) {
            CHECK(section.deviation[0][static_cast<std::size_t>(k)] > 0.7 * truth);
            CHECK(section.deviation[0][static_cast<std::size_t>(k)] < 1.4 * truth);
        }
}
