// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Error.h"
#include "Engine/Estimate/MakeRecord.h"
#include "Engine/Signal/Fft.h"
#include "Engine/Take/FindExcitation.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

using namespace excursion;

namespace {

constexpr int N = 1024, settle = 1, periods = 4, realizations = 3;
constexpr double sampleRate = 8000.0;
constexpr int fold = 2;  // times the rate at which the widest band is simulated

/// Odd lines 3 .. last (or all of them) at random phases; the current is the voltage over 4 ohm, two samples later.
/// @param faint   the realization that is only 0.7 times as loud
/// @param noise   rms of white noise on the current, in A, and of a tenth of it on the voltage, in V
Measurement take(int faint, double noise, int last = 401, int apart = 2)
{
    Measurement result;
    result.sampleRate = sampleRate;
    Excitation e;
    e.period = N;
    e.settlePeriods = settle;
    e.periods = periods;
    e.realizations = realizations;
    e.levels = {1.0, 3.0};
    e.grid = apart == 2 ? "odd" : "full";
    for (int k = 3; k <= last; k += apart)
        e.lines.push_back(k);
    e.bandLow = 3 * sampleRate / N;
    e.bandHigh = last * sampleRate / N;
    std::mt19937_64 random(11);
    std::normal_distribution<double> normal;
    std::vector<std::vector<double>> multisines;
    for (int r = 0; r < realizations; ++r) {
        std::vector<std::complex<double>> spectrum(N / 2 + 1, 0.0);
        for (const int k : e.lines)
            spectrum[static_cast<std::size_t>(k)] = std::polar((r == faint ? 0.7 : 1.0) * N / 20.0,
                                                               std::uniform_real_distribution<>(0.0, 6.28)(random));
        multisines.push_back(inverseFft(spectrum, N));
    }
    Channel voltage {Quantity::voltage, "V", 100.0, {}}, current {Quantity::current, "A", 100.0, {}};
    for (const double level : e.levels)
        for (const auto& period : multisines)
            for (int n = 0; n < e.samplesPerRealization(); ++n) {
                voltage.samples.push_back(level * period[static_cast<std::size_t>(n % N)]
                                          + 0.1 * noise * normal(random));
                current.samples.push_back(0.25 * level * period[static_cast<std::size_t>((n + N - 2) % N)]
                                          + noise * normal(random));
            }
    result.channels = {voltage, current};
    result.excitation = e;
    return result;
}

}  // namespace

TEST_CASE("A periodic take becomes one averaged period a level and realization", "[record]")
{
    const auto measured = take(1, 0.0);
    const auto record = makeRecord(measured);
    REQUIRE(record.sections.size() == 2 * realizations);
    CHECK(record.electrical);
    CHECK(record.channels == std::vector {Quantity::current});
    CHECK(record.units == std::vector<std::string> {"A"});
    CHECK(record.levels == std::vector {1.0, 3.0});
    CHECK(record.noiseKnown);
    CHECK(record.bandLow == Approx(3 * sampleRate / N));
    CHECK(record.bandHigh == Approx(401 * sampleRate / N));
    for (std::size_t s = 0; s < record.sections.size(); ++s) {
        const auto& section = record.sections[s];
        CHECK(section.periodic);
        CHECK(section.level == static_cast<int>(s) / realizations);
        CHECK(section.realization == static_cast<int>(s) % realizations);
        REQUIRE(section.window == fold * N);
        const auto first = s * (settle + periods) * N + settle * N;
        double worst = 0.0;
        for (std::size_t n = 0; n < N; ++n)
            worst = std::max(worst, std::abs(section.input[fold * n] - measured.channels[0].samples[first + n]));
        CHECK(worst < 1e-12);
        const auto truth = fft(std::span(measured.channels[1].samples).subspan(first, N));
        double difference = 0.0;
        for (std::size_t k = 0; k < truth.size(); ++k)
            difference = std::max(difference, std::abs(section.measured[0][k] - 1.0 * fold * truth[k]));
        CHECK(difference < 1e-10);
    }
}

TEST_CASE("A record knows how much less a loudspeaker takes while it settles", "[record]")
{
    auto settling = take(1, 0.0);
    auto& current = settling.channels[1].samples;
    const auto block = static_cast<std::size_t>(N * (settle + periods));
    for (std::size_t n = 0; n < current.size(); ++n)
        if (n % block < static_cast<std::size_t>(N * settle))
            current[n] *= 0.9;
    for (std::size_t p = 0; p < static_cast<std::size_t>(settle + periods); ++p)  // and less with every period
        for (std::size_t n = 0; n < current.size(); ++n)
            if (n / static_cast<std::size_t>(N) % static_cast<std::size_t>(settle + periods) == p)
                current[n] *= 1.0 - 1e-3 * static_cast<double>(p);
    double mean = 0.0;
    for (int p = settle; p < settle + periods; ++p)
        mean += std::pow(1.0 - 1e-3 * p, 2) / periods;
    for (const auto& section : makeRecord(settling).sections) {
        REQUIRE(section.power.size() == static_cast<std::size_t>(settle + periods));
        for (int p = 0; p < settle + periods; ++p)
            CHECK(section.power[static_cast<std::size_t>(p)]
                  == Approx((p < settle ? 0.81 : 1.0) * std::pow(1.0 - 1e-3 * p, 2) / mean).epsilon(1e-6));
    }
    settling.channels[1].quantity = Quantity::displacement;
    settling.channels[1].unit = "m";
    CHECK(makeRecord(settling).sections.front().power.empty());
}

TEST_CASE("Samples that no compared line needs are left out", "[record]")
{
    const auto measured = take(1, 1e-4, 61);
    const auto record = makeRecord(measured);
    CHECK(record.sampleRate == sampleRate / 2.0);
    CHECK(record.leadIn == N / 2);
    CHECK(record.highFrequency == Approx(2.0 * record.bandHigh));
    // The whole record is what a line at an eighth of the sample rate would have asked for.
    const auto whole = [&] {
        auto loud = measured;
        loud.excitation->lines.push_back(N / 8);
        return makeRecord(loud);
    }();
    REQUIRE(whole.sampleRate == sampleRate);
    const auto &section = record.sections[4], &full = whole.sections[4];
    REQUIRE(section.window == N / 2);
    CHECK(record.frequency(section, 61) == Approx(whole.frequency(full, 61)));
    for (std::size_t n = 0; n < section.window; ++n)
        // but for the noise that was played above the band
        CHECK(section.input[n] == Approx(full.input[2 * n]).margin(1e-4));
    for (std::size_t k = 1; k < 100; ++k) {
        CHECK(std::abs(2.0 * section.measured[0][k] - full.measured[0][k]) < 1e-10);
        CHECK(2.0 * section.deviation[0][k] == Approx(full.deviation[0][k]));
        CHECK(4.0 * section.inputVariance[k] == Approx(full.inputVariance[k]));
    }
}

TEST_CASE("Where products of a model would fold onto compared lines, it is simulated at twice the rate", "[record]")
{
    const auto at = [](int last) { return makeRecord(take(1, 0.0, last)); };
    // With lines to B, those to min(2 B, 0.42 fs) are compared, and products to 6 B leave them alone.
    CHECK(at(N / 8 - 1).sampleRate == sampleRate);
    const auto wide = at(N / 8 + 3);
    CHECK(wide.sampleRate == 2.0 * sampleRate);
    CHECK(wide.leadIn == 2 * N);
    CHECK(wide.highFrequency == Approx(2.0 * wide.bandHigh));
    CHECK(at(401).highFrequency == Approx(0.42 * sampleRate));
    const auto& section = wide.sections.front();
    CHECK(wide.frequency(section, 3) == Approx(3.0 * sampleRate / N));
    // Between the samples the period goes on as its lines do.
    const auto lines = fft(section.input);
    for (std::size_t k = N / 2; k < lines.size(); ++k)
        REQUIRE(std::abs(lines[k]) < 1e-9);
    for (std::size_t k = 0; k < N; ++k)
        REQUIRE(section.deviation[0][k] * 0.0 == 0.0);
}

TEST_CASE("A periodic section is driven by its periodic past", "[record]")
{
    const auto record = makeRecord(take(1, 0.0));
    const auto& section = record.sections[4];
    const auto drive = record.drive(section);
    REQUIRE(drive.size() == record.leadIn + section.window);
    for (std::size_t n = 0; n < section.window; ++n)
        REQUIRE(drive[record.leadIn + n] == section.input[n]);
    for (std::size_t n = 0; n + section.window < drive.size(); ++n)
        REQUIRE(drive[n] == drive[n + section.window]);
}

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
    useSilentNoise(record);
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
        useSilentNoise(record);
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

TEST_CASE("The realization that goes least far is held out, at all levels", "[record]")
{
    for (const int faint : {0, 1, 2}) {
        const auto record = makeRecord(take(faint, 0.0));
        for (const auto& section : record.sections)
            CHECK(section.validation == (section.realization == faint));
        CHECK(estimationSections(record).size() == 4);
        const auto held = validationSections(record);
        CHECK(held
              == std::vector<std::size_t> {static_cast<std::size_t>(faint),
                                           static_cast<std::size_t>(faint + realizations)});
    }
    RecordOptions options;
    options.holdOut = false;
    const auto record = makeRecord(take(1, 0.0), options);
    CHECK(std::none_of(record.sections.begin(), record.sections.end(), [](const Section& s) { return s.validation; }));
    CHECK(estimationSections(record).size() == record.sections.size());
    CHECK(validationSections(record).size() == record.sections.size());
}

TEST_CASE("Lines that are not known are found", "[record]")
{
    auto measured = take(1, 1e-4);
    const auto known = makeRecord(measured);
    measured.excitation->lines.clear();
    CHECK_THROWS_AS(makeRecord(measured), Error);
    completeExcitation(measured);
    const auto found = makeRecord(measured);
    CHECK(found.bandLow == known.bandLow);
    CHECK(found.bandHigh == known.bandHigh);
    CHECK(found.sections.front().excited == known.sections.front().excited);
}

TEST_CASE("Of periods that nothing settled before, the first is settling", "[record]")
{
    const auto settled = take(1, 1e-4);
    auto unsettled = settled;
    unsettled.excitation->settlePeriods = 0;
    unsettled.excitation->periods = settle + periods;
    const auto expected = makeRecord(settled), record = makeRecord(unsettled);
    REQUIRE(record.sections.size() == expected.sections.size());
    CHECK(record.noiseKnown);
    for (std::size_t s = 0; s < record.sections.size(); ++s) {
        CHECK(record.sections[s].input == expected.sections[s].input);
        CHECK(record.sections[s].measured == expected.sections[s].measured);
    }
    auto single = settled;
    single.excitation->settlePeriods = 0;
    single.excitation->periods = 1;
    CHECK(makeRecord(single).levels.empty());  // that of a single period without one is a take without periods
}

TEST_CASE("A record without periods is cut into windows of which a third is held out", "[record]")
{
    auto measured = take(1, 0.0);
    measured.excitation.reset();
    RecordOptions options;
    options.windowSeconds = 0.3;
    options.leadInSeconds = 0.2;
    const auto record = makeRecord(measured, options);
    const auto lead = record.leadIn, window = record.sections.front().window;
    CHECK(lead == 1600);
    CHECK(window == 2400);
    CHECK(record.sections.size() == (measured.length() - lead) / window);
    CHECK(!record.noiseKnown);
    CHECK(validationSections(record).size() == record.sections.size() / 3);
    for (std::size_t s = 0; s < record.sections.size(); ++s) {
        const auto& section = record.sections[s];
        CHECK(record.drive(section) == section.input);
        REQUIRE(section.input.size() == lead + window);
        for (std::size_t n = 0; n < section.input.size(); ++n)
            REQUIRE(section.input[n] == measured.channels[0].samples[s * window + n]);
        CHECK(section.measured[0] == fft(std::span(measured.channels[1].samples).subspan(lead + s * window, window)));
        CHECK(std::adjacent_find(section.deviation[0].begin(), section.deviation[0].end(), std::not_equal_to<>())
              == section.deviation[0].end());
    }
}

TEST_CASE("What is held out of a take without periods comes from all of it, and nothing there goes farthest",
          "[record]")
{
    auto measured = take(1, 0.0);
    measured.excitation.reset();
    const auto length = static_cast<double>(measured.length());
    for (auto& channel : measured.channels)  // ever louder
        for (std::size_t n = 0; n < channel.samples.size(); ++n)
            channel.samples[n] *= 0.05 + static_cast<double>(n) / length;
    RecordOptions options;
    options.windowSeconds = 0.26;
    const auto record = makeRecord(measured, options);
    const auto held = validationSections(record), fitted = estimationSections(record);
    REQUIRE(record.sections.size() >= 9);
    CHECK(held.front() < 3);
    CHECK(held.back() >= record.sections.size() / 3 * 3 - 3);
    const auto peakOf = [&](std::size_t s) {
        double peak = 0.0;
        for (const double value : record.sections[s].input)
            peak = std::max(peak, std::abs(value));
        return peak;
    };
    double farthest = 0.0;
    for (const auto s : fitted)
        farthest = std::max(farthest, peakOf(s));
    for (const auto s : held)
        CHECK(peakOf(s) <= farthest);
}

TEST_CASE("Windows of a take without periods weigh by what is in them, and a pause hardly at all", "[record]")
{
    auto measured = take(1, 1e-4);
    measured.excitation.reset();
    for (auto& channel : measured.channels)
        std::fill(channel.samples.begin(), channel.samples.begin() + 3000, 0.0);
    RecordOptions options;
    options.windowSeconds = 0.26;
    const auto record = makeRecord(measured, options);
    for (const auto& section : record.sections)
        CHECK(section.deviation == record.sections.front().deviation);
    CHECK(record.sections.front().deviation[0][5] > 0.0);
}

TEST_CASE("A take without periods is compared in the band that it drives, at a rate that this needs", "[record]")
{
    for (const double high : {160.0, 3300.0}) {
        constexpr double low = 40.0;
        Measurement measured;
        measured.sampleRate = sampleRate;
        Channel voltage {Quantity::voltage, "V", 1.0, {}}, current {Quantity::current, "A", 1.0, {}};
        std::mt19937_64 random(3);
        std::normal_distribution<double> normal;
        const auto at = [&](double n) {  // tones that repeat at no time
            double sum = 0.0;
            for (double f = low; f < high; f *= 1.0137)
                sum += std::sin(2.0 * std::numbers::pi * f * (n / sampleRate + 0.37 * f));
            return sum;
        };
        for (int n = 0; n < 16000; ++n) {
            voltage.samples.push_back(at(n) + 1e-3 * normal(random) + 3.0);  // an offset drives nothing
            current.samples.push_back(at(n - 2) + 1e-3 * normal(random));
        }
        measured.channels = {voltage, current};
        const auto record = makeRecord(measured);
        CAPTURE(high);
        const double third = std::cbrt(2.0);
        CHECK(record.bandLow <= low);
        CHECK(record.bandLow > low / third / third);
        CHECK(record.bandHigh >= high);
        CHECK(record.bandHigh < high * third * third);
        CHECK(record.sampleRate == sampleRate / (high == 160.0 ? 4 : 1));
        // The current is two samples late: a phase that thinning leaves as it is.
        const auto& section = record.sections[1];
        const auto input = fft(std::span(section.input).last(section.window));
        double wrong = 0.0, power = 0.0;
        for (std::size_t k = 1; record.frequency(section, k) < high; ++k) {
            const double late = 2.0 * std::numbers::pi * record.frequency(section, k) * 2.0 / sampleRate;
            wrong += std::norm(section.measured[0][k] - input[k] * std::polar(1.0, -late));
            power += std::norm(input[k]);
        }
        CHECK(wrong < 4e-3 * power);  // of a window of 4000 samples those at its ends differ
    }
}

TEST_CASE("A take that cannot be fitted is refused", "[record]")
{
    auto deaf = take(1, 0.0);
    deaf.channels.resize(1);
    CHECK_THROWS_AS(makeRecord(deaf), Error);
    auto brief = take(1, 0.0);
    brief.excitation.reset();
    for (auto& channel : brief.channels)
        channel.samples.resize(300);
    CHECK_THROWS_AS(makeRecord(brief), Error);
    RecordOptions options;
    std::string reason;
    CHECK(options.isValid(&reason));
    options.windowSeconds = 0.0;
    CHECK(!options.isValid(&reason));
    CHECK(!reason.empty());
    CHECK_THROWS_AS(makeRecord(take(1, 0.0), options), Error);
}

TEST_CASE("a stated period in which nothing repeats is refused", "[record]")
{
    auto made = take(-1, 0.0);
    made.excitation->lines.clear();
    std::mt19937_64 random(5);
    std::normal_distribution<double> noise;
    for (auto& x : made.channels.front().samples)
        x = noise(random);
    completeExcitation(made);
    CHECK_THROWS_AS(makeRecord(made), Error);
}
