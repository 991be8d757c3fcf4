// SPDX-License-Identifier: GPL-3.0-or-later
// Models, their transforms, responses and simulation against closed forms.
#include "Engine/Linear/Bilinear.h"
#include "Engine/Linear/Response.h"
#include "Engine/Linear/Simulation.h"
#include "Engine/Linear/StateSpaceFile.h"
#include "DocumentFile.h"
#include "Linear/Problem.h"

#include <Eigen/LU>
#include <nlohmann/json.hpp>

#include <numbers>

using namespace excursion;
using namespace excursion::test;
using Complex = std::complex<double>;

namespace {

/// A resonance and, as a second output, 5 / (s + 70); in some basis.
StateSpace twoOutputs()
{
    StateSpace model;
    model.A = Eigen::MatrixXd::Zero(3, 3);
    model.A << -10, 200, 0, -200, -10, 0, 0, 0, -70;
    model.B = Eigen::MatrixXd(3, 1);
    model.B << 1, 0, 1;
    model.C = Eigen::MatrixXd(2, 3);
    model.C << 1, 0.1, 0, 0, 0, 5;
    model.D = Eigen::MatrixXd::Zero(2, 1);
    Eigen::MatrixXd T(3, 3);
    T << 2, 1, 0.3, -1, 3, 0.2, 0.4, -0.7, 1.5;
    return transformed(model, T);
}

/// C adj(s - A) B by hand: x1 = (s + 10)/q, x2 = -200/q with q = (s + 10)^2 + 200^2.
Complex firstOutput(Complex s)
{
    const Complex q = (s + 10.0) * (s + 10.0) + 40000.0;
    return (s + 10.0 - 20.0) / q;
}

}  // namespace

TEST_CASE("A continuous-time model answers as its transfer function does")
{
    const auto model = twoOutputs();
    REQUIRE(model.isValid());
    const std::vector<double> f {0.0, 0.3, 10.0, 31.9, 500.0, 1e5};
    const auto responses = respond(model, f);
    for (std::size_t k = 0; k < f.size(); ++k) {
        const Complex s(0.0, 2.0 * std::numbers::pi * f[k]);
        CHECK(std::abs(responses[k](0, 0) - firstOutput(s)) < 1e-13 * std::abs(firstOutput(s)));
        CHECK(std::abs(responses[k](1, 0) - 5.0 / (s + 70.0)) < 1e-13 * std::abs(5.0 / (s + 70.0)));
    }
    const auto p = poles(model);
    REQUIRE(p.size() == 3);
    CHECK(std::abs(p[0] - Complex(-70, 0)) < 1e-9);
    CHECK(std::abs(p[1] - Complex(-10, -200)) < 1e-9);
    CHECK(stabilityMargin(model) == Approx(10.0));
    CHECK(isStable(model));
}

TEST_CASE("The bilinear transform keeps the response at warped frequencies, and comes back")
{
    const auto model = twoOutputs();
    const double rate = 900.0;
    const auto discrete = toDiscrete(model, rate);
    CHECK(discrete.sampleRate == rate);
    for (const double f : {1.0, 31.0, 200.0, 2000.0}) {
        const auto continuous = respond(model, {f})[0];
        const auto warped = respond(discrete, {warpedFrequency(f, rate)})[0];
        CHECK((continuous - warped).norm() < 1e-12 * continuous.norm());
    }
    // s -> (2 fs + s)/(2 fs - s) of the poles
    for (const auto& s : {Complex(-10, 200), Complex(-70, 0)}) {
        const Complex z = (2.0 * rate + s) / (2.0 * rate - s);
        double nearest = 1.0;
        for (const auto& pole : poles(discrete))
            nearest = std::min(nearest, std::abs(pole - z));
        CHECK(nearest < 1e-12);
    }
    const auto back = toContinuous(discrete);
    CHECK((back.A - model.A).norm() < 1e-9 * model.A.norm());
    CHECK((back.B - model.B).norm() < 1e-9 * model.B.norm());
    CHECK((back.C - model.C).norm() < 1e-9 * model.C.norm());
    CHECK((back.D - model.D).norm() < 1e-9);
    refused(Error::Kind::usage, "already", [&] { toDiscrete(discrete, rate); });
    refused(Error::Kind::usage, "already", [&] { toContinuous(model); });
    auto atMinusOne = discrete;
    atMinusOne.A = -Eigen::MatrixXd::Identity(3, 3);
    refused(Error::Kind::numerical, "z = -1", [&] { toContinuous(atMinusOne); });
}

TEST_CASE("Zeros are where the response vanishes, at infinity none")
{
    StateSpace model;  // (z - 0.5)(z - 1.25) / (z^3 - 0.3 z^2 + 0.1 z - 0.05) in controller form
    model.sampleRate = 1.0;
    model.A.resize(3, 3);
    model.A << 0.3, -0.1, 0.05, 1, 0, 0, 0, 1, 0;
    model.B.resize(3, 1);
    model.B << 1, 0, 0;
    model.C.resize(1, 3);
    model.C << 1, -1.75, 0.625;
    model.D = Eigen::MatrixXd::Zero(1, 1);
    const auto z = zeros(model);
    REQUIRE(z.size() == 2);
    CHECK(std::abs(z[0] - 0.5) < 1e-10);
    CHECK(std::abs(z[1] - 1.25) < 1e-10);
    refused(Error::Kind::usage, "as many inputs", [] { zeros(twoOutputs()); });
}

TEST_CASE("A simulation is the sum of powers")
{
    StateSpace model;
    model.sampleRate = 100.0;
    model.A = Eigen::MatrixXd::Constant(1, 1, 0.75);
    model.B = Eigen::MatrixXd::Constant(1, 1, 2.0);
    model.C = Eigen::MatrixXd::Constant(1, 1, 0.5);
    model.D = Eigen::MatrixXd::Constant(1, 1, 3.0);
    const Eigen::MatrixXd step = Eigen::MatrixXd::Ones(40, 1);
    const auto y = simulate(model, step);
    for (int t = 0; t < 40; ++t)
        CHECK(y(t, 0) == Approx(3.0 + 4.0 * (1.0 - std::pow(0.75, t))).epsilon(1e-13));
    Eigen::MatrixXd u(7, 1);
    u << 1, -2, 0.5, 3, 0, 0, -1;
    const Eigen::VectorXd x0 = Eigen::VectorXd::Constant(1, 4.0);  // what the first samples have left
    const auto whole = simulate(model, step.topRows(7) + u, x0);
    CHECK((whole - simulate(model, step.topRows(7), x0) - simulate(model, u)).norm() < 1e-13);
    refused(Error::Kind::usage, "continuous", [&] { simulate(twoOutputs(), u); });
}

TEST_CASE("A linear model is kept and read again, bit for bit, and what does not fit is refused")
{
    const auto model = twoOutputs();
    const DocumentFile file(toJson(NamedStateSpace {"box", {"voltage"}, {"current", "pressure"}, model}),
                            stateSpaceFromJson);
    const auto read = file.read();
    CHECK(read.outputs == std::vector<std::string> {"current", "pressure"});
    CHECK((read.model.A.array() == model.A.array()).all());
    CHECK((read.model.B.array() == model.B.array()).all());
    CHECK((read.model.C.array() == model.C.array()).all());
    CHECK(read.model.sampleRate == 0.0);
    file.refuses("version", [](auto& d) { d["version"] = 2; });
    file.refuses("A[1]", [](auto& d) { d["A"][1].erase(0); });
    file.refuses("C", [](auto& d) { d["C"].erase(1); });
    file.refuses("B[0]", [](auto& d) { d["B"][0][0] = nullptr; });
    file.refuses("inputs", [](auto& d) { d["inputs"] = nlohmann::json::array(); });
}
