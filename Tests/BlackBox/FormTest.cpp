// SPDX-License-Identifier: GPL-3.0-or-later
// All classes in the form in which they are played, against the simulation of each class.
#include "BlackBox/EveryClass.h"

#include "Engine/Error.h"
#include "Engine/Polynomial/FractionalPnlss/FractionalSimulation.h"
#include "Engine/Polynomial/Narx/NarxRecursion.h"

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
    const auto stimulus = pinkStimulus(2.0);
    const FractionalGrid grid = oneGrid();
    const auto model = oneFractionalPnlss();
    const auto u = drive(stimulus, 48000.0, 5);
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
    const auto block = oneBlockModel();
    CHECK(errorDb(simulate(blackBoxOf(block), u), simulate(block, u).col(0)) < -180.0);

    const auto narx = oneNarx();
    CHECK(errorDb(simulate(blackBoxOf(narx), u), simulate(narx, u).col(0)) < -180.0);

    auto hammerstein = oneHammerstein();
    CHECK(errorDb(simulate(blackBoxOf(hammerstein, stimulus), u), simulate(hammerstein, u).col(0)) < -55.0);

    hammerstein.filters = Eigen::MatrixXd::Random(256, 2);  // no system of 60 states has such taps
    CHECK_THROWS_AS(blackBoxOf(hammerstein, stimulus), Error);
}

TEST_CASE("The stimulus of records comes back when it is played", "[form]")
{
    const auto stimulus = pinkStimulus(3.0);
    const auto period = playedAs(stimulus, 48000.0, 16384, 8);
    InputOutputRecord record;
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
