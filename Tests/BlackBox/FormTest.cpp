// SPDX-License-Identifier: GPL-3.0-or-later
// All classes in the form in which they are played, against the simulation of each class.
#include "BlackBox/RandomModels.h"

#include "Engine/Error.h"

#include <catch2/catch.hpp>

using namespace excursion;

namespace {

Eigen::VectorXd drive(const Stimulus& stimulus, double sampleRate, std::uint64_t seed)
{
    const auto period = playedAs(stimulus, sampleRate, 8192, seed);
    return Eigen::Map<const Eigen::VectorXd>(period.data(), 8192);
}

double errorDb(const Eigen::VectorXd& found, const Eigen::VectorXd& truth)
{
    return decibelsOf((found - truth).squaredNorm() / truth.squaredNorm());
}

/// As an audio thread plays it.
Eigen::VectorXd stepped(const BlackBox& box, const Region& region, const Eigen::VectorXd& input)
{
    BlackBoxStep step(box, region);
    std::vector<double> x(step.states(), 0.0), z(step.seen() + 1, 0.0), q(step.combinations(), 0.0);
    Eigen::VectorXd output(input.size());
    for (Eigen::Index t = 0; t < input.size(); ++t) {
        step.see(x.data(), input[t], z.data());
        step.combinationsAt(z.data(), input[t], nullptr, q.data());
        output[t] = step.advance(x.data(), input[t], q.data());
    }
    return output;
}

}  // namespace

TEST_CASE("A PNLSS model is played as it is simulated", "[form]")
{
    for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
        const auto stimulus = pinkStimulus(2.0);
        auto model = randomPnlss(seed, 48000.0, stimulus);
        model.F = 1e-3 * model.E.row(1) * model.linear.C(0, 0);  // also of the output
        const auto box = boxOf(model, stimulus);
        const auto u = drive(stimulus, 48000.0, seed);
        const Eigen::VectorXd truth = simulate(model, u).col(0);
        CHECK(errorDb(simulate(box, u), truth) < -200.0);
        CHECK(errorDb(stepped(box, visitedBy(box), u), truth) < -200.0);
    }
}

TEST_CASE("A fractional PNLSS model is played as it is simulated", "[form]")
{
    FractionalPnlss model;
    StateSpace form;
    const double w0 = 2.0 * std::numbers::pi * 60.0, L = 0.02;
    form.A = Eigen::MatrixXd {{0.0, 1.0, 0.0}, {-w0 * w0, -w0 / 2.0, 800.0}, {0.0, -1.0 / L, -4.0 / L}};
    form.B = Eigen::MatrixXd {{0.0}, {0.0}, {1.0 / L}};
    form.C = Eigen::MatrixXd {{0.0, 0.0, 1.0}};
    form.D = Eigen::MatrixXd::Zero(1, 1);
    form.sampleRate = 1.0;
    model.alpha = 0.6;
    model.fractional.resize(3);
    model.fractional << false, false, true;
    model.form = withTerms(form, monomialsNamed("x1^2,x1^3,x1*x2", 3, 1));
    model.form.linear.sampleRate = 0.0;
    const auto stimulus = pinkStimulus(2.0);
    const FractionalGrid grid {48000.0, 1, {1.0, 24000.0, 3.0}};
    const auto u = drive(stimulus, 48000.0, 5);
    // So strong that stiffness and induced voltage change by some tenths
    model.form.E(1, 0) = -0.3 * w0 * w0 / 3e-3;
    model.form.E(1, 1) = -0.3 * w0 * w0 / 9e-6;
    model.form.E(2, 2) = -0.2 / (L * 3e-3);
    auto box = blackBoxOf(model, grid);
    box.stimulus = stimulus;
    std::string reason;
    REQUIRE(box.isValid(&reason));
    const Eigen::VectorXd truth = simulate(model, u, grid).col(0);
    REQUIRE(truth.allFinite());
    auto plain = model;
    plain.form.E.setZero();
    const Eigen::VectorXd straight = simulate(plain, u, grid).col(0);
    CHECK(errorDb(truth, straight) > -40.0);
    CHECK(errorDb(simulate(box, u), truth) < -120.0);
    CHECK(errorDb(stepped(box, visitedBy(box), u), truth) < -100.0);
}

TEST_CASE("Block, NARX and Hammerstein models are played as they are simulated", "[form]")
{
    const auto stimulus = pinkStimulus(2.0);
    const auto u = drive(stimulus, 48000.0, 6);
    const auto base = randomPnlss(7, 48000.0, stimulus);
    BlockModel block;
    block.linear = base.linear;
    block.hammerstein = Eigen::Vector2d(0.02, 0.005);
    block.wiener = Eigen::Vector2d(20.0, 3e3);
    block.feedback = Eigen::Vector2d(5.0, 1e3);
    block.offset = 1e-5;
    CHECK(errorDb(simulate(blackBoxOf(block), u), simulate(block, u).col(0)) < -180.0);

    Narx narx;
    narx.sampleRate = 48000.0;
    narx.outputLags = 2;
    narx.inputLags = 2;
    narx.exponents = Exponents::Zero(6, 5);
    narx.coefficients.resize(6);
    const double pole = 0.99, angle = 0.02;
    for (int k = 0; k < 3; ++k)
        narx.exponents(k, k) = 1;
    narx.coefficients << 2.0 * pole * std::cos(angle), -pole * pole, 1e-3, -1e-5, -1e-6, 1e-6;
    narx.exponents(3, 0) = 2;
    narx.exponents(4, 0) = 1;
    narx.exponents(4, 4) = 2;  // y(t-1) u(t)^2; the last one is a constant
    CHECK(errorDb(simulate(blackBoxOf(narx), u), simulate(narx, u).col(0)) < -180.0);

    ParallelHammerstein hammerstein;
    hammerstein.sampleRate = 48000.0;
    hammerstein.filters = Eigen::MatrixXd::Zero(256, 3);
    for (int k = 0; k < 256; ++k) {
        hammerstein.filters(k, 0) = std::exp(-k / 25.0) * std::cos(0.1 * k);
        hammerstein.filters(k, 1) = 0.05 * std::exp(-k / 20.0) * std::sin(0.07 * k);
        hammerstein.filters(k, 2) = 0.01 * std::exp(-k / 15.0);
    }
    hammerstein.offset = 0.01;
    CHECK(errorDb(simulate(blackBoxOf(hammerstein, stimulus), u), simulate(hammerstein, u).col(0)) < -55.0);

    hammerstein.filters = Eigen::MatrixXd::Random(256, 2);  // no system of 60 states has such taps
    CHECK_THROWS_AS(blackBoxOf(hammerstein, stimulus), Error);
}

TEST_CASE("The stimulus of records comes back when it is played", "[form]")
{
    const auto stimulus = pinkStimulus(3.0);
    const auto period = playedAs(stimulus, 48000.0, 16384, 8);
    PnlssRecord record;
    record.input = Eigen::Map<const Eigen::VectorXd>(period.data(), 16384);
    record.output = record.input;
    record.periodic = true;
    const auto found = stimulusOf({record}, 48000.0);
    CHECK(found.rms == Approx(3.0).epsilon(1e-6));
    CHECK(found.peak == Approx(peakOf(period)));
    CHECK(found.frequency.size() == stimulus.frequency.size());
    for (std::size_t k = 0; k < found.power.size(); ++k)
        CHECK(found.power[k] == Approx(stimulus.power[k]).epsilon(0.01));
    record.input.setZero();
    CHECK_THROWS_AS(stimulusOf({record}, 48000.0), Error);
}
