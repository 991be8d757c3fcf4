// SPDX-License-Identifier: GPL-3.0-or-later
// Identification of fractional models: systems that are known, the spread of repeated estimates, and a fixed problem.
#include "Engine/Fractional/FractionalIdentify.h"
#include "Engine/GreyBox/MixedImpedance.h"
#include "Engine/Linear/OrderSweep.h"
#include "Linear/Problem.h"

#include <numbers>

using namespace excursion;
using namespace excursion::test;
using Complex = std::complex<double>;
using std::numbers::pi;

namespace {

std::vector<double> logarithmicLines(double low, double high, int count)
{
    std::vector<double> f;
    for (int k = 0; k < count; ++k)
        f.push_back(low * std::pow(high / low, static_cast<double>(k) / (count - 1)));
    return f;
}

template <class Response>
FrequencyData responseOf(const std::vector<double>& f, Response G)
{
    FrequencyData data;
    data.frequency = f;
    data.value.resize(static_cast<Eigen::Index>(f.size()), 1);
    for (std::size_t k = 0; k < f.size(); ++k)
        data.value(static_cast<Eigen::Index>(k), 0) = G(f[k]);
    return data;
}

void addNoise(FrequencyData& data, double relative, Normal& normal)
{
    data.deviation = relative * data.value.cwiseAbs();
    for (Eigen::Index k = 0; k < data.lines(); ++k)
        data.value(k, 0) += data.deviation(k, 0) * std::sqrt(0.5) * Complex(normal(), normal());
}

/// 0.3 + three sections in lambda = (s/w)^alpha that are stable for alpha up to 1.3
Complex known(double f, double alpha)
{
    const Complex l = std::pow(Complex(0.0, f / 100.0), alpha);
    return 0.3 + 2.0 / (l * l + 1.5 * l + 1.1) + (0.4 * l - 1.0) / (l * l + 4.0 * l + 9.0) + 5.0 / (l + 20.0);
}

const MixedImpedance driver {3.3, 0.02, 0.6, 1700.0, 57.0, 6.5};

}  // namespace

TEST_CASE("Sections know Matignon's sector")
{
    for (const double alpha : {0.3, 0.5, 0.9, 1.3, 1.8}) {
        INFO("alpha " << alpha);
        const double border = 0.5 * pi * alpha;
        for (const double angle : {0.02, border - 0.01, border + 0.01, 3.1}) {
            const Complex root = std::polar(7.0, angle);
            const auto sections = sectionsOf({root, std::conj(root)}, 0.0, 2.0, alpha);
            CHECK(isStable(sections) == (angle > border));
            const auto moved = mirrored(sections);
            CHECK(isStable(moved));
            const double found = std::abs(std::arg(poles(moved)[0]));
            CHECK(
                found
                == Approx(angle > border ? angle : std::min(2.0 * border - angle, 0.5 * (border + pi))).epsilon(1e-9));
            CHECK(std::abs(poles(moved)[0]) == Approx(7.0));
        }
        CHECK(isStable(sectionsOf({-1.0, -50.0, -3.0}, 0.0, 1.0, alpha)));
        for (const auto& roots : {std::vector<Complex> {2.0, 30.0}, {-2.0, 30.0}, {5.0}, {0.0}}) {
            CHECK_FALSE(isStable(sectionsOf(roots, 0.0, 1.0, alpha)));
            CHECK(isStable(mirrored(sectionsOf(roots, 0.0, 1.0, alpha))));
        }
    }
}

TEST_CASE("An exact response of fractional order is met to rounding, below and above order 1")
{
    for (const double alpha : {0.3, 0.5, 0.8, 1.3}) {
        INFO("alpha " << alpha);
        const auto data = responseOf(logarithmicLines(1.0, 20000.0, 150),
                                     [alpha](double f) { return known(f, alpha); });
        FractionalOptions options;
        options.order = 5;
        options.alpha = alpha;
        const auto found = identifyFractional(data, options);
        CHECK(found.errorDb < -230.0);
        CHECK(found.stable);
        CHECK(found.alphaStandardError == 0.0);
        CHECK(found.warning.empty());
        // In its eigenvalues: that of 5/(l + 20) is the one farthest out.
        const double unit = std::pow(200.0 * pi, alpha);
        double farthest = 0.0;
        for (const auto& pole : poles(found.model.form))
            farthest = std::max(farthest, std::abs(pole));
        CHECK(farthest == Approx(20.0 * unit).epsilon(1e-6));
        // Between the lines
        for (const double f : {3.3, 87.0, 12345.0})
            CHECK(std::abs(respond(found.model, {f})[0](0, 0) - known(f, alpha)) < 1e-9);
    }
}

TEST_CASE("The standard error of alpha is the spread of its estimates", "[slow]")
{
    // 1/(1 + (s/w)^0.6) + noise of 1 %, of which the bound of Cramer and Rao can be computed: 24 estimates, chi^2 of 24
    const auto lines = logarithmicLines(10.0, 10000.0, 60);
    Normal normal(21);
    double sum = 0.0;
    for (int draw = 0; draw < 24; ++draw) {
        auto data = responseOf(lines, [](double f) { return 1.0 / (1.0 + std::pow(Complex(0.0, f / 300.0), 0.6)); });
        addNoise(data, 0.01, normal);
        FractionalOptions options;
        options.order = 1;
        options.leastAlpha = 0.4;
        options.mostAlpha = 0.9;
        const auto found = identifyFractional(data, options);
        REQUIRE(found.warning.empty());
        CHECK(found.alphaStandardError > 1e-4);
        CHECK(found.alphaStandardError < 1e-2);
        sum += std::pow((found.model.alpha - 0.6) / found.alphaStandardError, 2);
    }
    CHECK(sum > 10.0);  // 0.5 and 99.9 % of chi^2
    CHECK(sum < 51.0);
    // Without known deviations the noise is estimated from what is left.
    auto data = responseOf(lines, [](double f) { return 1.0 / (1.0 + std::pow(Complex(0.0, f / 300.0), 0.6)); });
    addNoise(data, 0.01, normal);
    FractionalOptions options;
    options.order = 1;
    const auto known = identifyFractional(data, options);
    data.deviation.resize(0, 0);
    const auto blind = identifyFractional(data, options);
    CHECK(std::abs(blind.model.alpha - 0.6) < 4.0 * blind.alphaStandardError);
    CHECK(blind.alphaStandardError < 4.0 * known.alphaStandardError);
}

TEST_CASE("The standard errors of a mixed-order impedance are the spread of its estimates", "[slow]")
{
    const auto lines = logarithmicLines(10.0, 20000.0, 120);
    const int draws = 200;
    Normal normal(4);
    std::array<double, MixedImpedance::parameters> square {};
    for (int draw = 0; draw < draws; ++draw) {
        auto data = responseOf(lines, [](double f) { return driver.at(f); });
        addNoise(data, 0.01, normal);
        const auto fit = fitMixedImpedance(data);
        REQUIRE(fit.converged());
        for (std::size_t j = 0; j < square.size(); ++j)
            square[j] += std::pow((fit.model.values()[j] - driver.values()[j]) / fit.standardErrors.values()[j], 2)
                         / draws;
    }
    for (const double s : square)
        CHECK(s == Approx(1.0).margin(0.35));  // 3.5 standard deviations of chi^2 over 200
}

TEST_CASE("A mixed-order impedance is met exactly, with alpha free or given")
{
    const auto data = responseOf(logarithmicLines(10.0, 20000.0, 120), [](double f) { return driver.at(f); });
    for (const bool free : {true, false}) {
        MixedImpedanceOptions options;
        if (!free)
            options.alpha = 0.6;
        const auto fit = fitMixedImpedance(data, options);
        CHECK(fit.errorDb < -200.0);
        for (std::size_t j = 0; j < 6; ++j)
            CHECK(fit.model.values()[j] == Approx(driver.values()[j]).epsilon(1e-9));
        CHECK((fit.standardErrors.alpha > 0.0) == free);
    }
}

TEST_CASE("The fixed problem: an impedance with R + L s^1/2, at the noise")
{
    const auto frf = problemResponse("P4.csv");
    if (frf.frequency.empty())
        return;
    const auto data = frequencyDataOf(frf);
    const auto rows = problemRows("P4.csv");
    // Of P parameters estimated from Gaussian noise, twice this is chi^2 of P.
    const auto distanceToTruth = [&rows](auto model) {
        double distance = 0.0;
        for (const auto& row : rows)
            distance += std::norm(model(row[0]) - Complex(row[4], row[5])) / (row[3] * row[3]);
        return distance;
    };

    const auto mixed = fitMixedImpedance(data);
    CHECK(mixed.converged());
    CHECK(mixed.errorDb < -39.6);  // the noise floor
    CHECK(mixed.chiSquared == Approx(400.0).margin(60.0));
    CHECK(std::abs(mixed.model.alpha - 0.5) < 2.0 * mixed.standardErrors.alpha);
    CHECK(mixed.standardErrors.alpha < 2e-3);
    CHECK(2.0 * distanceToTruth([&](double f) { return mixed.model.at(f); }) < 22.5);  // 99.9 % of chi^2 of 6

    FractionalOptions options;
    options.order = 5;
    options.alpha = 0.5;
    const auto fixed = identifyFractional(data, options);
    CHECK(fixed.errorDb < -39.6);
    CHECK(fixed.stable);
    CHECK(2.0 * distanceToTruth([&](double f) { return respond(fixed.model, {f})[0](0, 0); }) < 31.3);  // of 11
}

TEST_CASE("With alpha free the fixed problem tells 1/2 at order 5, and that order 6 does not care", "[slow]")
{
    const auto frf = problemResponse("P4.csv");
    if (frf.frequency.empty())
        return;
    const auto data = frequencyDataOf(frf);
    FractionalOptions options;
    const auto sweep = sweepFractional(data, {5, 6}, options);
    CHECK(sweep.entries[sweep.chosen].order == 5);
    const auto& five = sweep.entries[0].found;
    CHECK(five.stable);
    CHECK(five.warning.empty());
    CHECK(std::abs(five.model.alpha - 0.5) < 2.0 * five.alphaStandardError);
    CHECK(five.alphaStandardError < 0.03);
    const auto& six = sweep.entries[1].found;
    CHECK(six.warning.find("alpha is not determined") != std::string::npos);
    CHECK(std::isnan(six.alphaStandardError));
    CHECK(sweep.warning.find("order 6 explains the data as well with alpha from 0.") != std::string::npos);
}

TEST_CASE("Fractional identifications refuse what they cannot do")
{
    auto data = responseOf(logarithmicLines(1.0, 1000.0, 30), [](double f) { return known(f, 0.5); });
    FractionalOptions options;
    options.alpha = 2.0;
    refused(Error::Kind::usage, "alpha must lie between 0 and 2", [&] { identifyFractional(data, options); });
    options.alpha.reset();
    options.mostAlpha = 0.1;
    refused(Error::Kind::usage, "bounds", [&] { identifyFractional(data, options); });
    refused(Error::Kind::usage, "ascend", [&] { sweepFractional(data, {3, 2}, {}); });
    refused(Error::Kind::usage, "alpha", [&] { fitMixedImpedance(data, {-1.0, 10}); });
    IdentifyOptions discrete;
    discrete.sampleRate = 48000.0;
    discrete.alpha = 0.5;
    refused(Error::Kind::usage, "1 in discrete time", [&] { identify(data, discrete); });
    data.value *= -1.0;
    refused(Error::Kind::numerical, "must be positive", [&] { fitMixedImpedance(data); });
}
