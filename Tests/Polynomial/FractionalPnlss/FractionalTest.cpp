// SPDX-License-Identifier: GPL-3.0-or-later
// Polynomial models of fractional order against closed forms, another discretization, and a loudspeaker simulated by
// other means.
#include "Bench/Draw.h"
#include "Engine/Estimate/Bla.h"
#include "Engine/Estimate/Periods.h"
#include "Engine/GreyBox/MixedImpedance.h"
#include "Engine/GreyBox/MixedOrderPnlss.h"
#include "Engine/Linear/Identify.h"
#include "Engine/Polynomial/FractionalPnlss/FractionalPnlssFit.h"
#include "Engine/Polynomial/FractionalPnlss/FractionalRecursion.h"
#include "Engine/Polynomial/FractionalPnlss/FractionalSimulation.h"
#include "Engine/Signal/Fft.h"
#include "Linear/Problem.h"

#include <Eigen/LU>

#include <numbers>

using namespace excursion;
using namespace excursion::test;
using Eigen::Index;
using std::numbers::pi;

namespace {

/// A driver with a semi-inductance, and a spring and a coil that change with the position.
FractionalPnlss nonlinearDriver(double alpha)
{
    MixedImpedance linear {6.0, 0.02, alpha, 3000.0, 50.0, 4.0};
    auto model = withTerms(linear, 3);
    for (Index k = 0; k < model.form.terms(); ++k) {
        const Eigen::RowVectorXi e = model.form.exponents.row(k);
        const double x0 = 2e-3;  // V s
        if (e == Eigen::RowVector4i(3, 0, 0, 0))
            model.form.E(1, k) = -0.2 * std::pow(2.0 * pi * 50.0, 2) / (x0 * x0);
        if (e == Eigen::RowVector4i(2, 0, 1, 0))
            model.form.E(1, k) = -0.1 * linear.motional / (x0 * x0);
        if (e == Eigen::RowVector4i(1, 1, 0, 0))
            model.form.E(2, k) = 0.1 / linear.semiInductance / x0;
        if (e == Eigen::RowVector4i(0, 1, 0, 1))
            model.form.F(0, k) = 1e-4;
    }
    return model;
}

Eigen::MatrixXd tones(Index samples, double rate, double size)
{
    Eigen::MatrixXd u = Eigen::MatrixXd::Zero(samples, 1);
    for (const double f : {31.0, 47.0, 90.0, 270.0, 900.0})
        for (Index t = 0; t < samples; ++t)
            u(t, 0) += size * std::sin(2.0 * pi * f * static_cast<double>(t) / rate + f)
                       * std::min(1.0, static_cast<double>(t) / 400.0);
    return u;
}

}  // namespace

TEST_CASE("The integral of fractional order on a grid has the response of s^-alpha")
{
    for (const double alpha : {0.1, 0.35, 0.6, 0.9, 1.0})
        for (const double rate : {8000.0, 96000.0}) {
            const auto integral = integratorFor(alpha, 1.0 / rate, {1.0, rate / 2.0, 4.0});
            double worst = 0.0;
            for (double f = 2.0; f < rate / 20.0; f *= 1.1) {
                const auto s = std::complex<double>(0.0, 2.0 * pi * f);
                const double reach = 19.0 / 720.0 * std::pow(2.0 * pi * f / rate, 4);
                const auto found = integral.response(std::polar(1.0, 2.0 * pi * f / rate));
                worst = std::max(worst, std::abs(found * std::pow(s, alpha) - 1.0) / (2.0 * reach + 3e-6));
            }
            CAPTURE(alpha, rate);
            CHECK(worst < 1.0);
        }
    CHECK_THROWS_AS(integratorFor(0.0, 1e-4, {}), Error);
    CHECK_THROWS_AS(integratorFor(1.2, 1e-4, {}), Error);
    CHECK_THROWS_AS(integratorFor(0.5, 0.0, {}), Error);
}

TEST_CASE("The linear part of a fractional polynomial model, simulated, settles on its frequency response")
{
    const double rate = 8000.0;
    const Index period = 4096, settle = 3 * period;
    auto model = nonlinearDriver(0.6);
    model.form.E.setZero();
    model.form.F.setZero();
    Eigen::MatrixXd u(settle + period, 1);
    std::vector<double> frequency;
    for (const int line : {10, 26, 52, 150, 400})
        frequency.push_back(line * rate / static_cast<double>(period));
    u.setZero();
    for (const double f : frequency)
        for (Index t = 0; t < u.rows(); ++t)
            u(t, 0) += std::cos(2.0 * pi * f * static_cast<double>(t) / rate + f);
    const auto grid = gridFor(model, rate, frequency, static_cast<double>(u.rows()) / rate, 1e-5);
    CHECK(errorOf(model, grid, frequency).errorDb < -100.0);
    CHECK(errorOf(model, grid, frequency).stable);
    const auto y = simulate(model, u, grid);
    const auto expected = respondLinear(model, frequency);
    const auto spectrumOf = [&](const Eigen::MatrixXd& x) {
        // ahead of the end, where the input is a guess
        return fft(std::span<const double>(x.data() + settle - 500, static_cast<std::size_t>(period)));
    };
    const auto U = spectrumOf(u), Y = spectrumOf(y);
    const std::vector<std::size_t> lines {10, 26, 52, 150, 400};
    for (std::size_t k = 0; k < lines.size(); ++k) {
        CAPTURE(frequency[k]);
        // what the slowest memory still holds decays with a power of time
        CHECK(std::abs(Y[lines[k]] / U[lines[k]] / expected[k](0, 0) - 1.0) < 2e-4);
    }
    // As an ordinary model it is the same.
    const auto ordinary = expandedLinear(model, grid);
    CHECK(isStable(ordinary) == (stabilityMargin(ordinary) > 0.0));
}

TEST_CASE("A nonlinear fractional equation, against Gruenwald and Letnikov's difference")
{
    // D^a x = -r x - c x^3 + u, x(0) = 0, at two steps and carried on to none
    const double a = 0.6, r = 300.0, c = 2e9, rate = 4000.0;
    const Index N = 800;
    FractionalStateSpace linear;
    linear.alpha = a;
    linear.form.A = Eigen::MatrixXd::Constant(1, 1, -r);
    linear.form.B = linear.form.C = Eigen::MatrixXd::Ones(1, 1);
    linear.form.D = Eigen::MatrixXd::Zero(1, 1);
    auto model = withTerms(linear, 3, TermMask::statesOnly);
    REQUIRE(model.form.terms() == 2);
    model.form.E(0, 1) = -c;
    const auto input = [](double t) {
        return std::pow(std::sin(pi * std::min(t / 0.05, 0.5)), 2)
               * (0.1 * std::sin(2 * pi * 40 * t) + 0.05 * std::sin(2 * pi * 130 * t));
    };
    Eigen::MatrixXd u(N, 1);
    for (Index t = 0; t < N; ++t)
        u(t, 0) = input(static_cast<double>(t) / rate);
    const auto difference = [&](int finer) {
        const auto M = N * finer;
        const double h = 1.0 / (rate * finer), scale = std::pow(h, -a);
        std::vector<double> w(static_cast<std::size_t>(M)), x(static_cast<std::size_t>(M));
        w[0] = 1.0;
        for (std::size_t j = 1; j < w.size(); ++j)
            w[j] = w[j - 1] * (1.0 - (a + 1.0) / static_cast<double>(j));
        Eigen::VectorXd y(N);
        for (std::size_t n = 0; n < x.size(); ++n) {
            double past = 0.0;
            for (std::size_t j = 1; j <= n; ++j)
                past += w[j] * x[n - j];
            double z = n > 0 ? x[n - 1] : 0.0;
            for (int k = 0; k < 30; ++k) {
                const double f = scale * (z + past) + r * z + c * z * z * z - input(static_cast<double>(n) * h);
                z -= f / (scale + r + 3.0 * c * z * z);
            }
            x[n] = z;
            if (n % static_cast<std::size_t>(finer) == 0)
                y[static_cast<Index>(n) / finer] = z;
        }
        return y;
    };
    const Eigen::VectorXd coarse = difference(8), fine = difference(16), truth = 2.0 * fine - coarse;
    const auto grid = gridFor(model, rate, {40.0, 130.0, 390.0}, 0.2, 1e-5);
    const auto y = simulate(model, u, grid);
    const double nonlinear = (y
                              - simulate(
                                  [&] {
                                      auto flat = model;
                                      flat.form.E.setZero();
                                      return flat;
                                  }(),
                                  u, grid))
                                 .norm()
                             / y.norm();
    CHECK(nonlinear > 0.05);
    const double error = (y.topRows(N - 100) - truth.head(N - 100)).norm() / truth.norm();
    CAPTURE(error, (truth - fine).norm() / truth.norm());
    CHECK(error < 2e-4);
}

TEST_CASE("The Jacobian of a fractional polynomial model is that of finite differences, by the order too")
{
    auto model = nonlinearDriver(0.55);
    Normal normal(3);
    for (auto& e : model.form.F.reshaped())
        e = 1e-3 * normal();
    const double rate = 4000.0;
    const auto u = tones(600, rate, 0.4);
    const FractionalGrid grid {rate, 2, {2.0, 4000.0, 3.0}};
    const FractionalRecursion recursion(model, grid, true, true);
    const auto input = fineInput(u, grid.substeps, false, 0);
    FractionalRecursion::Trajectory run;
    REQUIRE(recursion.run(model, input, 1e6, run));
    Eigen::MatrixXd J(600, recursion.parameters());
    recursion.differentiate(model, input, run, [&](Index first, std::vector<Eigen::MatrixXd>& block) {
        J.middleRows(first, block[0].rows()) = block[0];
    });
    const auto values = recursion.valuesOf(model);
    CHECK(values[values.size() - 1] == 0.55);
    double worst = 0.0;
    for (Index k = 0; k < values.size(); ++k) {
        const double h = 1e-5 / std::max(J.col(k).norm() / run.output.norm(), 1e-12);
        const auto at = [&](double step) {
            auto moved = values;
            moved[k] += step;
            auto other = model;
            recursion.setValues(other, moved);
            FractionalRecursion::Trajectory result;
            REQUIRE(recursion.run(other, input, 1e6, result));
            return result.output;
        };
        const Eigen::MatrixXd expected = (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h);
        if (J.col(k).norm() > 0.0)
            worst = std::max(worst, (J.col(k) - expected).norm() / J.col(k).norm());
        else
            CHECK(expected.norm() == 0.0);
    }
    CHECK(worst < 1e-7);
}

TEST_CASE("A fractional polynomial model explains a driver with semi-inductance down to its noise, where one of "
          "integer order does not",
          "[slow]")
{
    bench::Loudspeaker speaker;
    speaker.Le = 1e-9;
    speaker.eddyCurrents = bench::EddyCurrents {0.02, 0.6};
    bench::Curve gap {bench::Curve::Shape::gaussianGap}, spring {bench::Curve::Shape::coshSpring};
    gap.centre = 0.0003;
    bench::BenchSetup setup;
    setup.sampleRate = 16000.0;
    setup.excitation = {.period = 4096,
                        .settlePeriods = 1,
                        .periods = 2,
                        .realizations = 4,
                        .levels = {2.5},
                        .grid = "odd-random",
                        .shape = "pink",
                        .bandLow = 15.0,
                        .bandHigh = 3500.0,
                        .lines = {}};
    setup.channels = {Quantity::voltage, Quantity::current};
    setup.noiseDb = -66.0;
    setup.channelNoiseDb[Quantity::voltage] = -110.0;
    setup.seed = 4;
    const double far = bench::visit(speaker, setup).displacement;
    speaker.forceFactor = gap.scaledTo(0.15, far);
    speaker.stiffness = spring.scaledTo(0.2, far);
    const auto take = bench::measure(speaker, setup);
    const auto frf = bla(take, Quantity::current, 0).frf;
    std::vector<InputOutputRecord> estimation, validation;
    const auto column = [](const std::vector<double>& x) {
        return Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Index>(x.size()));
    };
    for (int r = 0; r < 4; ++r)
        (r < 3 ? estimation : validation)
            .push_back(periodicRecord(column(averagePeriod(take, *take.find(Quantity::voltage), 0, r)),
                                      column(averagePeriod(take, *take.find(Quantity::current), 0, r)), 4096));

    auto impedance = frequencyDataOf(frf);
    for (Index k = 0; k < impedance.lines(); ++k) {
        const auto Y = impedance.value(k, 0);
        if (impedance.deviation.size() != 0)
            impedance.deviation(k, 0) /= std::norm(Y);
        impedance.value(k, 0) = 1.0 / Y;
    }
    const auto mixed = fitMixedImpedance(impedance);
    const auto start = withTerms(mixed.model, 3);
    const auto grid = gridFor(start, setup.sampleRate, frf.frequency, 8192.0 / setup.sampleRate, 1e-4);
    FractionalPnlssOptions options;
    options.maximumIterations = 10;
    const auto fit = fitFractionalPnlss(start, grid, estimation, validation, options);

    // Integer orders with as many parameters or fewer, in several ways, from the linear model that leaves least in the
    // record
    auto weighted = frequencyDataOf(frf);
    const auto U = fft(averagePeriod(take, *take.find(Quantity::voltage), 0, 0));
    weighted.deviation.resize(weighted.lines(), 1);
    for (Index k = 0; k < weighted.lines(); ++k)
        weighted.deviation(
            k, 0) = 1.0 / std::abs(U[static_cast<std::size_t>(take.excitation->lines[static_cast<std::size_t>(k)])]);
    double integerDb = 0.0;
    for (const auto& [order, mask] : {std::pair {3, TermMask::full}, std::pair {7, TermMask::diagonal}}) {
        IdentifyOptions identifying;
        identifying.order = order;
        identifying.sampleRate = setup.sampleRate;
        const auto linear = identify(weighted, identifying).model;
        PnlssFitOptions searching;
        searching.maximumIterations = 60;
        const auto integer = fitPnlss(withTerms(linear, 3, mask), estimation, validation, searching);
        CAPTURE(order, integer.estimationDb, integer.validationDb);
        CHECK(Recursion(integer.model, true).parameters()
              < FractionalRecursion(fit.model, grid, true, true).parameters());
        integerDb = std::min(integerDb, integer.validationDb);
    }
    const double noiseDb = setup.noiseDb - 10.0 * std::log10(2.0);
    CAPTURE(fit.validationDb, integerDb, fit.model.alpha, fit.alphaStandardError);
    CHECK(fit.stable);
    CHECK(fit.validationDb < noiseDb + 3.0);
    CHECK(integerDb > noiseDb + 10.0);
    CHECK(std::abs(fit.model.alpha - 0.6) < 3.0 * fit.alphaStandardError + 1e-3);
}
