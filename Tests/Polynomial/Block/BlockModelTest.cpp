// SPDX-License-Identifier: GPL-3.0-or-later
// Block models against recursions written out by hand, and the choice of their branches on systems that have one of
// them.
#include "Engine/Polynomial/Block/BlockModelFile.h"
#include "Engine/Polynomial/Block/BlockModelFit.h"
#include "Engine/Polynomial/InputOutputRecord.h"
#include "DocumentFile.h"
#include "Linear/Problem.h"
#include "Polynomial/LinearStart.h"
#include "Polynomial/Silverbox.h"

#include <nlohmann/json.hpp>

#include <numbers>

using namespace excursion;
using namespace excursion::test;
using Eigen::Index;

namespace {

/// y(t) = b1 u(t-1) + b2 u(t-2) - a1 y(t-1) - a2 y(t-2), a resonance drawn.
struct Resonator {
    double a1, a2, b1, b2;

    explicit Resonator(Normal& normal)
    {
        const double angle = 0.2 + 0.4 * std::abs(normal()), radius = 0.92 - 0.05 * std::abs(normal());
        a1 = -2.0 * radius * std::cos(angle);
        a2 = radius * radius;
        b1 = 0.1 * (1.0 + 0.2 * normal());
        b2 = 0.05 * normal();
    }
    Eigen::VectorXd operator()(const Eigen::VectorXd& u) const
    {
        Eigen::VectorXd y(u.size());
        for (Index t = 0; t < u.size(); ++t)
            y[t] = (t > 0 ? b1 * u[t - 1] - a1 * y[t - 1] : 0.0) + (t > 1 ? b2 * u[t - 2] - a2 * y[t - 2] : 0.0);
        return y;
    }
    StateSpace model() const
    {
        StateSpace G;
        G.sampleRate = 1000.0;
        G.A.resize(2, 2);
        G.A << -a1, 1.0, -a2, 0.0;
        G.B = Eigen::Vector2d(b1, b2);
        G.C = Eigen::RowVector2d(1.0, 0.0);
        G.D = Eigen::MatrixXd::Zero(1, 1);
        return G;
    }
};

Eigen::VectorXd bent(const Eigen::VectorXd& v, double square, double cube)
{
    return square * v.array().square() + cube * v.array().cube();
}

/// A system with one kind of nonlinearity, whose polynomials are those of a signal of about unit size where the input
/// is white of unit size.
Eigen::VectorXd systemOf(BlockBranch kind, const Resonator& G, const Eigen::VectorXd& u, double square, double cube)
{
    const Eigen::VectorXd w = G(u);
    const double size = G(Eigen::VectorXd::Unit(500, 0)).norm();
    switch (kind) {
    case BlockBranch::hammerstein: return G(u + bent(u, square, cube));
    case BlockBranch::wiener: return w + size * bent(w / size, square, cube);
    case BlockBranch::feedback: return w + G(bent(w / size, square, cube));
    }
    return {};
}

/// m x'' + r x' + k x + k2 x^2 + k3 x^3 = u, by the classical Runge-Kutta method, u linear between samples.
Eigen::VectorXd duffing(const Eigen::VectorXd& u, double fs, double k2, double k3)
{
    const double w0 = 2.0 * std::numbers::pi * 68.0, damping = 2.0 * 0.06 * w0;
    Eigen::VectorXd y(u.size());
    Eigen::Vector2d x = Eigen::Vector2d::Zero();
    constexpr int steps = 8;
    const double h = 1.0 / fs / steps;
    const auto rate = [&](const Eigen::Vector2d& at, double force) {
        return Eigen::Vector2d(at[1], w0 * w0 * (force - at[0] - k2 * at[0] * at[0] - k3 * at[0] * at[0] * at[0])
                                          - damping * at[1]);
    };
    for (Index t = 0; t < u.size(); ++t) {
        y[t] = x[0];
        const double from = u[t], to = t + 1 < u.size() ? u[t + 1] : u[t];
        for (int s = 0; s < steps; ++s) {
            const double f0 = from + (to - from) * s / steps, f1 = from + (to - from) * (s + 1) / steps,
                         f = 0.5 * (f0 + f1);
            const Eigen::Vector2d r1 = rate(x, f0), r2 = rate(x + 0.5 * h * r1, f);
            const Eigen::Vector2d r3 = rate(x + 0.5 * h * r2, f), r4 = rate(x + h * r3, f1);
            x += h / 6.0 * (r1 + 2.0 * r2 + 2.0 * r3 + r4);
        }
    }
    return y;
}

/// Three steady periods of one system, the last one for validation, and the linear model that its best linear
/// approximation gives.
template <class System>
BlockModelFit fitted(const System& system, double amplitude, double fs, Normal& normal, double noise)
{
    std::vector<InputOutputRecord> records;
    std::vector<Eigen::VectorXd> inputs, outputs;
    for (int r = 0; r < 3; ++r) {
        Eigen::VectorXd u(1024);
        for (auto& x : u)
            x = amplitude * normal();
        Eigen::VectorXd y = system(u.replicate(4, 1)).tail(1024);
        const double size = noise * y.norm() / 32.0;
        for (auto& x : y)
            x += size * normal();
        records.push_back(periodicRecord(u, y, 512));
        inputs.push_back(u);
        outputs.push_back(y);
    }
    inputs.pop_back();
    outputs.pop_back();
    const auto linear = linearStart(meanResponse(inputs, outputs, fs), 2, fs);
    return fitBlockModel(linear, {records[0], records[1]}, {records[2]});
}

}  // namespace

TEST_CASE("A block model answers as its branches do by hand, and so does the PNLSS model that it is")
{
    Normal normal(3);
    const Resonator G(normal);
    BlockModel model;
    model.linear = G.model();
    model.linear.D(0, 0) = 0.2;
    model.hammerstein = Eigen::Vector2d(0.1, -0.2);
    model.wiener = Eigen::Vector3d(0.3, 0.05, -0.04);
    model.feedback = Eigen::VectorXd::Constant(1, 0.15);
    model.offset = -0.07;
    REQUIRE(model.isValid());
    CHECK(model.parameters() == 6 + 2 + 3 + 1);
    Eigen::VectorXd u(300);
    for (auto& x : u)
        x = normal();
    const auto through = [&](const Eigen::VectorXd& v) -> Eigen::VectorXd { return G(v) + 0.2 * v; };
    const Eigen::VectorXd w = through(u);
    const Eigen::VectorXd hammerstein = through(bent(u, 0.1, -0.2)), feedback = through(bent(w, 0.15, 0.0));
    const Eigen::VectorXd wiener = bent(w, 0.3, 0.05).array() - 0.04 * w.array().pow(4.0);
    const auto outputs = branchOutputs(model, u);
    CHECK((outputs.linear - w).norm() < 1e-12 * w.norm());
    CHECK((outputs.hammerstein - hammerstein).norm() < 1e-12 * hammerstein.norm());
    CHECK((outputs.wiener - wiener).norm() < 1e-12 * wiener.norm());
    CHECK((outputs.feedback - feedback).norm() < 1e-12 * feedback.norm());
    const Eigen::VectorXd truth = (w + hammerstein + wiener + feedback).array() - 0.07;
    CHECK((simulate(model, u) - truth).norm() < 1e-12 * truth.norm());
    const auto pnlss = pnlssOf(model);
    REQUIRE(pnlss.isValid());
    CHECK((simulate(pnlss, u) - truth).norm() < 1e-11 * truth.norm());
    CHECK((simulate(pnlssOf({G.model(), {}, {}, {}, 0.0}), u) - G(u)).norm() < 1e-12 * w.norm());
}

TEST_CASE("The feedback branch closed is the loop by hand, and differs by what goes through two polynomials")
{
    Normal normal(5);
    const Resonator G(normal);
    const double direct = GENERATE(0.0, 0.3);
    BlockModel model;
    model.linear = G.model();
    model.linear.D(0, 0) = direct;
    model.hammerstein = Eigen::VectorXd::Constant(1, 0.05);
    model.wiener = Eigen::VectorXd::Constant(1, -0.1);
    model.feedback = Eigen::Vector2d(0.2, -0.3);
    model.offset = 0.4;
    Eigen::VectorXd u(400), truth(400);
    for (auto& x : u)
        x = 0.5 * normal();
    double x1 = 0.0, x2 = 0.0;
    for (Index t = 0; t < 400; ++t) {
        const double w = x1 + direct * u[t], bend = 0.05 * u[t] * u[t] + 0.2 * w * w - 0.3 * w * w * w, v = u[t] + bend;
        truth[t] = 0.4 + w + direct * bend - 0.1 * w * w;
        const double next = -G.a1 * x1 + x2 + G.b1 * v;
        x2 = -G.a2 * x1 + G.b2 * v;
        x1 = next;
    }
    CHECK((simulate(closedLoop(model), u) - truth).norm() < 1e-11 * truth.norm());
    const auto difference = [&](double share) {
        auto weak = model;
        for (const auto branch : blockBranches())
            weak.of(branch) *= share;
        return (simulate(closedLoop(weak), u) - simulate(weak, u)).norm();
    };
    CHECK(std::log2(difference(0.02) / difference(0.01)) == Approx(2.0).margin(0.05));
}

TEST_CASE("The branch that a system has is chosen first, and the system found")
{
    const auto kind = GENERATE(BlockBranch::hammerstein, BlockBranch::wiener, BlockBranch::feedback);
    const auto seed = GENERATE(1u, 2u, 3u, 4u);
    INFO(name(kind) << ", seed " << seed);
    Normal normal(seed);
    const Resonator G(normal);
    const double square = 0.05 + 0.05 * std::abs(normal()), cube = -0.03 - 0.03 * std::abs(normal());
    const auto system = [&](const Eigen::VectorXd& u) { return systemOf(kind, G, u, square, cube); };
    const auto fit = fitted(system, 1.0, 1000.0, normal, 0.0);
    REQUIRE(fit.steps.size() >= 2);
    CHECK(fit.steps[1].branch == kind);
    CHECK(fit.stable);
    // With noise the same branch, and an error at the noise
    const auto noisy = fitted(system, 1.0, 1000.0, normal, 0.01);
    CHECK(noisy.steps.at(1).branch == kind);
    CHECK(noisy.validationDb == Approx(-40.0).margin(1.0));
    CHECK(noisy.stable);
}

TEST_CASE("A hardening spring is seen as feedback")
{
    const auto seed = GENERATE(1u, 2u, 3u);
    const auto amplitude = GENERATE(0.05, 0.1);
    Normal normal(seed);
    const double fs = 610.0;
    const double k2 = 0.1 * normal(), k3 = 0.3;
    const auto system = [&](const Eigen::VectorXd& u) { return duffing(u, fs, k2, k3); };
    const auto fit = fitted(system, amplitude, fs, normal, 1e-4);
    REQUIRE(fit.steps.size() >= 2);
    CHECK(fit.steps[1].branch == BlockBranch::feedback);
    CHECK(fit.steps[1].errorDb < fit.steps[0].errorDb - 6.0);
    CHECK(fit.validationDb <= fit.steps[1].errorDb);
    CHECK(fit.validationDb < (amplitude < 0.1 ? -40.0 : -22.0));
    CHECK(fit.stable);
    // The loop closed has no such limit: a fit that begins there finds the spring, at another drive of the same size.
    const auto fresh = [&] {
        Eigen::VectorXd u(2048);
        for (auto& x : u)
            x = amplitude * normal();
        return InputOutputRecord {u, system(u), 256, false};
    };
    const std::vector estimation {fresh()}, validation {fresh()};
    PnlssFitOptions options;
    options.maximumIterations = 50;
    const auto closed = fitPnlss(closedLoop(fit.model), estimation, validation, options);
    CHECK(closed.validationDb < -80.0);
    CHECK(simulationErrorDb(fit.model, validation) > -62.0);
    CHECK(closed.stable);
}

TEST_CASE("The Silverbox, a circuit with a hardening spring, is seen as feedback")
{
    const Silverbox box;
    if (box.input.size() == 0)
        return;
    std::vector<Eigen::VectorXd> inputs, outputs;
    for (Index k = 0; k < 8; ++k) {
        inputs.emplace_back(box.input.segment(40580 + 8000 * k, 8000));
        outputs.emplace_back(box.output.segment(40580 + 8000 * k, 8000));
    }
    const auto linear = linearStart(meanResponse(inputs, outputs, box.rate), 2, box.rate);
    const auto fit = fitBlockModel(linear, {box.multisines()}, {box.lastMultisine()});
    REQUIRE(fit.steps.size() >= 2);
    CHECK(fit.steps[1].branch == BlockBranch::feedback);
    CHECK(fit.steps[1].errorDb < fit.steps[0].errorDb - 4.0);
    for (const auto branch : {BlockBranch::hammerstein, BlockBranch::wiener})
        CHECK(fit.steps[1].errorDbOf.at(branch) > fit.steps[0].errorDb - 0.5);
    CHECK(fit.stable);
}

TEST_CASE("A linear system needs no branch, and an unstable or useless linear part is refused")
{
    Normal normal(6);
    const Resonator G(normal);
    const auto fit = fitted([&](const Eigen::VectorXd& u) { return G(u); }, 1.0, 1000.0, normal, 0.01);
    CHECK(fit.steps.size() == 1);
    CHECK(fit.powerDb.empty());
    CHECK(fit.validationDb == Approx(-40.0).margin(1.0));

    const Eigen::MatrixXd u = Eigen::VectorXd::LinSpaced(50, -1.0, 1.0);
    auto unstable = G.model();
    unstable.A *= 1.3;
    const auto no = [&](Error::Kind kind, const char* what, const StateSpace& linear,
                        const std::vector<InputOutputRecord>& records, const BlockModelFitOptions& options) {
        refused(kind, what, [&] { fitBlockModel(linear, records, {}, options); });
    };
    no(Error::Kind::usage, "not stable", unstable, {{u, u, 0, false}}, {});
    no(Error::Kind::usage, "degree", G.model(), {{u, u, 0, false}}, {.degree = 1});
    no(Error::Kind::usage, "at least 0", G.model(), {{u, u, 0, false}}, {.worthwhileDb = -1.0});
    no(Error::Kind::data, "no record", G.model(), {}, {});
    no(Error::Kind::data, "does not fit", G.model(), {{u, u.topRows(5), 0, false}}, {});
    no(Error::Kind::data, "explains nothing", G.model(), {{0.0 * u, u, 0, false}}, {});
    auto continuous = G.model();
    continuous.sampleRate = 0.0;
    no(Error::Kind::usage, "discrete time", continuous, {{u, u, 0, false}}, {});
    refused(Error::Kind::usage, "one input", [&] { simulate(fit.model, Eigen::MatrixXd::Zero(3, 2)); });
    auto broken = fit.model;
    broken.wiener = Eigen::VectorXd::Constant(2, std::nan(""));
    refused(Error::Kind::usage, "not finite", [&] { simulate(broken, u); });
}

TEST_CASE("A block model is kept and read again, bit for bit, and what does not fit is refused")
{
    Normal normal(8);
    const BlockModel model {
        Resonator(normal).model(), {}, Eigen::Vector3d(0.3, 0.05, -0.04), Eigen::Vector2d(0.1, 0.2), 0.5};
    const DocumentFile file(toJson(Named<BlockModel> {"box", "voltage", "displacement", model}), blockModelFromJson);
    const auto named = file.read();
    CHECK(named.output == "displacement");
    CHECK(named.model.linear.A == model.linear.A);
    CHECK(named.model.hammerstein.size() == 0);
    CHECK(named.model.wiener == model.wiener);
    CHECK(named.model.feedback == model.feedback);
    CHECK(named.model.offset == 0.5);
    file.refuses("wiener[1]", [](auto& d) { d["wiener"][1] = "x"; });
    file.refuses("feedback", [](auto& d) { d.erase("feedback"); });
    file.refuses("linear", [](auto& d) { d["linear"]["sampleRate"] = 0; });
    file.refuses("offset", [](auto& d) { d["offset"] = nullptr; });
    file.refuses("degree 20", [](auto& d) { d["wiener"] = std::vector<double>(30, 1.0); });
}
