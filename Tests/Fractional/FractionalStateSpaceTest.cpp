// SPDX-License-Identifier: GPL-3.0-or-later
// Fractional models against closed forms: the circuit and the loudspeaker of [B 5], Matignon's sector against
// the theorems' matrices.
#include "Engine/Fractional/FractionalStateSpaceFile.h"
#include "Engine/Fractional/TimeResponse.h"
#include "Engine/Linear/LinearHold.h"
#include "Engine/Linear/Simulation.h"
#include "DocumentFile.h"
#include "Linear/Problem.h"

#include <Eigen/Eigenvalues>
#include <nlohmann/json.hpp>

#include <numbers>

using namespace excursion;
using namespace excursion::test;
using Complex = std::complex<double>;
using std::numbers::pi;

namespace {

/// R and a fractance 1/(C s^alpha): H = 1/(1 + RC s^alpha) [B 5.19], RC such that (RC)^(-1/alpha) = 2000 pi.
FractionalStateSpace circuit(double alpha)
{
    const double rc = std::pow(2000.0 * pi, -alpha);
    FractionalStateSpace model;
    model.alpha = alpha;
    model.form.A = Eigen::MatrixXd::Constant(1, 1, -1.0 / rc);
    model.form.B = Eigen::MatrixXd::Constant(1, 1, 1.0 / rc);
    model.form.C = Eigen::MatrixXd::Ones(1, 1);
    model.form.D = Eigen::MatrixXd::Zero(1, 1);
    return model;
}

constexpr double mass = 14.35e-3, drag = 0.786, stiffness = 1852.0, force = 4.95, resistance = 3.3;
// ohm s^1/2. [B 5.2] prints 0.1197 microhenry: 450 times the 266 microhenry of [B 2.2]
constexpr double semiInductance = 0.1197;

/// The admittance of [B 5.2], states x, D^1/2 x, D x, D^3/2 x, i. The equations ahead of [B 5.39] print the drag
/// r/m with D^1/2 x; the force is -r D x, as the matrix has it.
FractionalStateSpace loudspeaker()
{
    FractionalStateSpace model;
    model.alpha = 0.5;
    model.form.A = Eigen::MatrixXd::Zero(5, 5);
    model.form.A << 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, -stiffness / mass, 0, -drag / mass, 0, force / mass, 0,
        0, -force / semiInductance, 0, -resistance / semiInductance;
    model.form.B = Eigen::MatrixXd::Zero(5, 1);
    model.form.B(4, 0) = 1.0 / semiInductance;
    model.form.C = Eigen::MatrixXd::Zero(1, 5);
    model.form.C(0, 4) = 1.0;
    model.form.D = Eigen::MatrixXd::Zero(1, 1);
    return model;
}

Eigen::MatrixXd step(Eigen::Index samples) { return Eigen::MatrixXd::Ones(samples, 1); }

}  // namespace

TEST_CASE("The seed's circuit answers as 1/(1 + RC s^alpha)")
{
    for (const double alpha : {0.3, 0.5, 1.0, 1.4}) {
        const auto model = circuit(alpha);
        REQUIRE(model.isValid());
        CHECK(isStable(model));
        CHECK(sectorMargin(model) == Approx(pi - 0.5 * pi * alpha));
        for (const double f : {3.0, 1000.0, 77777.0}) {
            const Complex truth = 1.0 / (1.0 + std::pow(Complex(0.0, f / 1000.0), alpha));
            CHECK(std::abs(respond(model, {f})[0](0, 0) - truth) < 1e-14 * std::abs(truth));
        }
        // At the cut-off 1/(1 + j^alpha): |H| = 1/sqrt(2 + 2 cos(alpha pi/2)), arg = -alpha pi/4 ([B 5.1.4]
        // prints cos(alpha pi) and -alpha pi/2).
        const Complex cut = respond(model, {1000.0})[0](0, 0);
        CHECK(std::abs(cut) == Approx(1.0 / std::sqrt(2.0 + 2.0 * std::cos(0.5 * alpha * pi))).epsilon(1e-13));
        CHECK(std::arg(cut) == Approx(-0.25 * alpha * pi).epsilon(1e-12));
    }
    CHECK(20.0 * std::log10(std::abs(respond(circuit(0.5), {1000.0})[0](0, 0))) == Approx(-5.33).margin(0.01));
}

TEST_CASE("The step of the seed's circuit is that of erfc, by Mittag-Leffler, ladder and difference")
{
    const auto model = circuit(0.5);
    // [B 5.32]
    const auto truth = [](double t) { return 1.0 - std::exp(2000.0 * pi * t) * std::erfc(std::sqrt(2000.0 * pi * t)); };
    const double fs = 1e6;
    std::vector<double> times;
    for (int n = 0; n <= 1000; ++n)
        times.push_back(n / fs);
    const auto exact = stepResponse(model, times);
    for (std::size_t n = 0; n < times.size(); n += 50)
        CHECK(exact[n](0, 0) == Approx(truth(times[n])).epsilon(1e-12).margin(1e-300));
    const auto ladder = simulateByLadder(model, step(1001), fs, {30.0, 1e6, 4.0});
    const auto coarse = simulateByDifference(model, step(501), 0.5 * fs),
               fine = simulateByDifference(model, step(1001), fs);
    for (Eigen::Index n = 100; n <= 1000; n += 100) {
        const double y = exact[static_cast<std::size_t>(n)](0, 0);
        CHECK(std::abs(ladder(n, 0) - y) < 3e-6);
        // Order 1, so the difference halves with the step.
        CHECK((coarse(n / 2, 0) - y) / (fine(n, 0) - y) == Approx(2.0).margin(0.1));
        CHECK(std::abs(fine(n, 0) - y) < 2e-3);
    }
    // Its impulse [B 5.28] is the derivative of the step.
    const auto impulse = impulseResponse(model, {4.995e-4, 5e-4, 5.005e-4});
    CHECK(impulse[1](0, 0) == Approx((truth(5.005e-4) - truth(4.995e-4)) / 1e-6).epsilon(1e-5));
}

TEST_CASE("The seed's loudspeaker has the impedance R + L s^1/2 + Bl^2 s/(m s^2 + r s + k)")
{
    const auto model = loudspeaker();
    CHECK(isStable(model));
    for (const double f : {5.0, 57.2, 400.0, 20000.0}) {
        const Complex s(0.0, 2.0 * pi * f);
        const Complex Z = resistance + semiInductance * std::sqrt(s)
                          + force * force * s / (mass * s * s + drag * s + stiffness);
        CHECK(std::abs(respond(model, {f})[0](0, 0) * Z - 1.0) < 1e-12);
    }
}

TEST_CASE("The step of the seed's loudspeaker agrees with the inverted Laplace transform")
{
    // mpmath 1.3, invertlaplace by Talbot's method with 40 digits
    const double references[][3] = {
        {1e-4, 0.0748284345361912659, 290.200143080931503}, {1e-3, 0.139477199472198469, 8.08463666664997112},
        {5e-3, 0.117581991149642893, 9.21282300984193766},  {2e-2, 0.2488214895837221, 1.15593514687575515},
        {0.1, 0.282713598740550985, 0.109138076819688563},
    };
    const auto model = loudspeaker();
    for (const auto& [t, y, h] : references) {
        CHECK(stepResponse(model, {t})[0](0, 0) == Approx(y).epsilon(1e-10).margin(0.0));
        CHECK(impulseResponse(model, {t})[0](0, 0) == Approx(h).epsilon(1e-9).margin(0.0));
    }
    const double fs = 20000.0;
    const auto ladder = simulateByLadder(model, step(2001), fs, {0.3, 1e5, 3.0});
    const auto difference = simulateByDifference(model, step(2001), fs);
    const double largest = 0.28;  // A
    for (const auto& [t, y, h] : references) {
        const auto n = static_cast<Eigen::Index>(std::lround(t * fs));
        CHECK(std::abs(ladder(n, 0) - y) < 1e-5 * largest);
        if (n > 10)
            CHECK(std::abs(difference(n, 0) - y) < 5e-3 * largest);
    }
}

TEST_CASE("Beyond order 1 responses oscillate, and ladders follow")
{
    FractionalStateSpace model = circuit(1.5);
    model.form.A(0, 0) = -50.0;
    model.form.B(0, 0) = 1.0;
    // 1/(s (s^1.5 + 50)), mpmath as above
    for (const auto& [t, y] : {std::pair {0.01, 0.00074396703364485174}, std::pair {0.1, 0.01680500820516637},
                               std::pair {0.5, 0.0194858079842693954}})
        CHECK(stepResponse(model, {t})[0](0, 0) == Approx(y).epsilon(1e-11).margin(0.0));
    const auto ladder = simulateByLadder(model, step(501), 1000.0, {0.05, 5000.0, 4.0});
    const auto difference = simulateByDifference(model, step(501), 1000.0);
    for (const Eigen::Index n : {10, 100, 500}) {
        const double y = stepResponse(model, {n / 1000.0})[0](0, 0);
        CHECK(std::abs(ladder(n, 0) - y) < 1e-7);
        CHECK(std::abs(difference(n, 0) - y) < 5e-4);
    }
}

TEST_CASE("The expanded model has the response of the fractional one, for any input between samples a line")
{
    const auto model = loudspeaker();
    const auto wide = expanded(model, {1.0, 1e5, 4.0});
    CHECK(isStable(wide));
    for (const double f : {2.0, 57.0, 3000.0, 50000.0}) {
        const Complex truth = respond(model, {f})[0](0, 0);
        const Complex s(0.0, 2.0 * pi * f);
        Eigen::MatrixXcd resolvent = -wide.A.cast<Complex>();
        resolvent.diagonal().array() += s;
        const Complex found = (wide.C.cast<Complex>() * resolvent.lu().solve(wide.B.cast<Complex>()))(0, 0)
                              + wide.D(0, 0);
        // Four times the 7.3e-8 of s^1/2 in s^2, against a damping of 1/6.6 at resonance
        CHECK(std::abs(found - truth) < 2e-6 * std::abs(truth));
        // To rounding it is the model at the ladder's lambda.
        Eigen::MatrixXcd exact = -model.form.A.cast<Complex>();
        exact.diagonal().array() += s / ladderFor(0.5, {1.0, 1e5, 4.0}).power(s);
        const Complex there = (model.form.C.cast<Complex>() * exact.lu().solve(model.form.B.cast<Complex>()))(0, 0);
        CHECK(std::abs(found - there) < 1e-10 * std::abs(there));
    }
    // The hold is exact for a ramp: 1/(s + 3) answers t - (1 - exp(-3 t))/3, over 3.
    StateSpace lag;
    lag.A = Eigen::MatrixXd::Constant(1, 1, -3.0);
    lag.B = lag.C = Eigen::MatrixXd::Ones(1, 1);
    lag.D = Eigen::MatrixXd::Constant(1, 1, 0.5);
    const auto hold = linearHold(lag, 4.0);
    const Eigen::MatrixXd ramp = Eigen::VectorXd::LinSpaced(9, 0.0, 2.0);
    const auto y = simulate(hold.model, ramp, hold.startOf(Eigen::VectorXd::Zero(1)));
    for (Eigen::Index n = 0; n < 9; ++n) {
        const double t = 0.25 * static_cast<double>(n);
        CHECK(y(n, 0) == Approx((t - (1.0 - std::exp(-3.0 * t)) / 3.0) / 3.0 + 0.5 * t).margin(1e-14));
    }
}

TEST_CASE("Matignon's sector agrees with the matrices of the seed's theorems 3 and 4")
{
    Normal normal(11);
    int stable = 0, unstable = 0, allUnstable = 0;
    for (int trial = 0; trial < 400; ++trial) {
        FractionalStateSpace model = circuit(1.0);
        model.alpha = 0.05 + 1.9 * (trial % 40) / 39.0;
        const Eigen::Index n = 1 + trial % 3;
        Eigen::MatrixXd A(n, n);
        for (auto& a : A.reshaped())
            a = normal();
        model.form.A = A;
        model.form.B = Eigen::MatrixXd::Ones(n, 1);
        model.form.C = Eigen::MatrixXd::Ones(1, n);
        const double s = std::sin(0.5 * pi * model.alpha), c = std::cos(0.5 * pi * model.alpha);
        Eigen::MatrixXd extended(2 * n, 2 * n);
        // theorem 3: stable exactly when the eigenvalues of this have negative real parts
        if (model.alpha >= 1.0) {
            extended << A * s, A * c, -A * c, A * s;
            const double largest = extended.eigenvalues().real().maxCoeff();
            CHECK(isStable(model) == (largest < 0.0));
            // theorem 4: all eigenvalues of A within the sector exactly when those of this have negative real parts
        } else {
            extended << -A * s, A * c, -A * c, -A * s;
            const auto values = A.eigenvalues();
            bool all = true;
            for (const auto& value : values)
                all = all && std::abs(std::arg(value)) < 0.5 * pi * model.alpha;
            CHECK(all == (extended.eigenvalues().real().maxCoeff() < 0.0));
            if (n == 1 || all)
                CHECK(isStable(model) == !all);
            allUnstable += all;
        }
        (isStable(model) ? stable : unstable) += 1;
    }
    CHECK(stable > 50);
    CHECK(unstable > 50);
    CHECK(allUnstable > 20);
    // The step of a model just inside decays, of one just outside grows.
    for (const double alpha : {0.5, 1.5})
        for (const double side : {-0.03, 0.03}) {
            FractionalStateSpace model = circuit(alpha);
            const double angle = 0.5 * pi * alpha + side;
            model.form.A = (Eigen::MatrixXd(2, 2) << std::cos(angle), std::sin(angle), -std::sin(angle),
                            std::cos(angle))
                               .finished();
            model.form.B = Eigen::MatrixXd::Ones(2, 1);
            model.form.C = Eigen::MatrixXd::Ones(1, 2);
            CHECK(isStable(model) == (side > 0.0));
            CHECK(sectorMargin(model) == Approx(side).margin(1e-12));
            const double late = std::abs(impulseResponse(model, {400.0})[0](0, 0)),
                         early = std::abs(impulseResponse(model, {4.0})[0](0, 0));
            CHECK((late < early) == (side > 0.0));
        }
    FractionalStateSpace integrator = circuit(0.5);
    integrator.form.A.setZero();
    CHECK_FALSE(isStable(integrator));
}

TEST_CASE("A fractional model comes back from its document")
{
    const NamedFractionalStateSpace named {"loudspeaker", {"voltage"}, {"current"}, loudspeaker()};
    const DocumentFile file(toJson(named), fractionalStateSpaceFromJson);
    const auto read = file.read();
    CHECK(read.name == named.name);
    CHECK(read.inputs == named.inputs);
    CHECK(read.outputs == named.outputs);
    CHECK(read.model.alpha == 0.5);
    CHECK(read.model.form.A == named.model.form.A);
    CHECK(read.model.form.D == named.model.form.D);
    file.refuses("'alpha' is 2.0, expected a number between 0 and 2", [](auto& d) { d["alpha"] = 2.0; });
    file.refuses("sampleRate", [](auto& d) { d["form"]["sampleRate"] = 48000.0; });
    file.refuses("form", [](auto& d) { d.erase("form"); });
}

TEST_CASE("Fractional models refuse what they cannot do")
{
    auto model = circuit(0.5);
    refused(Error::Kind::usage, "inputs", [&] { simulateByLadder(model, Eigen::MatrixXd::Ones(9, 2), 100.0, {}); });
    refused(Error::Kind::usage, "sample rate", [&] { simulateByDifference(model, step(9), 0.0); });
    refused(Error::Kind::usage, "at least 0", [&] { stepResponse(model, {-1.0}); });
    model.alpha = 2.5;
    refused(Error::Kind::usage, "between 0 and 2", [&] { respond(model, {1.0}); });
    auto defective = loudspeaker();
    defective.form.A.setZero();
    defective.form.A.diagonal(1).setOnes();
    refused(Error::Kind::numerical, "eigenvectors", [&] { stepResponse(defective, {1.0}); });
}
