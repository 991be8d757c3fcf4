// SPDX-License-Identifier: GPL-3.0-or-later
// The whole way on the virtual bench: a PNLSS model of a noisy take, inverted, and the loudspeaker itself driven
// with what comes out. The bench shares no line with the models.
#include "BlackBox/RandomModels.h"
#include "Predistortion/Programme.h"

#include "Bench/Draw.h"
#include "Engine/Estimate/Bla.h"
#include "Engine/Linear/Identify.h"
#include "Engine/Polynomial/Pnlss/PnlssFit.h"
#include "Engine/Polynomial/TakeRecords.h"
#include "Engine/Signal/Fft.h"

#include <catch2/catch.hpp>

#include <algorithm>

using namespace excursion;

namespace {

/// Noise that is far too loud, and bursts at the resonance, for two seconds.
std::vector<double> loudProgramme(double peak, double sampleRate)
{
    Draw draw(4);
    auto u = pinkNoise(draw, static_cast<std::size_t>(2.0 * sampleRate));
    for (std::size_t n = 0; n < u.size(); ++n) {
        const double t = static_cast<double>(n) / sampleRate, burst = std::fmod(t, 0.5) < 0.2 ? 1.0 : 0.0;
        u[n] = peak * (u[n] + burst * std::sin(2.0 * std::numbers::pi * 45.0 * t));
    }
    return u;
}

/// Power on the lines that were not played, of that on those that were: what a person measures as distortion.
double onSilentLines(std::span<const double> period, const std::vector<int>& lines)
{
    const auto X = fft(period);
    double signal = 0.0, rest = 0.0;
    for (int k = 1; k <= lines.back(); ++k)
        (std::binary_search(lines.begin(), lines.end(), k) ? signal
                                                           : rest) += std::norm(X[static_cast<std::size_t>(k)]);
    return decibelsOf(rest / signal);
}

}  // namespace

TEST_CASE("A loudspeaker of the bench is linearized by a PNLSS model of its take", "[.minutes]")
{
    for (const std::uint64_t seed : {7U, 12U}) {
        bench::DrawOptions wanted;
        wanted.driver = "midbass";
        wanted.hidden = {{"stiffness", 0.3}, {"force-factor", 0.3}};
        wanted.noiseDb = -70.0;
        wanted.sampleRate = 48000.0;
        wanted.channels = {Quantity::voltage, Quantity::displacement};
        wanted.seconds = 3.0;
        const auto drawn = bench::draw(seed, wanted);
        const auto take = bench::measure(drawn.speaker, drawn.setup);
        const auto records = recordsOf(take, take.input(), *take.find(Quantity::displacement));
        IdentifyOptions identifying;
        identifying.order = 3;
        identifying.sampleRate = take.sampleRate;
        const int loudest = static_cast<int>(take.excitation->levels.size()) - 1;
        const auto start = withTerms(
            identify(frequencyDataOf(bla(take, Quantity::displacement, loudest).frf), identifying).model, 3);
        PnlssFitOptions fitting;
        fitting.enoughDb = records.enoughDb();
        const auto fit = fitPnlss(start, records.estimation, records.validation, fitting);
        REQUIRE(fit.validationDb < -40.0);

        const auto stimulus = stimulusOf(records.estimation, take.sampleRate);
        const RehearsedBox box(boxOf(fit.model, stimulus));
        BlackBoxPredistorter predistorter(box, take.sampleRate);
        constexpr int period = 16384;
        std::vector<int> lines;
        const auto one = playedAs(stimulus, take.sampleRate, period, 77, &lines);
        std::vector<double> u;
        // So long that the mean of what bends the model has settled, which the linearizer leaves alone.
        constexpr int periods = 8, judged = 6;
        for (int k = 0; k < periods; ++k)
            u.insert(u.end(), one.begin(), one.end());
        for (std::size_t k = 0; k < u.size(); ++k) {
            const auto edge = static_cast<double>(std::min(k, u.size() - 1 - k));
            u[k] *= 0.9 * std::min(1.0, edge / 2000.0);
        }
        auto bent = u;
        bent.resize(u.size() + 2000, 0.0);
        predistorter.process(bent.data(), bent.data(), bent.size());
        const auto late = static_cast<std::size_t>(predistorter.latency());
        const auto before = bench::play(drawn.speaker, u, take.sampleRate, {Quantity::displacement}),
                   after = bench::play(drawn.speaker, bent, take.sampleRate, {Quantity::displacement});
        const std::span<const double> plain(before.find(Quantity::displacement)->samples),
            straight(after.find(Quantity::displacement)->samples);
        const double was = onSilentLines(plain.subspan(judged * period, period), lines),
                     is = onSilentLines(straight.subspan(judged * period + late, period), lines);
        const auto told = box.rehearsal;
        WARN("seed " << seed << ": model " << fit.validationDb << " dB, told " << told.beforeDb << " to "
                     << told.afterDb << " dB; the loudspeaker " << was << " to " << is << " dB, turned down by "
                     << predistorter.collectMeters().regionReduction << " dB");
        CHECK(was - is > 25.0);

        // Far too loud, with a limit that a model of this error can promise: the loudspeaker itself keeps it.
        PredistortionControls controls;
        controls.displacementLimit = 0.6 * box.region.farthest;
        controls.voltageLimit = stimulus.peak;
        controls.margin = 0.05;
        BlackBoxPredistorter careful(box, take.sampleRate, controls);
        auto loud = loudProgramme(2.0 * stimulus.peak, take.sampleRate);
        careful.process(loud.data(), loud.data(), loud.size());
        const auto moved = bench::play(drawn.speaker, loud, take.sampleRate, {Quantity::displacement});
        const double reached = peakOf(moved.find(Quantity::displacement)->samples) / controls.displacementLimit;
        WARN("too loud: the loudspeaker goes to " << reached << " of its limit, told "
                                                  << careful.collectMeters().displacement / controls.displacementLimit);
        CHECK(reached < 1.0);
        CHECK(reached > 0.7);
        CHECK(peakOf(loud) <= controls.voltageLimit);
    }
}
