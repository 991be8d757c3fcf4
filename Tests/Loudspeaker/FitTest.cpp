// SPDX-License-Identifier: GPL-3.0-or-later
// Fits to takes of the virtual bench, which shares no code with the model.
#include "SmallSetup.h"

#include "Bench/Bench.h"
#include "Engine/Estimate/MakeRecord.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/Fit.h"
#include "Engine/Loudspeaker/Laws.h"
#include "Engine/Loudspeaker/OutputError.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <map>
#include <numbers>

using namespace excursion;

namespace {

std::vector<std::pair<std::string, double>> truths()
{
    const bench::Loudspeaker truth;
    return {{"Re", truth.Re}, {"Le", truth.Le}, {"Bl", truth.Bl}, {"m", truth.m}, {"Rms", truth.Rms}, {"K", truth.K}};
}

struct Fitted {
    Model model;
    FitSummary summary;
};

/// The largest displacement of a take.
double reachOf(const Measurement& take)
{
    double reach = 0.0;
    for (const double x : take.find(Quantity::displacement)->samples)
        reach = std::max(reach, std::abs(x));
    return reach;
}

Fitted fitLinear(const Measurement& take)
{
    auto record = makeRecord(take);
    Fitted result;
    result.model = startModel(record);
    adapt(record, result.model);
    FitOptions options;
    options.simulationTolerance = 1e-6;  // the errors of the parameters are far below the noise of a sample
    result.summary = fit(result.model, record, estimationSections(record), options);
    return result;
}

}  // namespace

TEST_CASE("The driver's parameters come back within their errors from a noisy take", "[fit]")
{
    auto setup = smallSetup();
    setup.seed = 2;
    const auto [model, summary] = fitLinear(bench::measure(bench::Loudspeaker {}, setup));
    INFO(summary.message);
    CHECK(summary.usable());
    CHECK(summary.converged());
    CHECK(summary.chiSquaredPerValue == Approx(1.0).margin(0.15));
    for (const auto& [name, value] : truths()) {
        const auto& p = model.baseParameter(name);
        INFO(name << " is " << p.value << " +- " << p.standardError << ", truth " << value);
        CHECK(std::abs(p.value - value) < 3.0 * p.standardError);
        CHECK(p.standardError < 1e-3 * value);
        CHECK(p.standardError > 0.0);
    }
    const auto all = parametersOf(model);
    REQUIRE(model.covariance.rows() == static_cast<Eigen::Index>(all.size()));
    for (std::size_t k = 0; k < all.size(); ++k)
        // no sensor has a corner here that could be told
        if (all[k]->free && (std::isfinite(all[k]->standardError) || k < all.size() - model.path.parameters.size()))
            CHECK(std::sqrt(model.covariance(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(k)))
                  == Approx(all[k]->standardError));
}

TEST_CASE("The standard errors are those of repeated takes", "[fit][slow]")
{
    constexpr int takes = 5;
    std::map<std::string, double> square;
    for (int n = 0; n < takes; ++n) {
        auto setup = smallSetup();
        setup.seed = static_cast<std::uint64_t>(1 + n);
        const auto model = fitLinear(bench::measure(bench::Loudspeaker {}, setup)).model;
        for (const auto& [name, value] : truths()) {
            const auto& p = model.baseParameter(name);
            square[name] += std::pow((p.value - value) / p.standardError, 2);
        }
    }
    for (const auto& [name, sum] : square) {
        INFO(name);
        CHECK(sum < 18.2);  // 99.7 % of chi-square with five degrees of freedom
    }
}

TEST_CASE("Noise of the input counts once, though all channels show it", "[fit][slow]")
{
    constexpr int takes = 30;
    std::map<std::string, double> square;
    for (int n = 0; n < takes; ++n) {
        auto setup = smallSetup();
        setup.excitation.periods = 4;
        setup.noiseDb = -90.0;
        setup.channelNoiseDb[Quantity::voltage] = -60.0;
        setup.seed = static_cast<std::uint64_t>(100 + n);
        const auto model = fitLinear(bench::measure(bench::Loudspeaker {}, setup)).model;
        for (const auto& [name, value] : truths()) {
            const auto& p = model.baseParameter(name);
            square[name] += std::pow((p.value - value) / p.standardError, 2);
        }
    }
    for (const auto& [name, sum] : square) {
        INFO(name << ": " << std::sqrt(sum / takes) << " standard errors, rms");
        // 99.7 % of chi-square with thirty degrees of freedom, either way
        CHECK(sum < 54.5);
        CHECK(sum > 12.9);
    }
}

TEST_CASE("A law that the model lacks widens the errors beyond the noise that it looks like", "[fit]")
{
    bench::Loudspeaker truth;
    auto setup = smallSetup();
    const double reach = reachOf(bench::measure(truth, setup));
    truth.stiffness = bench::Curve {bench::Curve::Shape::coshSpring, 0.0, reach}.scaledTo(0.1, reach);
    const auto [model, summary] = fitLinear(bench::measure(truth, setup));
    CHECK(summary.chiSquaredPerValue > 2.0);
    const auto K = firstParameterOf(model, 0) + 5;
    REQUIRE(parametersOf(model)[static_cast<std::size_t>(K)]->name == "K");
    const double asNoise = std::sqrt(model.inverseCurvature(K, K)), told = model.baseParameter("K").standardError;
    INFO("K is " << model.baseParameter("K").value << " +- " << told << ", as noise " << asNoise);
    CHECK(told > 1.5 * asNoise);
    CHECK(widenedCovariance(model)(K, K) == Approx(told * told));
}

TEST_CASE("What is visited is what the bench's cone and coil did", "[fit]")
{
    auto setup = smallSetup();
    setup.noiseDb = -INFINITY;
    const auto take = bench::measure(bench::Loudspeaker {}, setup);
    const auto record = makeRecord(take);
    const auto operatingRange = visitedRange(startModel(record), record);
    const auto peakOfUsed = [&](Quantity quantity) {
        const auto& e = *take.excitation;
        const auto& samples = take.find(quantity)->samples;
        double peak = 0.0;
        for (int r = 0; r < e.realizations; ++r)
            for (int n = e.settlePeriods * e.period; n < e.samplesPerRealization(); ++n)
                peak = std::max(peak, std::abs(samples[static_cast<std::size_t>(r * e.samplesPerRealization() + n)]));
        return peak;
    };
    CHECK(operatingRange.displacement == Approx(peakOfUsed(Quantity::displacement)).epsilon(0.05));
    CHECK(operatingRange.current == Approx(peakOfUsed(Quantity::current)).epsilon(0.05));
    const double resolution = take.sampleRate / take.excitation->period;
    CHECK(operatingRange.lowFrequency == Approx(resolution * take.excitation->lines.front()));
    CHECK(operatingRange.highFrequency == Approx(resolution * take.excitation->lines.back()));
}

TEST_CASE("A record that was adapted starts settled", "[fit]")
{
    auto record = makeRecord(bench::measure(bench::Loudspeaker {}, smallSetup()));
    const auto model = startModel(record);
    const auto before = record.sections.front().deviation;
    adapt(record, model);
    for (const auto& section : record.sections)
        CHECK(section.inputVariance.empty());
    for (std::size_t c = 0; c < before.size(); ++c)
        for (std::size_t k = 0; k < before[c].size(); ++k)
            REQUIRE(record.sections.front().deviation[c][k] >= before[c][k]);
    // After the lead-in another one changes nothing.
    OutputErrorOptions options;
    options.gradient = false;
    options.spectra = true;
    options.substeps = 2;
    const auto first = outputError(model, record, {0}, {}, options)[0].predicted;
    record.leadIn += record.sections.front().window;
    const auto second = outputError(model, record, {0}, {}, options)[0].predicted;
    for (std::size_t c = 0; c < first.size(); ++c) {
        double difference = 0.0, power = 0.0;
        const auto [low, high] = record.lineRange(record.sections.front());
        for (auto k = low; k <= high; ++k) {
            difference += std::norm(first[c][k] - second[c][k]);
            power += std::norm(second[c][k]);
        }
        CHECK(std::sqrt(difference / power) < 1e-5);
    }
}

TEST_CASE("A law of the bench comes back as the law of the effect", "[fit][slow]")
{
    bench::Loudspeaker truth;
    auto setup = smallSetup();
    setup.excitation.levels = {1.0, 4.0};
    setup.excitation.realizations = 3;
    const double reach = reachOf(bench::measure(truth, setup));
    truth.forceFactor = bench::Curve {bench::Curve::Shape::gaussianGap, 0.1 * reach, reach}.scaledTo(0.2, reach);
    auto record = makeRecord(bench::measure(truth, setup));
    auto model = startModel(record);
    adapt(record, model);
    fit(model, record, estimationSections(record));
    model = withEffect(model, effectNamed("force-factor"), visitedRange(model, record));
    const auto summary = fit(model, record, estimationSections(record));
    INFO(summary.message);
    CHECK(summary.chiSquaredPerValue == Approx(1.0).margin(0.25));
    const auto law = laws(model).front();
    int points = 0, inside = 0;
    for (std::size_t n = 0; n < law.argument.size(); ++n)
        if (std::abs(law.argument[n]) < 0.9 * law.argument.back()) {
            ++points;
            inside += std::abs(law.value[n] - truth.forceFactorAt(law.argument[n])) < 2.0 * law.halfWidth[n];
        }
    CHECK(inside == points);
}

TEST_CASE("Loops in the iron that the coil leaves are a part of Le(x)", "[fit][slow]")
{
    auto setup = smallSetup();
    setup.excitation.period = 2048;
    setup.excitation.levels = {1.0, 4.0};
    bench::Loudspeaker truth;
    truth.Le = 80e-6;
    truth.eddyCurrents = bench::EddyCurrents {6e-3, 0.65, {}, true};
    truth.inductancePosition = bench::Curve {bench::Curve::Shape::tanhStep, 0.0, 3e-3, 0.3, 0.0};
    auto record = makeRecord(bench::measure(truth, setup));
    auto model = startModel(record);
    adapt(record, model);
    const auto operatingRange = visitedRange(model, record, 4);
    model = withEffect(withEffect(model, effectNamed("eddy-currents"), operatingRange, 1),
                       effectNamed("inductance-position"), operatingRange);
    FitOptions patient;  // a base without loops is far from what the responses show
    patient.search.maximumIterations = 100;
    const auto with = fit(model, record, estimationSections(record), patient);
    INFO(with.message);
    auto fixed = model;
    for (auto& p : fixed.components.back().parameters)
        if (!p.strength) {
            p.value = 0.0;
            p.free = false;
        }
    const auto without = fit(fixed, record, estimationSections(record));
    INFO("with loops that move " << with.chiSquaredPerValue << ", with loops that stay " << without.chiSquaredPerValue);
    // On the bench the loops see k(x) i, in the model c(x) multiplies what they make of i: alike where the cone is slow
    // against them.
    CHECK(without.chiSquaredPerValue > 50.0 * with.chiSquaredPerValue);
    const auto law = laws(model).front();
    REQUIRE(law.frequency > 0.0);
    const double omega = 2.0 * std::numbers::pi * law.frequency;
    const double loops = truth.eddyImpedance({0.0, omega}).imag() / omega;
    for (std::size_t n = 0; n < law.argument.size(); ++n) {
        const double Le = truth.inductanceAt(law.argument[n]);
        if (std::abs(law.argument[n]) < 0.9 * law.argument.back())  // a curve of degree 4 follows a step within that
            CHECK(law.value[n] == Approx(Le + Le / truth.Le * loops).epsilon(0.01));
    }
}

TEST_CASE("Loops whose rates are free follow a moving coil closer than any that are fixed", "[fit][slow]")
{
    bench::Loudspeaker truth;
    truth.eddyCurrents = bench::EddyCurrents {4e-3, 0.7, {}, true};
    truth.inductancePosition = bench::Curve {bench::Curve::Shape::arctanStep, 0.0, 3e-3, 0.4, 0.0};
    auto setup = smallSetup();
    setup.excitation.period = 2048;
    setup.excitation.levels = {1.0, 4.0};
    setup.noiseDb = -85.0;
    auto record = makeRecord(bench::measure(truth, setup));
    auto model = startModel(record);
    adapt(record, model);
    const auto operatingRange = visitedRange(model, record, 10);
    model = withEffect(withEffect(model, effectNamed("eddy-currents"), operatingRange, 1),
                       effectNamed("inductance-position"), operatingRange);
    FitOptions asGiven;  // without lags of the sensors, which follow a part of what fixed loops leave
    asGiven.asGiven = true;
    const auto fitTwice = [&] {  // the rate of a loop without a share joins a search at its next begin
        fit(model, record, estimationSections(record), asGiven);
        return fit(model, record, estimationSections(record), asGiven).chiSquaredPerValue;
    };
    auto& law = model.components.back().parameters;
    const auto isRate = [](const Parameter& p) { return p.relaxed && p.name.front() == 'r'; };
    for (auto& p : law)
        p.free = p.free && !isRate(p);
    const double fixed = fitTwice();
    for (auto& p : law)
        p.free = p.free || isRate(p);
    CHECK(fixed > 6.0);
    CHECK(fitTwice() < 0.5 * fixed);
}

TEST_CASE("With the slopes of fed laws a fit by simulation arrives where its own slopes lead", "[fit]")
{
    auto setup = smallSetup();
    setup.excitation.levels = {1.0, 3.0};
    bench::Loudspeaker speaker;
    speaker.stiffness = bench::Curve {bench::Curve::Shape::skewedSpring, 0.5e-3, 3e-3, 0.0, 0.5};
    const auto take = bench::measure(speaker, setup);
    auto record = makeRecord(take);
    auto model = startModel(record);
    adapt(record, model);
    model = withEffect(model, effectNamed("stiffness"), visitedRange(model, record));
    const auto sections = estimationSections(record);
    FitOptions fed;
    fed.fed = true;
    REQUIRE(fit(model, record, sections, fed).usable());

    auto own = model, borrowed = model;
    FitOptions options;
    const auto exact = fit(own, record, sections, options);
    options.fedGradient = true;
    const auto quick = fit(borrowed, record, sections, options);
    REQUIRE(exact.usable());
    REQUIRE(quick.usable());
    CHECK(exact.onlyNoise);
    CHECK(quick.chiSquaredPerValue == Approx(exact.chiSquaredPerValue).epsilon(1e-3));
    for (const char* name : {"Re", "Bl", "m", "K"}) {
        const auto &a = own.baseParameter(name), &b = borrowed.baseParameter(name);
        INFO(name);
        CHECK(std::abs(a.value - b.value) < a.standardError);
    }
}

TEST_CASE("The power of an error is judged channel by channel, over all sections", "[fit]")
{
    const auto section = [](ErrorPower first, ErrorPower second) {
        SectionFit fit;
        fit.finite = true;
        fit.power = {first, second};
        return fit;
    };
    // 16 times the noise in one section, none in the other: 8.5 times in all.
    CHECK(worstPower({section({16.0, 100.0, 1.0}, {1.0, 100.0, 1.0}), section({1.0, 100.0, 1.0}, {1.0, 100.0, 1.0})})
          == Approx(8.5));
    CHECK(worstPower({section({1.0, 100.0, 1.0}, {0.5, 100.0, 1.0})}) == Approx(1.0));
    CHECK(std::isinf(worstPower({section({1.0, 100.0, 0.0}, {0.5, 100.0, 1.0})})));
}

TEST_CASE("A spread of relaxations that has shrunk to nothing holds up no fit", "[fit]")
{
    auto record = makeRecord(bench::measure(bench::Loudspeaker {}, smallSetup()));
    auto truth = startModel(record);
    adapt(record, truth);
    truth = withEffect(truth, effectNamed("creep"), visitedRange(truth, record));
    auto& creep = truth.components.back().parameters;
    creep[0].value = 0.2 * truth.baseParameter("K").value;
    creep[1].value = 1.3;
    creep[2].value = 0.0;  // one relaxation
    OutputErrorOptions run;
    run.gradient = false;
    run.spectra = true;
    const auto sections = estimationSections(record);
    const auto fits = outputError(truth, record, sections, {}, run);
    for (std::size_t n = 0; n < sections.size(); ++n) {
        auto& section = record.sections[sections[n]];
        for (std::size_t c = 0; c < section.measured.size(); ++c)
            for (std::size_t k = 0; k < section.measured[c].size(); ++k)
                section.measured[c][k] = fits[n].predicted[c][k] + 0.7 * section.deviation[c][k];
    }
    for (const double width : {0.0, 1e-5, 1e-3, 3e-3, 1e-2, 3e-2}) {
        INFO(width);
        auto model = truth;
        auto& p = model.components.back().parameters;
        p[0].value *= 1.05;
        p[1].value += 0.05;
        p[2].value = width;
        model.baseParameter("Re").value *= 1.001;
        FitOptions options;
        options.search = {15, 1e-3};
        options.fedGradient = true;
        const auto summary = fit(model, record, sections, options);
        INFO(summary.message << " after " << summary.iterations << ", width " << p[2].value);
        CHECK(summary.iterations <= 6);
        CHECK(summary.chiSquaredPerValue < 0.5055);  // 0.5049 is left of what was added
    }
}
