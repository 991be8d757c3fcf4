// SPDX-License-Identifier: GPL-3.0-or-later
// Models from one aperiodic record: responses with little leakage, linear starts, nonlinear fits that arrive, and a
// residual that tells whether they did.
#include "Engine/Estimate/Welch.h"
#include "Engine/Linear/Bilinear.h"
#include "Engine/Linear/LocalRational.h"
#include "Engine/Linear/Response.h"
#include "Engine/Linear/Simulation.h"
#include "Engine/Linear/SteiglitzMcBride.h"
#include "Engine/Polynomial/Pnlss/LinearStarts.h"
#include "Engine/Polynomial/Pnlss/ResidualTest.h"
#include "Engine/Polynomial/Pnlss/TangentTest.h"
#include "Engine/Signal/Fft.h"
#include "Linear/Problem.h"
#include "Polynomial/QuadraticRecord.h"
#include "Polynomial/RungeKutta.h"

#include <complex>
#include <ctime>
#include <numbers>

using namespace excursion;
using namespace excursion::test;
using Eigen::Index;

namespace {

/// The seed's loudspeaker (4.3.1): states position, velocity and current, acceleration heard, by the bilinear
/// transform.
StateSpace loudspeaker(double rate)
{
    const double m = 14.35e-3, r = 0.786, k = 1852.0, Bl = 4.95, L = 266e-6, R = 3.3;
    StateSpace s;
    s.A.resize(3, 3);
    s.A << 0.0, 1.0, 0.0, -k / m, -r / m, Bl / m, 0.0, -Bl / L, -R / L;
    s.B = Eigen::Vector3d(0.0, 0.0, 1.0 / L);
    s.C = s.A.row(1);
    s.D = Eigen::MatrixXd::Zero(1, 1);
    return toDiscrete(s, rate);
}

/// It with all products of two states in every equation (4.4.1), one period of a random-phase multisine from rest.
InputOutputRecord drawn(double rate, double strength, int seed)
{
    Normal normal(static_cast<std::uint64_t>(seed));
    return quadraticRecord(loudspeaker(rate), strength, rate > 45000.0 ? 0.03 : 0.033, normal);
}

/// Two thirds to fit, the last third to judge: as a take without periods is cut.
PnlssFit fitted(const InputOutputRecord& record, double rate, int order, int degree, TermMask mask)
{
    const Index N = record.input.rows(), cut = 2 * N / 3;
    const InputOutputRecord estimation {record.input.topRows(cut), record.output.topRows(cut), 0, false};
    std::vector<PnlssStart> starts;
    for (const auto& linear : linearStarts(estimation, rate, order))
        starts.push_back({withTerms(linear.model, degree, mask), {linear.initial}});
    PnlssFitOptions options;
    options.maximumIterations = 50;
    options.estimateInitialStates = options.judgeResidual = true;
    return fitPnlss(starts, {estimation}, {{record.input, record.output, cut, false, 0}}, options);
}

bool saysArrived(const PnlssFit& fit)
{
    return fit.estimationDb <= exactDb || (fit.untold && fit.untold->reachedBy(fit.estimationDb) == true);
}

/// A hardening oscillator from the middle of a motion, with noise of `db` on its position.
InputOutputRecord oscillation(const Eigen::VectorXd& u, double rate, double db, Normal& normal)
{
    const double w = 2.0 * std::numbers::pi * 60.0;
    const auto slope = [w](const Eigen::Vector2d& z, double force) {
        return Eigen::Vector2d(z[1], force - 0.2 * w * z[1] - w * w * (1.0 + 0.5 * z[0] * z[0]) * z[0]);
    };
    Eigen::Vector2d z(0.4, -50.0);
    Eigen::MatrixXd y(u.size(), 1);
    for (Index t = 0; t < u.size(); ++t) {
        y(t, 0) = z[0];
        z = advanced(slope, z, w * w * u[t], 1.0 / rate, 8);
    }
    const double size = std::pow(10.0, db / 20.0) * y.norm() / std::sqrt(static_cast<double>(y.rows()));
    for (auto& value : y.reshaped())
        value += size * normal();
    return {u, y, 0, false};
}

Eigen::VectorXd noiseOf(Index N, double rms, Normal& normal)
{
    Eigen::VectorXd u(N);
    double low = 0.0;
    for (auto& value : u)
        value = low += 0.3 * (normal() - low);
    return u * (rms * std::sqrt(static_cast<double>(N)) / u.norm());
}

std::span<const double> spanOf(const Eigen::MatrixXd& column)
{
    return {column.data(), static_cast<std::size_t>(column.rows())};
}

}  // namespace

TEST_CASE(
    "From one record out of a longer motion, a response has little leakage and iterative prefiltering finds the model")
{
    const double rate = 48000.0;
    const auto truth = loudspeaker(rate);
    Normal normal(5);
    Eigen::MatrixXd u = noiseOf(3000, 1.0, normal);
    const Eigen::MatrixXd y = simulate(truth, u, Eigen::Vector3d(1e-3, 2.0, 5.0));

    const auto errorOf = [&](const std::vector<double>& frequency, const auto& valueAt) {
        double error = 0.0, power = 0.0;
        for (std::size_t k = 0; k < frequency.size(); ++k) {
            const auto exact = Resolvent(truth).response(evaluationPoint(frequency[k], rate, 1.0))(0, 0);
            error += std::norm(valueAt(k) - exact);
            power += std::norm(exact);
        }
        return 10.0 * std::log10(error / power);
    };
    const auto localError = [&](int reach) {
        const auto response = localRationalResponse(spanOf(u), spanOf(y), rate, 1000, reach);
        REQUIRE(response.lines() > 500);
        return errorOf(response.frequency, [&](std::size_t k) { return response.value(static_cast<Index>(k), 0); });
    };
    const auto averaged = welch(spanOf(u), spanOf(y), rate).frf;
    const double welchError = errorOf(averaged.frequency, [&](std::size_t k) { return averaged.value[k]; });
    // 128 Hz to either side of a line are wide beside a resonance of 57 Hz; what they bend is all that is wrong.
    CHECK(localError(8) < welchError - 20.0);
    CHECK(localError(5) < localError(8) - 10.0);

    for (Index t = 0; t < u.rows(); ++t) {  // a sweep, which shows every frequency once
        const double s = static_cast<double>(t) / static_cast<double>(u.rows());
        u(t, 0) = std::sin(60.0 * (std::exp(4.0 * s) - 1.0));
    }
    const Eigen::MatrixXd swept = simulate(truth, u, Eigen::Vector3d(1e-3, 2.0, 5.0));
    const auto found = steiglitzMcBride(spanOf(u), spanOf(swept), rate, 3);
    const auto exact = poles(truth), estimated = poles(found);
    REQUIRE(estimated.size() == 3);
    for (std::size_t k = 0; k < 3; ++k)
        CHECK(std::abs(estimated[k] - exact[k]) < 1e-6);

    refused(Error::Kind::data, "64", [&] { localRationalResponse(spanOf(u.topRows(10)), spanOf(y), rate); });
    const Eigen::MatrixXd silence = Eigen::MatrixXd::Zero(200, 1);
    refused(Error::Kind::data, "zero", [&] { localRationalResponse(spanOf(silence), spanOf(silence), rate); });
    refused(Error::Kind::data, "samples", [&] { steiglitzMcBride(spanOf(silence), spanOf(silence), rate, 30); });
}

TEST_CASE("The seed's loudspeaker arrives from one record of either rate and sign")
{
    for (const double rate : {48000.0, 44100.0})
        for (const double strength : {1e-5, -1e-5}) {
            const auto fit = fitted(drawn(rate, strength, 21), rate, 3, 2, TermMask::statesOnly);
            CAPTURE(rate, strength, fit.message, fit.iterations);
            CHECK(fit.estimationDb < -120.0);
            CHECK(fit.validationDb < -110.0);
            CHECK(fit.stable);
        }
}

TEST_CASE("The seed's loudspeaker arrives from 46 of 48 records, and the others are told", "[.minutes]")
{
    int arrived = 0, falselyTold = 0;
    double longest = 0.0;
    for (const double rate : {48000.0, 44100.0})
        for (const double strength : {1e-5, -1e-5})
            for (int seed = 1; seed <= 12; ++seed) {
                const auto record = drawn(rate, strength,
                                          seed + (rate > 45000.0 ? 100 : 0) + (strength > 0.0 ? 50 : 0));
                const auto begin = std::clock();
                const auto fit = fitted(record, rate, 3, 2, TermMask::statesOnly);
                longest = std::max(longest, static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
                const bool good = fit.estimationDb < -120.0;
                arrived += good ? 1 : 0;
                falselyTold += !good && saysArrived(fit) ? 1 : 0;
            }
    CAPTURE(arrived, falselyTold, longest);
    CHECK(arrived >= 46);
    CHECK(falselyTold == 0);
    CHECK(longest < 3.0);
}

TEST_CASE(
    "An oscillator's record with noise is fitted to the noise, which the residual tells; what is far from it is not")
{
    const double rate = 4000.0;
    Normal normal(9);
    for (const double db : {-60.0, -75.0}) {
        const auto record = oscillation(noiseOf(3000, 0.5, normal), rate, db, normal);
        const auto fit = fitted(record, rate, 2, 3, TermMask::full);
        CAPTURE(db, fit.estimationDb, fit.untold ? fit.untold->db : 0.0, fit.iterations);
        CHECK(fit.estimationDb == Approx(db).margin(1.5));
        CHECK(fit.validationDb < db + 4.0);
        REQUIRE(fit.untold.has_value());
        CHECK(saysArrived(fit));
        CHECK(fit.untold->db == Approx(db).margin(2.0));

        // The best linear model leaves what the input tells.
        const auto linear = linearStarts(record, rate, 2).front();
        const auto left = untoldNoise(withTerms(linear.model, 2), {record}, {linear.initial});
        REQUIRE(left.has_value());
        CAPTURE(linear.errorDb, left->db);
        CHECK(linear.errorDb > db + 20.0);
        CHECK(left->db < linear.errorDb - 2.0 * atUntoldDb);
    }
}

TEST_CASE("Noise of any colour passes for noise")
{
    Normal normal(17);
    const auto truth = loudspeaker(8000.0);
    for (const double memory : {0.0, 0.9, 0.99}) {
        const Eigen::MatrixXd u = noiseOf(4000, 1.0, normal);
        Eigen::MatrixXd y = simulate(truth, u);
        double state = 0.0;
        for (auto& value : y.reshaped())
            value += 1e-3 * (state = memory * state + normal());
        const InputOutputRecord record {u, y, 0, false};
        const auto error = relativeErrorDb(withTerms(truth, 2), {record});
        const auto left = untoldNoise(withTerms(truth, 2), {record}, {});
        CAPTURE(memory, error);
        REQUIRE(left.has_value());
        CHECK(left->db > error - atUntoldDb);
    }
}

TEST_CASE("A force that the model lacks is told apart from noise, though its motion is slow beside a sample")
{
    const double rate = 8000.0, w = 2.0 * std::numbers::pi * 60.0, db = -77.0;
    Normal normal(33);
    StateSpace linear;  // position and what it moves in a sample, Euler's rule with the new velocity
    const double kT = w * w / (rate * rate), stays = 1.0 - 0.2 * w / rate;
    linear.sampleRate = rate;
    linear.A.resize(2, 2);
    linear.A << 1.0 - kT, stays, -kT, stays;
    linear.B = Eigen::Vector2d(kT, kT);
    linear.C = Eigen::RowVector2d(1.0, 0.0);
    linear.D = Eigen::MatrixXd::Zero(1, 1);
    auto truth = withTerms(linear, monomialsNamed("x1^3,x1^5", 2, 1));
    truth.E.col(0) = -0.5 * linear.B;
    truth.E.col(1) = -0.006 * linear.B;
    auto model = withTerms(linear, monomialsNamed("x1^3", 2, 1));
    model.E.col(0) = truth.E.col(0);
    const Eigen::MatrixXd u = noiseOf(3700, 0.3, normal), y = simulate(truth, u);
    Eigen::MatrixXd noise(u.rows(), 1);
    double state = 0.0;
    for (auto& value : noise.reshaped())
        value = state = 0.8 * state + normal();
    noise *= std::pow(10.0, db / 20.0) * y.norm() / noise.norm();
    const InputOutputRecord record {u, y + noise, 0, false};
    const auto error = relativeErrorDb(model, {record});
    const auto left = untoldNoise(model, {record}, {});
    REQUIRE(left.has_value());
    CAPTURE(error, left->db);
    CHECK(error > db + 10.0);
    CHECK(left->leastDb == Approx(db).margin(2.0));
    CHECK(left->reachedBy(error) == false);
    const auto off = offTangent(truth, {record}, {});
    REQUIRE(off.has_value());
    CHECK(10.0 * std::log10(off->power / off->alike / record.output.squaredNorm()) == Approx(db).margin(1.0));
    CHECK_FALSE(offTangent(truth, {{u.topRows(60), y.topRows(60), 0, false}}, {}).has_value());
}

TEST_CASE("A fit is chosen where it was fitted, and what was held out tells whether it holds elsewhere")
{
    const double rate = 8000.0;
    const auto truth = loudspeaker(rate);
    Normal normal(3);
    const Eigen::MatrixXd u = noiseOf(300, 1.0, normal), y = simulate(truth, u);
    const std::vector<InputOutputRecord> loud {{10.0 * u, 10.0 * y, 0, false}}, quiet {{u, y, 100, false}};
    // The same relative error of a signal 20 dB below is one 20 dB below.
    const double shape = 10.0 * std::log10((y.squaredNorm() / 300.0) / (y.bottomRows(200).squaredNorm() / 200.0));
    CHECK(heldOutDb(-50.0, loud, -50.0, quiet) == Approx(-20.0 - shape).margin(1e-9));
    CHECK(heldOutDb(-50.0, quiet, -40.0, loud) == Approx(30.0 + shape).margin(1e-9));

    // A sweep: its last third is one of other frequencies, and quieter.
    const Index N = 2400;
    Eigen::VectorXd swept(N);
    for (Index t = 0; t < N; ++t)
        swept[t] = 0.6
                   * std::sin(0.3 * 60.0 * 2.0 * std::numbers::pi / 8.0
                              * (std::exp(8.0 * static_cast<double>(t) / static_cast<double>(N) * 0.45) - 1.0));
    const auto record = oscillation(swept, 4000.0, -75.0, normal);
    const auto fit = fitted(record, 4000.0, 2, 3, TermMask::full);
    CAPTURE(fit.estimationDb, fit.validationDb, fit.untold ? fit.untold->db : 0.0, fit.iterations);
    CHECK(saysArrived(fit));
    CHECK(fit.estimationDb < -72.0);
}

TEST_CASE("Several starts must be of one structure")
{
    const auto truth = loudspeaker(8000.0);
    const Eigen::MatrixXd u = Eigen::MatrixXd::Ones(50, 1);
    const std::vector<InputOutputRecord> records {{u, u, 0, false}};
    refused(Error::Kind::usage, "no start", [&] { fitPnlss(std::vector<PnlssStart> {}, records, {}); });
    refused(Error::Kind::usage, "one structure", [&] {
        fitPnlss(std::vector<PnlssStart> {{withTerms(truth, 2), {}}, {withTerms(truth, 3), {}}}, records, {});
    });
    refused(Error::Kind::usage, "initial state", [&] {
        fitPnlss(std::vector<PnlssStart> {{withTerms(truth, 2), {Eigen::VectorXd::Zero(2)}}}, records, {});
    });
}
