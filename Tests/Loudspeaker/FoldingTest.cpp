// SPDX-License-Identifier: GPL-3.0-or-later
// A converter keeps what lies above half of its rate away; a model that is compared with it must, too.
#include "Engine/Estimate/MakeRecord.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/OutputError.h"
#include "Engine/Loudspeaker/Simulate.h"
#include "Engine/Signal/Fft.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <complex>
#include <numbers>
#include <random>
#include <vector>

using namespace excursion;

namespace {

constexpr int N = 2048, finer = 8;
constexpr double rate = 48000.0;
using Spectrum = std::vector<std::complex<double>>;

/// Odd lines to a fifth of the sample rate, sampled `times` as often.
std::vector<double> period(const Spectrum& lines, int times)
{
    Spectrum spectrum(static_cast<std::size_t>(N * times / 2 + 1), 0.0);
    for (std::size_t k = 0; k < lines.size(); ++k)
        spectrum[k] = static_cast<double>(times) * lines[k];
    return inverseFft(spectrum, static_cast<std::size_t>(N * times));
}

}  // namespace

TEST_CASE("Distortion above half of a take's rate does not fold onto the lines that a model is compared on", "[fit]")
{
    OperatingRange range;
    range.current = 6.0;
    auto model = withEffect(makeModel("electrodynamic"), effectNamed("inductance-current"), range);
    const double Le = model.baseParameter("Le").value;
    for (auto& p : model.components.back().parameters)
        p.value = p.name == "c2" ? -0.4 * Le : 0.0;

    Measurement take;
    take.sampleRate = rate;
    Excitation e;
    e.period = N;
    e.settlePeriods = 1;
    e.periods = 3;
    e.realizations = 2;
    e.levels = {1.0};
    for (int k = 3; k < N / 5; k += 2)
        e.lines.push_back(k);
    take.excitation = e;
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> phase(0.0, 2.0 * std::numbers::pi);
    std::normal_distribution<double> normal;
    Channel voltage {Quantity::voltage, "V", 100.0, {}}, current {Quantity::current, "A", 100.0, {}};
    constexpr double noise = 1e-5;  // A
    double folded = 0.0;            // A, mean square
    for (int m = 0; m < e.realizations; ++m) {
        Spectrum lines(N / 2 + 1, 0.0);
        for (const int k : e.lines)
            lines[static_cast<std::size_t>(k)] = std::polar(N * 0.25, phase(random));
        std::vector<double> u;
        const auto fine = period(lines, finer), coarse = period(lines, 1);
        for (int p = 0; p < 4; ++p)
            u.insert(u.end(), fine.begin(), fine.end());
        SimulationOptions exact;
        exact.tolerance = 1e-8;
        const auto played = simulate(model, u, rate * finer, exact);
        const auto& i = played.find(Quantity::current)->samples;
        const std::vector<double> last(i.end() - N * finer, i.end());
        auto kept = fft(last);
        kept.resize(N / 2 + 1);
        for (auto& value : kept)
            value /= finer;
        kept.back() = 0.0;
        const auto converted = inverseFft(kept, N);
        for (std::size_t n = 0; n < N; ++n)
            folded += std::pow(last[n * finer] - converted[n], 2) / (N * e.realizations);
        for (int n = 0; n < e.samplesPerRealization(); ++n) {
            voltage.samples.push_back(coarse[static_cast<std::size_t>(n % N)]);
            current.samples.push_back(converted[static_cast<std::size_t>(n % N)] + noise * normal(random));
        }
    }
    take.channels = {voltage, current};
    REQUIRE(std::sqrt(folded) > 5.0 * noise);  // else there would be nothing to keep away

    RecordOptions options;
    options.holdOut = false;
    const auto record = makeRecord(take, options);
    CHECK(record.sampleRate == 2.0 * rate);
    OutputErrorOptions run;
    run.gradient = false;
    run.substeps = 4;
    const auto fits = outputError(model, record, {0, 1}, {}, run);
    REQUIRE(fits.size() == 2);
    for (const auto& fit : fits) {
        REQUIRE(fit.finite);
        CHECK(fit.power.front().overNoise() < 1.3);
    }
}
