// SPDX-License-Identifier: GPL-3.0-or-later
// What must not change what a model plays or what order is chosen: the basis of its states, the form that it is written
// in, when a signal comes; and what noise may do.
#include "Engine/Linear/OrderSweep.h"
#include "Engine/Linear/Response.h"
#include "Engine/Linear/Simulation.h"
#include "Engine/Polynomial/Block/BlockModel.h"
#include "Engine/Polynomial/Hammerstein/ParallelHammerstein.h"
#include "Engine/Polynomial/Narx/Narx.h"
#include "Engine/Polynomial/Narx/NarxRecursion.h"
#include "Engine/Polynomial/Volterra/VolterraSeries.h"
#include "Linear/Problem.h"
#include "Properties/Property.h"

#include <Eigen/LU>

#include <algorithm>
#include <complex>
#include <numbers>

using namespace excursion;
using namespace excursion::test;
using Eigen::Index;
using Eigen::MatrixXd;

namespace {

constexpr Index N = 40;

StateSpace stable(Index n, Index m, Index p)
{
    MatrixXd A = matrixWithin1(n, n);
    A *= 0.7 / std::max(A.cwiseAbs().rowwise().sum().maxCoeff(), 0.7);
    return {A, matrixWithin1(n, m), matrixWithin1(p, n), matrixWithin1(p, m), 8000.0};
}

bool near(const MatrixXd& a, const MatrixXd& b) { return (a - b).norm() <= 1e-10 * (1.0 + b.norm()); }

Narx anyNarx()
{
    Narx model;
    model.sampleRate = 8000.0;
    model.outputLags = between(1, 2);
    model.inputLags = between(0, 2);
    const auto variables = model.outputLags + model.inputLags + 1;
    model.exponents = monomials(variables, 1, 2);
    model.coefficients = 0.3 / static_cast<double>(model.exponents.rows()) * matrixWithin1(model.exponents.rows(), 1);
    return model;
}

BlockModel anyBlockModel()
{
    return {stable(2, 1, 1), 0.2 * matrixWithin1(between(0, 2), 1), 0.2 * matrixWithin1(between(0, 2), 1),
            0.2 * matrixWithin1(between(0, 2), 1), within1()};
}

}  // namespace

TEST_CASE("In another basis, and in another form, a model plays the same")
{
    holds("basis", 40, [] {
        const auto n = between(1, 3), m = between(1, 2), p = between(1, 2);
        auto model = withTerms(stable(n, m, p), 3, TermMask::full, true);
        model.E = 0.01 * matrixWithin1(n, model.terms());
        model.F = 0.1 * matrixWithin1(p, model.terms());
        const MatrixXd T = MatrixXd::Identity(n, n) + 0.2 * matrixWithin1(n, n);
        const MatrixXd u = matrixWithin1(N, m), y = simulate(model, u);
        RC_ASSERT(near(simulate(transformed(model, T), u), y));
        RC_ASSERT(near(simulate(transformed(model.linear, T), u), simulate(model.linear, u)));
        const Eigen::VectorXd begin = matrixWithin1(n, 1);
        RC_ASSERT(near(simulate(transformed(model, T), u, T.inverse() * begin), simulate(model, u, begin)));
    });
    holds("form", 40, [] {
        const MatrixXd u = matrixWithin1(N, 1);
        const auto narx = anyNarx();
        RC_ASSERT(near(simulate(pnlssOf(narx), u), simulate(narx, u)));
        const auto block = anyBlockModel();
        RC_ASSERT(near(simulate(pnlssOf(block), u), simulate(block, u)));
        // A parallel Hammerstein model is a Volterra series off whose diagonals is nothing.
        const ParallelHammerstein branches {8000.0, matrixWithin1(3, 3), within1()};
        VolterraSeries series {8000.0,
                               branches.offset,
                               branches.filters.col(0),
                               branches.filters.col(1).asDiagonal(),
                               {3, MatrixXd::Zero(3, 3)}};
        for (Index k = 0; k < 3; ++k)
            series.third[static_cast<std::size_t>(k)](k, k) = branches.filters(k, 2);
        RC_ASSERT(near(simulate(series, u), simulate(branches, u)));
    });
}

TEST_CASE("A signal that comes later is answered later, and what comes cannot change what was")
{
    holds("time", 40, [] {
        const MatrixXd u = matrixWithin1(N, 1);
        const auto late = between(1, 10);
        MatrixXd later = MatrixXd::Zero(N, 1), other = u;
        later.bottomRows(N - late) = u.topRows(N - late);
        other.bottomRows(late) = matrixWithin1(late, 1);
        const auto check = [&](const auto& model) {
            const MatrixXd rest = simulate(model, MatrixXd::Zero(N, 1)), y = simulate(model, u);
            RC_ASSERT(near(simulate(model, other).topRows(N - late), y.topRows(N - late)));
            RC_ASSERT(near(rest, MatrixXd::Constant(N, 1, rest(0, 0))));  // these start where they stay
            RC_ASSERT(near(simulate(model, later).bottomRows(N - late), y.topRows(N - late)));
        };
        check(stable(between(1, 3), 1, 1));
        check(anyNarx());
        check(anyBlockModel());
        check(ParallelHammerstein {8000.0, matrixWithin1(3, 3), within1()});
        auto model = withTerms(stable(2, 1, 1), 3);
        model.E = 0.02 * matrixWithin1(2, model.terms());
        check(model);
    });
}

TEST_CASE("More noise never makes the test of orders choose more")
{
    holds("noise", 6, [] {
        // A mode of -3 dB, one of -30 and one of -60
        const double rate = 8000.0;
        StateSpace truth {MatrixXd::Zero(6, 6), MatrixXd::Zero(6, 1), MatrixXd::Zero(1, 6), MatrixXd::Zero(1, 1), rate};
        for (Index k = 0; k < 3; ++k) {
            const auto pole = std::polar(0.97 + 0.01 * within1(), 0.4 + 0.7 * static_cast<double>(k) + 0.1 * within1());
            truth.A.block(2 * k, 2 * k, 2, 2) << pole.real(), pole.imag(), -pole.imag(), pole.real();
            truth.B(2 * k, 0) = 1.0;
            truth.C(0, 2 * k) = std::pow(10.0, -1.5 * static_cast<double>(k));
        }
        Normal normal(static_cast<std::uint64_t>(between(1, 100000)));
        FrequencyData exact;
        Eigen::VectorXcd noise(120);
        exact.value.resize(120, 1);
        for (Index k = 0; k < 120; ++k) {
            exact.frequency.push_back(30.0 * static_cast<double>(k + 1));
            exact.value(k, 0) = Resolvent(truth).response(evaluationPoint(exact.frequency.back(), rate, 1.0))(0, 0);
            noise[k] = {normal(), normal()};
        }
        OrderSweepOptions options;
        options.orders = {2, 3, 4, 5, 6, 7, 8};
        options.identify.sampleRate = rate;
        int before = 100;
        std::vector<int> chosen;
        for (const double db : {-90.0, -50.0, -20.0}) {
            auto data = exact;
            const double size = std::pow(10.0, db / 20.0) * exact.value.norm() / noise.norm();
            data.value += size * noise;
            data.deviation = MatrixXd::Constant(120, 1, size * std::sqrt(2.0));
            const auto sweep = sweepOrders(data, options);
            chosen.push_back(sweep.entries[sweep.chosen].order);
            RC_ASSERT(chosen.back() <= before);
            before = chosen.back();
        }
        RC_ASSERT(chosen.front() >= 6);
        RC_ASSERT(chosen.back() < 6);
    });
}
