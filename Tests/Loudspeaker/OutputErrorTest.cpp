// SPDX-License-Identifier: GPL-3.0-or-later
#include "Loudspeaker/EffectBench.h"

#include "Engine/Loudspeaker/OutputError.h"
#include "Engine/Signal/Fft.h"

#include <catch2/catch.hpp>

#include <complex>
#include <random>

using namespace excursion;

namespace {

using Complex = std::complex<double>;

constexpr std::size_t N = 512;
constexpr double sampleRate = 12000.0;

Model bent()
{
    auto model = makeModel("electrodynamic");
    for (const auto* effect : catalogue()) {
        auto operatingRange = someOperatingRange(1.0);
        operatingRange.degree = 3;
        operatingRange.highFrequency = 2000.0;
        model = withEffect(model, *effect, operatingRange);
        auto& component = model.components.back();
        double sign = 1.0;
        // So that what they remember of the start is forgotten in the lead-in.
        if (effect->id() == "friction")
            component.parameters[1].value = 2e-5;  // m
        if (effect->id() == "vented-box") {
            component.parameters[1].value = 150.0;  // fB, Hz
            component.parameters[2].value = 0.6;    // 1/QP
        }
        for (auto& p : component.parameters)
            if (p.strength)
                p.value = effect->law() ? 0.07 * (sign *= -1.0) * component.operatingRange.scale
                          : std::isfinite(p.prior) || std::isfinite(p.upper)
                              ? strengthOf(*effect, p, component.operatingRange, effect->creeps() ? 0.4 : 0.05)
                              : someScale(*effect) / 5.0;
    }
    for (auto* p : parametersOf(model))
        p->free = true;
    model.path.parameters[1].value = 3e-4;
    return model;
}

/// Le(x) falls to nothing on one side.
Model withoutIron(Model model)
{
    for (auto& component : model.components)
        if (component.effect->id() == "inductance-position")
            component.parameters.front().value = -1.3 * model.baseParameter("Le").value;
    return model;
}

/// Two sections of a multisine and any measured spectra at all, with deviations that differ.
Record someRecord()
{
    Record record;
    record.sampleRate = sampleRate;
    record.channels = {Quantity::current, Quantity::displacement, Quantity::velocity, Quantity::pressure};
    record.units = {"A", "m", "m/s", "Pa"};
    record.lowFrequency = 30.0;
    record.highFrequency = 3000.0;
    record.bandLow = sampleRate / N;
    record.bandHigh = 60 * sampleRate / N;
    record.leadIn = 2 * N;
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    const double size[] = {10.0, 0.03, 6.0, 3.0};
    for (int s = 0; s < 2; ++s) {
        Section section;
        section.periodic = true;
        section.window = N;
        std::vector<Complex> U(N / 2 + 1, 0.0);
        for (std::size_t k = 1; k < 60; k += 2)
            U[k] = std::polar(0.5 * N, 6.28 * uniform(random));
        section.input = inverseFft(U, N);
        for (const double scale : size) {
            std::vector<Complex> measured(N / 2 + 1);
            std::vector<double> deviation(N / 2 + 1);
            for (std::size_t k = 0; k < measured.size(); ++k) {
                measured[k] = std::polar(scale * uniform(random), 6.28 * uniform(random));
                deviation[k] = 1e-2 * scale * (0.5 + uniform(random));
            }
            section.measured.push_back(measured);
            section.deviation.push_back(deviation);
        }
        record.sections.push_back(section);
    }
    return record;
}

OutputErrorOptions plain(int substeps = 16)
{
    OutputErrorOptions options;
    options.gradient = false;
    options.spectra = true;
    options.substeps = options.gradientSubsteps = substeps;
    return options;
}

}  // namespace

TEST_CASE("Normal equations are those from finite differences, by every parameter", "[output-error]")
{
    const auto model = GENERATE(false, true) ? withoutIron(bent()) : bent();
    const auto record = someRecord();
    const std::vector<std::size_t> sections {0};
    const auto active = freeParameters(model);
    REQUIRE(active.size() == parametersOf(model).size());
    constexpr int most = 64;  // neighbours whose stable number differs take as many
    auto options = plain(most);
    options.gradient = true;
    const auto fit = outputError(model, record, sections, active, options);
    REQUIRE(fit.size() == 1);
    REQUIRE(fit[0].finite);

    const auto theta = parameterVector(model);
    const auto P = theta.size();
    // [parameter][channel][line]
    std::vector<std::vector<std::vector<Complex>>> slope(static_cast<std::size_t>(P));
    for (Eigen::Index k = 0; k < P; ++k) {
        // A lag is small against a period of the highest line.
        const bool isLag = parametersOf(model)[static_cast<std::size_t>(k)]->unit == "s" && theta[k] == 0.0;
        const double step = isLag ? 1e-8 : theta[k] != 0.0 ? 2e-5 * std::max(std::abs(theta[k]), 1e-4) : 2e-5;
        const auto moved = [&](double by) {
            auto there = model;
            auto changed = theta;
            changed[k] += by;
            setParameterVector(there, changed);
            return outputError(there, record, sections, {}, plain(most))[0].predicted;
        };
        auto above = moved(step);
        const auto below = moved(-step);
        for (std::size_t c = 0; c < above.size(); ++c)
            for (std::size_t n = 0; n < above[c].size(); ++n)
                above[c][n] = (above[c][n] - below[c][n]) / (2.0 * step);
        slope[static_cast<std::size_t>(k)] = above;
    }
    const auto& section = record.sections[0];
    const auto [first, last] = record.lineRange(section);
    for (std::size_t c = 0; c < record.channels.size(); ++c) {
        INFO(name(record.channels[c]));
        const auto weighted = [&](std::size_t parameter, std::size_t k) {
            return slope[parameter][c][k] / section.deviation[c][k];
        };
        Eigen::MatrixXd N2 = Eigen::MatrixXd::Zero(P, P);
        Eigen::VectorXd g = Eigen::VectorXd::Zero(P);
        double cost = 0.0;
        for (auto k = first; k <= last; ++k) {
            const Complex r = (fit[0].predicted[c][k] - section.measured[c][k]) / section.deviation[c][k];
            cost += 2.0 * std::norm(r);
            for (Eigen::Index a = 0; a < P; ++a) {
                const auto A = weighted(static_cast<std::size_t>(a), k);
                g[a] += 2.0 * std::real(std::conj(A) * r);
                for (Eigen::Index b = 0; b < P; ++b)
                    N2(a, b) += 2.0 * std::real(std::conj(A) * weighted(static_cast<std::size_t>(b), k));
            }
        }
        const auto& normal = fit[0].channels[c];
        CHECK(normal.cost == Approx(cost).epsilon(1e-12));
        CHECK(normal.rows == 2.0 * static_cast<double>(last - first + 1));
        // What a parameter does not reach at all is left to rounding.
        const auto size = [&](Eigen::Index a) { return std::sqrt(N2(a, a)) + 1e-8 * std::sqrt(cost); };
        for (Eigen::Index a = 0; a < P; ++a) {
            INFO(parametersOf(model)[static_cast<std::size_t>(a)]->name << ", parameter " << a);
            CHECK(std::abs(normal.g[a] - g[a]) <= 2e-4 * size(a) * std::sqrt(cost));
            for (Eigen::Index b = 0; b < P; ++b)
                CHECK(std::abs(normal.N(a, b) - N2(a, b)) <= 2e-4 * size(a) * size(b));
        }
    }
}

TEST_CASE("A linear model's prediction is its response times the input", "[output-error]")
{
    auto model = makeModel("electrodynamic");
    model.path.parameters[1].value = 3e-4;
    auto record = someRecord();
    record.leadIn = 10 * N;
    auto options = plain();
    options.substeps = 8;
    const auto fits = outputError(model, record, {0, 1}, {}, options);
    for (std::size_t s = 0; s < 2; ++s) {
        const auto U = fft(record.sections[s].input);
        for (std::size_t k = 1; k < 60; k += 2) {
            INFO("line " << k);
            const Complex p(0.0, 2.0 * std::numbers::pi * record.frequency(record.sections[s], k));
            const Complex mechanical = 1e-2 * p * p + 1.0 * p + 2e3;
            const Complex I = U[k] / (6.0 + p * 3e-4 + 25.0 * p / mechanical), X = 5.0 * I / mechanical;
            const Complex truth[] = {I, X, p * X,
                                     1.2 * 0.01 / (2.0 * std::numbers::pi) * p * p * X * std::exp(-p * 3e-4)};
            for (std::size_t c = 0; c < 4; ++c)
                CHECK(std::abs(fits[s].predicted[c][k] - truth[c]) < 1e-4 * std::abs(truth[c]));
        }
    }
}

TEST_CASE("The number of threads changes nothing", "[output-error]")
{
    const auto model = bent();
    const auto record = someRecord();
    auto options = plain();
    options.gradient = true;
    options.threads = 1;
    const auto alone = outputError(model, record, {0, 1}, freeParameters(model), options);
    options.threads = 3;
    const auto together = outputError(model, record, {0, 1}, freeParameters(model), options);
    for (std::size_t s = 0; s < 2; ++s)
        for (std::size_t c = 0; c < record.channels.size(); ++c) {
            CHECK(alone[s].channels[c].cost == together[s].channels[c].cost);
            CHECK(alone[s].channels[c].N == together[s].channels[c].N);
            CHECK(alone[s].channels[c].g == together[s].channels[c].g);
            CHECK(alone[s].power[c].error == together[s].power[c].error);
        }
}

TEST_CASE("A model that runs away is no fit, and a stop is obeyed", "[output-error]")
{
    auto model = withEffect(makeModel("electrodynamic"), effectNamed("stiffness"), someOperatingRange(1.0));
    model.components.back().parameters[1].value = -100.0 * model.baseParameter("K").value;
    auto record = someRecord();
    for (auto& sample : record.sections[0].input)
        sample *= 1e3;
    CHECK(!outputError(model, record, {0}, freeParameters(model), plain())[0].finite);
}

TEST_CASE("A prior pulls a parameter towards zero as one more measurement would", "[output-error]")
{
    auto model = makeModel("electrodynamic");
    model = withEffect(model, effectNamed("stiffness"), someOperatingRange(1.0));
    auto& p = model.components.back().parameters[0];
    p.value = 30.0;
    p.prior = 10.0;
    for (std::size_t k = 1; k < model.components.back().parameters.size(); ++k)
        model.components.back().parameters[k].value = 0.0;
    const auto active = freeParameters(model);
    const auto P = static_cast<Eigen::Index>(active.size());
    NormalEquations sum;
    sum.N = Eigen::MatrixXd::Zero(P, P);
    sum.g = Eigen::VectorXd::Zero(P);
    addPrior(model, active, sum);
    CHECK(sum.cost == Approx(9.0));
    CHECK(sum.g[6] == Approx(30.0 / 100.0));
    CHECK(sum.N(6, 6) == Approx(1.0 / 100.0));
    CHECK(sum.N.topLeftCorner(6, 6).isZero());
}

TEST_CASE("Pulls of bands add up to the gradient, those of a level together")
{
    auto record = someRecord();
    const auto model = bent();
    const auto active = freeParameters(model);
    auto fits = outputError(model, record, {0, 1}, active, {});
    const auto sum = sumOf(fits);
    REQUIRE(sum);
    for (const bool apart : {false, true}) {
        record.sections[0].level = 0;
        record.sections[1].level = apart ? 1 : 0;
        const auto pulls = pullsOf(fits, record, {0, 1});
        CHECK(pulls.cols() == (apart ? 2 : 1) * Residual::bands);
        CHECK((pulls.rowwise().sum() - sum->g).norm() < 1e-9 * sum->g.norm());
    }
    CHECK(pullsOf(outputError(model, record, {0, 1}, {}, {}), record, {0, 1}).size() == 0);
}
