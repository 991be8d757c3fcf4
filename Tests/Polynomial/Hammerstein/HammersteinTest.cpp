// SPDX-License-Identifier: GPL-3.0-or-later
// Parallel Hammerstein models against filters of which the response is known in closed form.
#include "Engine/Polynomial/Hammerstein/HammersteinFit.h"
#include "Engine/Polynomial/Hammerstein/HammersteinSweep.h"
#include "Engine/Polynomial/Hammerstein/ParallelHammersteinFile.h"
#include "Engine/Polynomial/InputOutputRecord.h"
#include "Engine/Signal/Level.h"
#include "Engine/Signal/Multisine.h"
#include "DocumentFile.h"
#include "Linear/Problem.h"

#include <nlohmann/json.hpp>

#include <numbers>

using namespace excursion;
using namespace excursion::test;
using Eigen::Index;

namespace {

/// (b0 + b1/z + b2/z^2) / (1 + a1/z + a2/z^2): the bilinear transform of an analog resonance (n0 + n1 s + n2 s^2) / (1
/// + s/Q + s^2), s in units of f0.
struct Resonance {
    double b0, b1, b2, a1, a2;

    Resonance(double f0, double Q, double n0, double n1, double n2, double rate)
    {
        const double c = 1.0 / std::tan(std::numbers::pi * f0 / rate), norm = 1.0 + c / Q + c * c;
        b0 = (n0 + n1 * c + n2 * c * c) / norm;
        b1 = 2.0 * (n0 - n2 * c * c) / norm;
        b2 = (n0 - n1 * c + n2 * c * c) / norm;
        a1 = 2.0 * (1.0 - c * c) / norm;
        a2 = (1.0 - c / Q + c * c) / norm;
    }
    std::complex<double> response(double f, double rate) const
    {
        const auto w = std::polar(1.0, -2.0 * std::numbers::pi * f / rate);
        return (b0 + w * (b1 + w * b2)) / (1.0 + w * (a1 + w * a2));
    }
    void addTo(Eigen::VectorXd& y, const Eigen::VectorXd& x) const
    {
        double x1 = 0, x2 = 0, y1 = 0, y2 = 0;
        for (Index t = 0; t < x.size(); ++t) {
            const double out = b0 * x[t] + b1 * x1 + b2 * x2 - a1 * y1 - a2 * y2;
            x2 = x1;
            x1 = x[t];
            y2 = y1;
            y1 = out;
            y[t] += out;
        }
    }
};

/// A branch of each kind of resonance, drawn: a low-pass, a band-pass, a high-pass, again.
std::vector<Resonance> drawnBranches(int degree, double rate, double lowest, std::uint64_t seed)
{
    Normal normal(seed);
    std::vector<Resonance> branches;
    for (int n = 1; n <= degree; ++n) {
        const double f0 = lowest * std::exp(std::abs(normal())), Q = 0.5 + 0.3 * std::abs(normal());
        const double gain = (n == 1 ? 1.0 : 0.1) * (1.0 + 0.3 * normal());
        const int kind = n % 3;
        branches.emplace_back(f0, Q, kind == 1 ? gain : 0.0, kind == 2 ? gain : 0.0, kind == 0 ? gain : 0.0, rate);
    }
    return branches;
}

Eigen::VectorXd played(const std::vector<Resonance>& branches, const Eigen::VectorXd& u)
{
    Eigen::VectorXd y = Eigen::VectorXd::Zero(u.size());
    for (std::size_t n = 0; n < branches.size(); ++n)
        branches[n].addTo(y, u.array().pow(static_cast<double>(n + 1)).matrix());
    return y;
}

/// Relative rms error in dB of one branch's response in a band.
double branchError(const ParallelHammerstein& model, Index branch, const Resonance& truth, double from, double to)
{
    std::vector<double> f;
    for (double x = from; x < to; x *= 1.01)
        f.push_back(x);
    const auto found = responses(model, f);
    double error = 0.0, power = 0.0;
    for (std::size_t k = 0; k < f.size(); ++k) {
        const auto G = truth.response(f[k], model.sampleRate);
        error += std::norm(found(static_cast<Index>(k), branch) - G);
        power += std::norm(G);
    }
    return 10.0 * std::log10(error / power);
}

Eigen::VectorXd padded(const std::vector<double>& x, Index more)
{
    Eigen::VectorXd result = Eigen::VectorXd::Zero(static_cast<Index>(x.size()) + more);
    result.head(static_cast<Index>(x.size())) = Eigen::Map<const Eigen::VectorXd>(x.data(),
                                                                                  static_cast<Index>(x.size()));
    return result;
}

std::span<const double> spanOf(const Eigen::VectorXd& y) { return {y.data(), static_cast<std::size_t>(y.size())}; }

}  // namespace

TEST_CASE("Harmonics with known sizes and phases come out of the answer to a sweep")
{
    const ExponentialSweep sweep(
        {.sampleRate = 48000.0, .bandLow = 10.0, .bandHigh = 5000.0, .seconds = 5.0, .peak = 0.7});
    const std::complex<double> truth[] {{0.9, 0.3}, {-0.2, 0.1}, {0.05, -0.11}, {0.01, 0.02}};
    const double L = sweep.rate();
    Eigen::VectorXd y(static_cast<Index>(sweep.seconds() * 48000.0) + 1);
    for (Index t = 0; t < y.size(); ++t) {
        const double phase = 2.0 * std::numbers::pi * 10.0 * L * std::exp(static_cast<double>(t) / 48000.0 / L);
        y[t] = 0.0;
        for (int m = 1; m <= 4; ++m)
            y[t] += 0.7 * std::abs(truth[m - 1]) * std::sin(m * phase + std::arg(truth[m - 1]));
    }
    const auto found = harmonicResponses(sweep, spanOf(y), {.degree = 4, .length = 512});
    CHECK(found.separation == Approx(L * std::log(4.0 / 3.0)));
    for (int m = 1; m <= 4; ++m) {
        double worst = 0.0;
        for (std::size_t k = 0; k < found.frequency.size(); ++k)
            if (found.frequency[k] > 200.0 && found.frequency[k] < 0.8 * m * 5000.0)
                worst = std::max(worst, std::abs(found.value(static_cast<Index>(k), m - 1) - truth[m - 1])
                                            / std::abs(truth[m - 1]));
        CHECK(worst < 2e-3);
    }
}

TEST_CASE("A parallel Hammerstein system is found from a sweep, at any sample rate, branch by branch")
{
    const auto rate = GENERATE(44100.0, 48000.0, 96000.0);
    const auto fades = GENERATE(false, true);
    const int degree = rate == 48000.0 ? 5 : 3;
    const double high = 0.98 * rate / 2.0 / degree;  // its powers stay below half the sample rate
    const ExponentialSweep sweep({.sampleRate = rate,
                                  .bandLow = 8.0,
                                  .bandHigh = high,
                                  .seconds = 6.0,
                                  .peak = 0.8,
                                  .fadeIn = fades ? 0.1 : 0.0,
                                  .fadeOut = fades ? 0.02 : 0.0});
    const auto branches = drawnBranches(degree, rate, 250.0, static_cast<std::uint64_t>(rate) + fades);
    const auto y = played(branches, padded(sweep.samples(), static_cast<Index>(0.2 * rate)));
    HammersteinSweepOptions options {.degree = degree, .length = static_cast<Index>(0.03 * rate)};
    const auto fit = identifyHammerstein(sweep, spanOf(y), options);
    CHECK(fit.estimationDb < -55.0);
    for (int n = 1; n <= degree; ++n) {
        const double error = branchError(fit.model, n - 1, branches[static_cast<std::size_t>(n - 1)], 100.0,
                                         0.8 * high);
        CHECK(error < (n <= 3 ? -55.0 : fades ? -50.0 : -40.0));
    }
}

TEST_CASE("Noise on the answer to a sweep is spread over it, and a model is judged on what it has not seen")
{
    const double rate = 48000.0;
    const ExponentialSweep sweep(
        {.sampleRate = rate, .bandLow = 8.0, .bandHigh = 7800.0, .seconds = 6.0, .fadeIn = 0.1, .fadeOut = 0.02});
    const auto branches = drawnBranches(3, rate, 250.0, 77);
    auto y = played(branches, padded(sweep.samples(), 9600));
    Normal normal(3);
    const double level = 1e-3 * rmsOf(spanOf(y));
    for (auto& value : y)
        value += level * normal();
    const auto fit = identifyHammerstein(sweep, spanOf(y), {.length = 1024});
    for (int n = 1; n <= 3; ++n) {
        const double error = branchError(fit.model, n - 1, branches[static_cast<std::size_t>(n - 1)], 100.0, 6000.0);
        CHECK(error < -50.0);
    }
    // A multisine that the identification has not seen
    const MultisineOptions options {
        .sampleRate = rate, .period = 16384, .grid = Grid::full, .bandLow = 100.0, .bandHigh = 5000.0, .rms = 0.25};
    const auto u = multisine(options, chooseLines(options), 0);
    const Eigen::VectorXd twice = padded(u, 0).replicate(2, 1), truth = played(branches, twice),
                          modelled = simulate(fit.model, twice);
    Eigen::VectorXd a = truth.tail(16384), b = modelled.tail(16384);
    a.array() -= a.mean();
    b.array() -= b.mean();
    CHECK((a - b).norm() < 1e-3 * a.norm());
}

TEST_CASE("A sweep's answer that cannot be taken apart is refused")
{
    const ExponentialSweep sweep({.sampleRate = 8000.0, .bandLow = 20.0, .bandHigh = 1000.0, .seconds = 1.0});
    auto y = sweep.samples();
    const auto no = [&](Error::Kind kind, const char* what, const HammersteinSweepOptions& options,
                        const std::vector<double>& record) {
        refused(kind, what, [&] { identifyHammerstein(sweep, record, options); });
    };
    no(Error::Kind::usage, "degree", {.degree = 0}, y);
    no(Error::Kind::usage, "taps", {.length = 0}, y);
    no(Error::Kind::usage, "regularization", {.regularization = 0.0}, y);
    no(Error::Kind::usage, "edge", {.edge = -1.0}, y);
    no(Error::Kind::data, "overlap", {.degree = 3, .length = 900}, y);
    no(Error::Kind::data, "fewer", {.length = 64}, std::vector<double>(y.begin(), y.end() - 100));
    const ExponentialSweep narrow({.sampleRate = 8000.0, .bandLow = 100.0, .bandHigh = 400.0, .seconds = 3.0});
    refused(Error::Kind::usage, "narrow",
            [&] { identifyHammerstein(narrow, narrow.samples(), {.degree = 4, .length = 64}); });
    y[17] = std::nan("");
    no(Error::Kind::data, "not finite", {.length = 64}, y);
}

TEST_CASE("A parallel Hammerstein model answers as the sum that defines it")
{
    ParallelHammerstein model {1000.0, Eigen::MatrixXd(3, 2), 0.25};
    model.filters << 1.0, -0.5, 0.3, 0.2, -0.1, 0.7;
    CHECK(model.parameters() == 7);
    Normal normal(1);
    Eigen::MatrixXd u(40, 1);
    for (auto& x : u.reshaped())
        x = normal();
    const auto y = simulate(model, u);
    for (Index t = 0; t < 40; ++t) {
        double sum = 0.25;
        for (Index k = 0; k <= std::min<Index>(t, 2); ++k)
            sum += model.filters(k, 0) * u(t - k, 0) + model.filters(k, 1) * u(t - k, 0) * u(t - k, 0);
        CHECK(y(t, 0) == Approx(sum).margin(1e-13));
    }
    const auto G = responses(model, {0.0, 250.0});
    CHECK(std::abs(G(0, 0) - 1.2) < 1e-14);
    CHECK(std::abs(G(1, 1) - std::complex<double>(-0.5 - 0.7, -0.2)) < 1e-14);  // z = j
    refused(Error::Kind::usage, "one input", [&] { simulate(model, Eigen::MatrixXd::Zero(4, 2)); });
    model.filters(1, 1) = std::nan("");
    refused(Error::Kind::usage, "finite", [&] { simulate(model, u); });
}

TEST_CASE("Any record gives the model: exactly where it is one, to the noise where it is filters without end")
{
    Normal normal(12);
    ParallelHammerstein truth {8000.0, Eigen::MatrixXd(24, 3), -0.3};
    for (auto& g : truth.filters.reshaped())
        g = normal();
    const auto drawn = [&](Index N) {
        Eigen::MatrixXd u(N, 1);
        for (auto& x : u.reshaped())
            x = 0.4 * normal();
        return u;
    };
    const auto record = [&](Index N, Index skip) {
        const auto u = drawn(N);
        return InputOutputRecord {u, simulate(truth, u), skip, false};
    };
    const auto exact = fitHammerstein(8000.0, {record(700, 0), record(500, 30)}, {record(300, 30)}, {.length = 50});
    CHECK(exact.validationDb < -150.0);
    CHECK(exact.model.length() >= 24);
    CHECK((exact.model.filters.topRows(24) - truth.filters).norm() < 1e-8 * truth.filters.norm());
    CHECK(exact.model.offset == Approx(-0.3).margin(1e-8));
    const auto alone = fitHammerstein(8000.0, {record(2000, 0)}, {}, {.length = 24, .regularization = 1e-12});
    CHECK((alone.model.filters - truth.filters).norm() < 1e-9 * truth.filters.norm());
    CHECK(std::isnan(alone.validationDb));

    const double rate = 48000.0;
    const auto branches = drawnBranches(3, rate, 400.0, 5);
    const MultisineOptions options {
        .sampleRate = rate, .period = 8192, .grid = Grid::full, .bandLow = 20.0, .bandHigh = 7500.0, .rms = 0.4};
    const auto steady = [&](int realization, double noise) {
        const Eigen::VectorXd u = padded(multisine(options, chooseLines(options), realization), 0);
        Eigen::VectorXd y = played(branches, u.replicate(2, 1)).tail(8192);
        const double level = noise * rmsOf(spanOf(y));
        for (auto& value : y)
            value += level * normal();
        return periodicRecord(u, y, 1024);
    };
    const auto fit = fitHammerstein(rate, {steady(0, 1e-2), steady(1, 1e-2), steady(2, 1e-2)}, {steady(3, 1e-2)},
                                    {.length = 512});
    CHECK(fit.validationDb < -39.0);
    const auto clean = steady(4, 0.0);
    const double db = outputErrorDb({simulate(fit.model, clean.input)}, {clean});
    CHECK(db < -52.0);
}

TEST_CASE("Branches with a long memory are found by iteration")
{
    // The exact answer first: white input, branches as long as the model's
    Normal normal(31);
    ParallelHammerstein truth {8000.0, Eigen::MatrixXd(2100, 2), 0.2};
    for (Index k = 0; k < 2100; ++k) {
        const double decay = std::exp(-0.002 * static_cast<double>(k));
        truth.filters.row(k) << decay * normal(), 0.2 * decay * normal();
    }
    const auto drawn = [&](Index N, Index skip) {
        Eigen::MatrixXd u(N, 1);
        for (auto& x : u.reshaped())
            x = 0.5 * normal();
        return InputOutputRecord {u, simulate(truth, u), skip, false};
    };
    const auto fit = fitHammerstein(8000.0, {drawn(16000, 0), drawn(9000, 2100)}, {drawn(6000, 500)},
                                    {.degree = 2, .length = 2100, .regularization = 1e-12});
    CHECK(fit.validationDb < -150.0);
    CHECK((fit.model.filters - truth.filters).norm() < 1e-7 * truth.filters.norm());
    CHECK(fit.model.offset == Approx(0.2).margin(1e-7));
    const auto alone = fitHammerstein(8000.0, {drawn(16000, 0)}, {},
                                      {.degree = 2, .length = 2100, .regularization = 1e-12});
    CHECK((alone.model.filters - truth.filters).norm() < 1e-7 * truth.filters.norm());

    // A resonance at 40 Hz at 48 kHz: it rings for a tenth of a second.
    const double rate = 48000.0;
    const std::vector<Resonance> branches {
        {40.0, 2.0, 1.0, 0.0, 0.0, rate}, {60.0, 1.0, 0.0, 0.1, 0.0, rate}, {2000.0, 0.7, 0.05, 0.0, 0.0, rate}};
    const MultisineOptions options {.sampleRate = rate,
                                    .period = 32768,
                                    .grid = Grid::full,
                                    .shape = Shape::pink,
                                    .bandLow = 10.0,
                                    .bandHigh = 7500.0,
                                    .rms = 0.4};
    const auto steady = [&](int realization) {
        const Eigen::VectorXd u = padded(multisine(options, chooseLines(options), realization), 0);
        Eigen::VectorXd y = played(branches, u.replicate(2, 1)).tail(32768);
        const double level = 1e-3 * rmsOf(spanOf(y));
        for (auto& value : y)
            value += level * normal();
        return periodicRecord(u, y, 8192);
    };
    const std::vector estimation {steady(0), steady(1)}, validation {steady(2)};
    const auto brief = fitHammerstein(rate, estimation, validation, {.length = 512});
    const auto lasting = fitHammerstein(rate, estimation, validation, {.length = 6000});
    CHECK(brief.validationDb > -20.0);
    CHECK(lasting.validationDb < -57.0);
}

TEST_CASE("Records that no parallel Hammerstein model can be fitted to are refused")
{
    const Eigen::MatrixXd u = Eigen::VectorXd::LinSpaced(50, -1.0, 1.0);
    const auto no = [&](Error::Kind kind, const char* what, const std::vector<InputOutputRecord>& records,
                        const HammersteinFitOptions& options) {
        refused(kind, what, [&] { fitHammerstein(1000.0, records, {}, options); });
    };
    no(Error::Kind::usage, "degree", {{u, u, 0, false}}, {.degree = 0});
    no(Error::Kind::usage, "262144", {{u, u, 0, false}}, {.degree = 3, .length = 100000});
    no(Error::Kind::data, "no record", {}, {});
    no(Error::Kind::data, "does not fit", {{u, u.topRows(5), 0, false}}, {});
    no(Error::Kind::data, "does not fit", {{u, u, 50, false}}, {});
    no(Error::Kind::data, "silent", {{0.0 * u, u, 0, false}}, {});
    no(Error::Kind::data, "too few values", {{u.cwiseSign(), u, 0, false}}, {});
    refused(Error::Kind::usage, "sample rate", [&] { fitHammerstein(0.0, {{u, u, 0, false}}, {}); });
}

TEST_CASE("A parallel Hammerstein model is kept and read again, bit for bit, and what does not fit is refused")
{
    ParallelHammerstein model {48000.0, Eigen::MatrixXd::Random(5, 3), 0.1};
    const DocumentFile file(toJson(Named<ParallelHammerstein> {"box", "voltage", "current", model}),
                            parallelHammersteinFromJson);
    const auto read = file.read();
    CHECK(read.input == "voltage");
    CHECK(read.model.sampleRate == 48000.0);
    CHECK(read.model.offset == 0.1);
    CHECK((read.model.filters.array() == model.filters.array()).all());
    file.refuses("branches[1]", [](auto& d) { d["branches"][1].erase(0); });
    file.refuses("branches", [](auto& d) { d["branches"] = nlohmann::json::array(); });
    file.refuses("sampleRate", [](auto& d) { d["sampleRate"] = 0; });
    file.refuses("offset", [](auto& d) { d["offset"] = "none"; });
    file.refuses("format", [](auto& d) { d["format"] = "excursion-pnlss"; });
}
