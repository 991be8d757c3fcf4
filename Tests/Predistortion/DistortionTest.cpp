// SPDX-License-Identifier: GPL-3.0-or-later
// How much distortion is left, on the lines that a multisine leaves out.
#include "Predistortion/Drivers.h"

#include "Bench/Draw.h"
#include "Engine/Diagnosis/Improve.h"
#include "Engine/Loudspeaker/Simulate.h"
#include "Engine/Predistortion/Predistorter.h"
#include "Engine/Signal/Fft.h"
#include "Engine/Signal/Multisine.h"

#include <catch2/catch.hpp>

using namespace excursion;

namespace {

struct Stimulus {
    std::vector<int> lines;
    int period = 8192;
    std::vector<double> u;  ///< faded in, several periods
};

Stimulus stimulus(double sampleRate, double low, double high, int periods)
{
    MultisineOptions options;
    options.sampleRate = sampleRate;
    options.period = 8192;
    options.bandLow = low;
    options.bandHigh = high;
    Stimulus result {chooseLines(options), options.period, {}};
    const auto one = multisine(options, result.lines, 0);
    for (int p = 0; p < periods; ++p)
        result.u.insert(result.u.end(), one.begin(), one.end());
    for (std::size_t n = 0; n < 2048; ++n)
        result.u[n] *= 0.5 - 0.5 * std::cos(std::numbers::pi * static_cast<double>(n) / 2048.0);
    return result;
}

/// Power on the silent lines of the band in the last period, over that on all lines; dB. What a slow transient of the
/// linear driver leaves there is taken out with its own last period.
double distortionDb(const Stimulus& played, const std::vector<double>& signal, const std::vector<double>& linear)
{
    const auto last = [&](const std::vector<double>& samples) {
        return fft(std::vector<double>(samples.end() - played.period, samples.end()));
    };
    const auto Y = last(signal), L = last(linear);
    double silent = 0.0, all = 0.0;
    for (int k = played.lines.front(), next = 0; k <= played.lines.back(); ++k) {
        const auto line = static_cast<std::size_t>(k);
        all += std::norm(L[line]);
        if (played.lines[static_cast<std::size_t>(next)] == k)
            ++next;
        else
            silent += std::norm(Y[line] - L[line]);
    }
    return 10.0 * std::log10(silent / all);
}

Measurement exact(const Model& model, const std::vector<double>& u, double sampleRate)
{
    SimulationOptions options;
    options.tolerance = 1e-7;
    return simulate(model, u, sampleRate, options);
}

void checkResidual(const Model& model, double sampleRate, int oversampling)
{
    auto played = stimulus(sampleRate, 20.0, 6000.0, 4);
    const auto linear = linearPart(model);
    const double reach = peak(exact(linear, played.u, sampleRate).find(Quantity::displacement)->samples);
    for (auto& sample : played.u)
        sample *= 0.75 * xmax / reach;
    const auto wanted = exact(linear, played.u, sampleRate), before = exact(model, played.u, sampleRate);
    Predistorter predistorter(model, {sampleRate, oversampling});
    const auto after = exact(model, through(predistorter, played.u), sampleRate);
    CHECK(predistorter.collectMeters().faults == 0);
    for (const auto quantity : {Quantity::displacement, Quantity::acceleration}) {
        const auto db = [&](const Measurement& take) {
            return distortionDb(played, take.find(quantity)->samples, wanted.find(quantity)->samples);
        };
        INFO(name(quantity) << " at " << sampleRate << " Hz, before " << db(before));
        CHECK(db(after) < -90.0);
        if (model.effectIds().size() > 1)
            CHECK(db(before) > -40.0);
    }
}

}  // namespace

TEST_CASE("Predistorter and driver together are linear to -90 dB at 75 % of xmax", "[predistortion][slow]")
{
    SECTION("each effect alone")
    {
        for (const auto* effect : catalogue()) {
            if (!effect->undone())
                continue;
            INFO(effect->id());
            checkResidual(withStrong(midbass(), *effect), 48000.0, 2);
        }
    }
    SECTION("all together, at every rate")
    {
        checkResidual(everything(), 44100.0, 2);
        checkResidual(everything(), 48000.0, 2);
        checkResidual(everything(), 48000.0, 4);
        checkResidual(everything(), 96000.0, 1);
    }
}

TEST_CASE("A model identified from a noisy take linearizes the driver that it was taken from", "[predistortion][slow]")
{
    // The driver is the virtual bench's, which shares no equation, law or integrator with the model.
    bench::DrawOptions options;
    options.driver = "seed";
    options.hidden = std::vector<bench::HiddenEffect> {
        {"force-factor", 0.3}, {"stiffness", 0.3}, {"inductance-position", 0.3}};
    options.noiseDb = -70.0;
    options.sampleRate = 44100.0;
    options.seconds = 2.0;
    options.channels = std::vector {Quantity::voltage, Quantity::current, Quantity::displacement};
    const auto drawn = bench::draw(7, options);
    ImproveOptions known;
    known.with = {"force-factor", "stiffness", "inductance-position"};
    const auto ladder = improve(bench::measure(drawn.speaker, drawn.setup), known);
    REQUIRE(ladder.verdict == Verdict::complete);

    const auto& plan = drawn.setup.excitation;
    auto played = stimulus(44100.0, plan.bandLow, 0.8 * plan.bandHigh, 4);
    const double gain = 0.9 * plan.levels.back() / rms(played.u);
    for (auto& sample : played.u)
        sample *= gain;
    Predistorter predistorter(ladder.model(), {44100.0, 2});
    const std::vector outputs {Quantity::displacement, Quantity::acceleration};
    const auto bent = through(predistorter, played.u);
    const auto wanted = bench::play(drawn.speaker.linear(), played.u, 44100.0, outputs);
    const auto before = bench::play(drawn.speaker, played.u, 44100.0, outputs),
               after = bench::play(drawn.speaker, bent, 44100.0, outputs);
    for (const auto quantity : outputs) {
        const auto db = [&](const Measurement& take) {
            return distortionDb(played, take.find(quantity)->samples, wanted.find(quantity)->samples);
        };
        INFO(name(quantity) << " from " << db(before) << " to " << db(after));
        CHECK(db(after) < db(before) - 26.0);
    }
}
