// SPDX-License-Identifier: GPL-3.0-or-later
// Duffing's and Van der Pol's oscillators [B 4.1.3], integrated here by Runge and Kutta's rule, as polynomial
// state-space models.
#include "Engine/Polynomial/Pnlss/PnlssFit.h"
#include "Linear/Problem.h"
#include "Polynomial/RungeKutta.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <functional>
#include <numbers>

using namespace excursion;
using namespace excursion::test;
using Eigen::Index;
using Eigen::Vector2d;
using Eigen::VectorXd;

namespace {

using std::numbers::pi;

/// dz/dt of state and input.
using Flow = std::function<Vector2d(const Vector2d&, double)>;

Flow duffing()
{
    return [](const Vector2d& z, double u) {
        const double m = 14.35e-3, r = 0.786, k = 1852.0, q2 = 3.33e5;
        return Vector2d(z[1], (u - r * z[1] - k * (1.0 + q2 * z[0] * z[0]) * z[0]) / m);
    };
}

Flow vanDerPol(double epsilon)
{
    return [epsilon](const Vector2d& z, double u) {
        return Vector2d(z[1], u - z[0] + epsilon * (1.0 - z[0] * z[0]) * z[1]);
    };
}

/// Positions at the samples of an input; the state goes on.
VectorXd positions(const Flow& flow, Vector2d& z, const VectorXd& u, double T, int steps = 8)
{
    VectorXd y(u.size());
    for (Index t = 0; t < u.size(); ++t) {
        y[t] = z[0];
        z = advanced(flow, z, u[t], T, steps);
    }
    return y;
}

VectorXd sine(double amplitude, double frequency, double T, Index N, double phase = 0.0)
{
    VectorXd u(N);
    for (Index t = 0; t < N; ++t)
        u[t] = amplitude * std::sin(2.0 * pi * frequency * T * static_cast<double>(t) + phase);
    return u;
}

/// A step of the state of a model of order 2, written out.
Vector2d stepped(const Pnlss& m, const Vector2d& x, double u)
{
    VectorXd p(m.terms());
    for (Index k = 0; k < m.terms(); ++k)
        p[k] = std::pow(x[0], m.exponents(k, 0)) * std::pow(x[1], m.exponents(k, 1)) * std::pow(u, m.exponents(k, 2));
    return m.linear.A * x + m.linear.B * u + m.E * p;
}

/// Lyapunov's largest exponent, 1/s: the mean growth of a small distance, brought back after every sample. @param next
/// a sample of any system
template <class Next>
double lyapunov(Next next, Vector2d z, const VectorXd& u, double T, Index transient)
{
    const double size = 1e-8 * (1.0 + z.norm());
    Vector2d other = z + Vector2d(size, 0.0);
    double sum = 0.0;
    for (Index t = 0; t < u.size(); ++t) {
        z = next(z, u[t]);
        other = next(other, u[t]);
        const double apart = (other - z).norm();
        if (!std::isfinite(apart) || apart == 0.0)
            return std::numeric_limits<double>::quiet_NaN();
        if (t >= transient)
            sum += std::log(apart / size);
        other = z + (size / apart) * (other - z);
    }
    return sum / (static_cast<double>(u.size() - transient) * T);
}

/// Random phases in a band, as long as the record.
VectorXd multisineOf(Index N, double T, double low, double high, double rms, Normal& normal)
{
    VectorXd u = VectorXd::Zero(N);
    for (Index k = 1; k < N / 2; ++k) {
        const double f = static_cast<double>(k) / (static_cast<double>(N) * T), a = normal(), b = normal();
        if (f < low || f > high)
            continue;
        for (Index t = 0; t < N; ++t) {
            const double angle = 2.0 * pi * static_cast<double>(k * t % N) / static_cast<double>(N);
            u[t] += a * std::cos(angle) + b * std::sin(angle);
        }
    }
    return u * (rms * std::sqrt(static_cast<double>(N)) / u.norm());
}

/// A linear start: y(t+1) = a y(t) + b y(t-1) + c u(t) + d u(t-1) by least squares, with all monomials of the states'
/// and input's next values.
Pnlss startOn(const std::vector<InputOutputRecord>& records, double T, int degree)
{
    Eigen::Matrix4d square = Eigen::Matrix4d::Zero();
    Eigen::Vector4d right = Eigen::Vector4d::Zero();
    for (const auto& record : records)
        for (Index t = 1; t + 1 < record.output.rows(); ++t) {
            const Eigen::Vector4d r(record.output(t, 0), record.output(t - 1, 0), record.input(t, 0),
                                    record.input(t - 1, 0));
            square += r * r.transpose();
            right += r * record.output(t + 1, 0);
        }
    const Eigen::Vector4d c = square.ldlt().solve(right);
    StateSpace linear;
    linear.sampleRate = 1.0 / T;
    linear.A = Eigen::Matrix2d {{c[0], 1.0}, {c[1], 0.0}};
    linear.B = Vector2d(c[2], c[3]);
    linear.C = Eigen::RowVector2d(1.0, 0.0);
    linear.D = Eigen::MatrixXd::Zero(1, 1);
    auto start = withTerms(linear, degree);
    start.free.bottomRows(1).setConstant(false);  // the position is a state
    return start;
}

/// A run cut into short records, each with a first state of its own: over so short a time chaos has not grown.
std::vector<InputOutputRecord> cut(const VectorXd& u, const VectorXd& y, Index length)
{
    std::vector<InputOutputRecord> records;
    for (Index first = 0; first + length <= u.size(); first += length)
        records.push_back({u.segment(first, length), y.segment(first, length), 0, false});
    return records;
}

std::vector<double> sorted(const VectorXd& y)
{
    std::vector<double> values(y.data(), y.data() + y.size());
    std::sort(values.begin(), values.end());
    return values;
}

/// The largest distance of two distributions (Kolmogorov and Smirnov).
double apart(const VectorXd& a, const VectorXd& b)
{
    const auto x = sorted(a), y = sorted(b);
    double largest = 0.0;
    for (std::size_t k = 0; k < x.size(); ++k) {
        const auto below = std::lower_bound(y.begin(), y.end(), x[k]) - y.begin();
        const double here = static_cast<double>(k) / static_cast<double>(x.size()),
                     there = static_cast<double>(below) / static_cast<double>(y.size());
        largest = std::max(largest, std::abs(here - there));
    }
    return largest;
}

/// rms of the difference over samples first .. last, relative to the rms of the whole.
double missed(const VectorXd& truth, const VectorXd& model, Index first, Index last)
{
    const auto rms = [](const VectorXd& x) { return x.norm() / std::sqrt(static_cast<double>(x.size())); };
    return rms((truth - model).segment(first, last - first)) / rms(truth);
}

}  // namespace

TEST_CASE("Duffing's oscillator at moderate levels is identified far below any measurement, level by level", "[slow]")
{
    const double T = 1.0 / 16000.0;
    const Index N = 8192;
    const auto flow = duffing();
    Normal normal(1);
    Pnlss model;
    for (const auto& [newton, db] : {std::pair {0.5, -95.0}, std::pair {1.0, -80.0}}) {
        std::vector<InputOutputRecord> records;
        for (int k = 0; k < 3; ++k) {
            const auto u = multisineOf(N, T, 10.0, 200.0, newton, normal);
            Vector2d z = Vector2d::Zero();
            positions(flow, z, u.replicate(3, 1), T);
            records.push_back(periodicRecord(u, positions(flow, z, u, T), N));
        }
        const std::vector validation {records.back()};
        records.pop_back();
        const auto start = model.terms() == 0 ? startOn(records, T, 3) : model;
        PnlssFitOptions options;
        options.maximumIterations = 40;
        const auto fit = fitPnlss(start, records, {}, options);
        CAPTURE(newton, relativeErrorDb(start, validation), fit.estimationDb, relativeErrorDb(fit.model, validation));
        CHECK(relativeErrorDb(start, validation) > (newton == 0.5 ? -20.0 : db));
        CHECK(fit.estimationDb < db);
        CHECK(relativeErrorDb(fit.model, validation) < db);
        CHECK(fit.stable);
        model = fit.model;
    }
}

TEST_CASE(
    "Duffing's oscillator in chaos: the model predicts ten periods and has the oscillator's exponent and amplitudes",
    "[slow]")
{
    // [B 4.1.3] drives with 100 N and integrates by Euler's rule at 44.1 kHz, whose error is a negative damping as
    // large as the oscillator's own. The equation itself answers 100 N with a period of its own, and 110 N with chaos.
    const double T = 1.0 / 16000.0, f = 56.0;
    const auto flow = duffing();
    const auto truth = [&](const Vector2d& z, double u) { return advanced(flow, z, u, T, 4); };
    const auto exponentAt = [&](double newton) {
        return lyapunov(truth, Vector2d(1e-4, 0.0), sine(newton, f, T, 160000), T, 60000);
    };
    CHECK(exponentAt(100.0) < 0.0);
    CHECK(exponentAt(110.0) > 15.0);

    // The start comes from a level at which nothing is chaotic.
    Normal normal(2);
    const auto quiet = multisineOf(8192, T, 10.0, 200.0, 0.5, normal);
    Vector2d z = Vector2d::Zero();
    positions(flow, z, quiet.replicate(3, 1), T);
    const std::vector low {periodicRecord(quiet, positions(flow, z, quiet, T), 8192)};
    PnlssFitOptions options;
    options.maximumIterations = 30;
    const auto start = fitPnlss(startOn(low, T, 3), low, {}, options).model;

    const auto drive = sine(110.0, f, T, 16000 * 41);
    z = Vector2d(1e-4, 0.0);
    positions(flow, z, drive.head(16000), T);  // a whole number of periods
    const Vector2d begin = z;
    const VectorXd y = positions(flow, z, drive.tail(16000 * 40), T, 4);
    options.estimateInitialStates = true;
    options.search = PnlssSearch::guided;
    options.guideGains = {0.3, 0.1, 0.03};
    options.maximumIterations = 40;
    const auto fit = fitPnlss(start, cut(drive.head(16000), y.head(16000), 400), {}, options);
    REQUIRE(fit.initialStates.size() == 40);
    const VectorXd played = simulate(fit.model, drive.tail(16000 * 40), fit.initialStates[0]);
    REQUIRE(played.allFinite());

    const auto own = lyapunov(truth, begin, drive, T, 16000);
    const auto found = lyapunov([&](const Vector2d& x, double u) { return stepped(fit.model, x, u); },
                                fit.initialStates[0], drive, T, 16000);
    Vector2d beside = begin + Vector2d(1e-6, 0.0);
    const VectorXd again = positions(flow, beside, drive.tail(16000 * 40), T, 4);
    CAPTURE(fit.estimationDb, own, found, missed(y, played, 0, 2857), missed(y, played, 320000, 640000));
    CAPTURE(apart(y.cwiseAbs(), played.cwiseAbs()), apart(y.cwiseAbs(), again.cwiseAbs()));
    CHECK(fit.estimationDb < -90.0);
    CHECK(fit.stable);
    CHECK(own > 15.0);
    CHECK(found == Approx(own).epsilon(0.15));
    CHECK(missed(y, played, 0, 2857) < 2e-3);  // ten periods, in which a small error grows by e^4
    // no model keeps up for ever; another run of the oscillator does not either
    CHECK(missed(y, played, 320000, 640000) > 0.1);
    CHECK(missed(y, again, 320000, 640000) > 0.1);
    CHECK(apart(y.cwiseAbs(), again.cwiseAbs()) < 0.01);
    CHECK(apart(y.cwiseAbs(), played.cwiseAbs()) < 0.01);
}

TEST_CASE("Van der Pol's oscillator is identified, and the model says that its linear part is not stable", "[slow]")
{
    // Driven strongly enough to follow
    const double T = 0.05;
    const auto flow = vanDerPol(1.0);
    Normal normal(3);
    const auto u = multisineOf(16384, T, 0.02, 1.0, 3.0, normal);
    Vector2d z(1.0, 0.0);
    const VectorXd y = positions(flow, z, u, T);
    auto records = cut(u, y, 512);
    const std::vector<InputOutputRecord> validation {{u.tail(8192), y.tail(8192), 4096, false}};
    records.resize(16);
    PnlssFitOptions options;
    options.estimateInitialStates = true;
    options.search = PnlssSearch::guided;
    options.guideGains = {1.0, 0.3, 0.1};
    options.maximumIterations = 60;
    for (const int degree : {3, 5}) {
        const auto fit = fitPnlss(startOn(records, T, degree), records, {}, options);
        CAPTURE(degree, fit.estimationDb, relativeErrorDb(fit.model, validation), fit.message);
        CHECK(fit.estimationDb < (degree == 3 ? -44.0 : -60.0));
        CHECK(relativeErrorDb(fit.model, validation) < (degree == 3 ? -42.0 : -54.0));
        CHECK_FALSE(fit.stable);
        CHECK_FALSE(isStable(fit.model.linear));
    }
}

TEST_CASE("Van der Pol's oscillator in chaos: the model predicts, and has the oscillator's exponent and amplitudes",
          "[slow]")
{
    // epsilon 5, amplitude 5, w 2.466 (Parlitz and Lauterborn 1987)
    const double T = 0.02, f = 2.466 / (2.0 * pi);
    const auto flow = vanDerPol(5.0);
    const auto truth = [&](const Vector2d& z, double u) { return advanced(flow, z, u, T, 4); };
    // The dissertation's 8.53, 1.2 and 2 pi/10 is at most quasi-periodic.
    const auto seed = vanDerPol(8.53);
    CHECK(std::abs(lyapunov([&](const Vector2d& z, double u) { return advanced(seed, z, u, T, 8); }, Vector2d(1.0, 0.0),
                            sine(1.2, 0.1, T, 400000), T, 50000))
          < 0.02);

    const auto drive = sine(5.0, f, T, 105000);
    Vector2d z(1.0, 0.0);
    positions(flow, z, drive.head(5000), T);
    const Vector2d begin = z;
    const VectorXd u = drive.tail(100000), y = positions(flow, z, u, T, 4);
    const auto records = cut(u.head(12000), y.head(12000), 250);
    PnlssFitOptions options;
    options.estimateInitialStates = true;
    options.search = PnlssSearch::guided;
    options.guideGains = {1.0, 0.3, 0.1, 0.03};
    options.maximumIterations = 120;
    const auto fit = fitPnlss(startOn(records, T, 5), records, {}, options);
    REQUIRE(fit.initialStates.size() == 48);
    const VectorXd played = simulate(fit.model, u, fit.initialStates[0]);
    REQUIRE(played.allFinite());
    const auto own = lyapunov(truth, begin, u, T, 2000);
    const auto found = lyapunov([&](const Vector2d& x, double v) { return stepped(fit.model, x, v); },
                                fit.initialStates[0], u, T, 2000);
    Vector2d beside = begin + Vector2d(1e-6, 0.0);
    const VectorXd again = positions(flow, beside, u, T, 4);
    CAPTURE(fit.estimationDb, own, found, missed(y, played, 0, 500), missed(y, played, 50000, 100000), apart(y, played),
            apart(y, again));
    CHECK(fit.estimationDb < -75.0);
    CHECK_FALSE(fit.stable);  // at rest it is not: it runs into its cycle
    CHECK(own > 0.05);
    CHECK(found == Approx(own).epsilon(0.15));
    CHECK(missed(y, played, 0, 500) < 3e-4);  // four periods of the drive
    CHECK(missed(y, played, 50000, 100000) > 0.3);
    CHECK(apart(y, again) < 0.04);
    CHECK(apart(y, played) < 0.04);
}
