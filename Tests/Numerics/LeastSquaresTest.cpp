// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Numerics/LeastSquares.h"
#include "Engine/Numerics/TrustRegion.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>

using namespace excursion;

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

/// NIST Statistical Reference Datasets, nonlinear regression, Misra1a: y = b1 (1 - exp(-b2 x)).
namespace misra {
constexpr double x[] = {77.6,  114.9, 141.1, 190.8, 239.9, 289.0, 332.8,
                        378.4, 434.8, 477.3, 536.8, 593.1, 689.1, 760.0};
constexpr double y[] = {10.07, 14.73, 17.94, 23.93, 29.61, 35.18, 40.02,
                        44.82, 50.76, 55.05, 61.01, 66.40, 75.47, 81.78};
constexpr double b1 = 2.3894212918e+02, b2 = 5.5015643181e-04, deviation1 = 2.7070075241e+00,
                 deviation2 = 7.2668688436e-06;
constexpr double sumOfSquares = 1.2455138894e-01;

bool evaluate(const Eigen::VectorXd& b, bool gradient, NormalEquations& sum)
{
    Eigen::VectorXd r(14);
    Eigen::MatrixXd J(14, 2);
    for (Eigen::Index n = 0; n < 14; ++n) {
        const double decay = std::exp(-b[1] * x[n]);
        r[n] = b[0] * (1.0 - decay) - y[n];
        J(n, 0) = 1.0 - decay;
        J(n, 1) = b[0] * x[n] * decay;
    }
    sum.cost = r.squaredNorm();
    sum.rows = 14.0;
    if (gradient) {
        sum.N = J.transpose() * J;
        sum.g = J.transpose() * r;
    }
    return true;
}
}  // namespace misra

Eigen::VectorXd two(double a, double b) { return Eigen::Vector2d(a, b); }

LeastSquaresOptions exact()
{
    LeastSquaresOptions options;
    options.maximumIterations = 200;
    options.costTolerance = 1e-15;
    return options;
}

}  // namespace

TEST_CASE("The search finds NIST's certified values from both of their starts", "[least-squares]")
{
    for (const auto& start : {two(500.0, 1e-4), two(250.0, 5e-4)}) {
        auto b = start;
        const auto summary = minimize(misra::evaluate, b, two(-infinite, -infinite), two(infinite, infinite), exact());
        INFO(summary.message);
        CHECK(summary.usable());
        CHECK(b[0] == Approx(misra::b1).epsilon(1e-7));
        CHECK(b[1] == Approx(misra::b2).epsilon(1e-7));
        CHECK(summary.finalCost == Approx(misra::sumOfSquares).epsilon(1e-8));
        CHECK(summary.initialCost > summary.finalCost);
        NormalEquations there;
        misra::evaluate(b, true, there);
        const auto covariance = covarianceOf(there.N, summary.finalCost / 12.0);
        CHECK(std::sqrt(covariance(0, 0)) == Approx(misra::deviation1).epsilon(1e-6));
        CHECK(std::sqrt(covariance(1, 1)) == Approx(misra::deviation2).epsilon(1e-6));
        CHECK(covariance(0, 1) == Approx(covariance(1, 0)));
    }
}

TEST_CASE("The search stays within bounds and does its best beside the one that holds it back", "[least-squares]")
{
    // (x - 3)^2 + 10 (y^2 + y - 6)^2 with x at most 2: the best is at (2, 2).
    const auto evaluate = [](const Eigen::VectorXd& at, bool gradient, NormalEquations& sum) {
        const Eigen::Vector2d r(at[0] - 3.0, std::sqrt(10.0) * (at[1] * at[1] + at[1] - 6.0));
        const Eigen::Matrix2d J = Eigen::Vector2d(1.0, std::sqrt(10.0) * (2.0 * at[1] + 1.0)).asDiagonal();
        sum.cost = r.squaredNorm();
        sum.rows = 2.0;
        if (gradient) {
            sum.N = J.transpose() * J;
            sum.g = J.transpose() * r;
        }
        return true;
    };
    auto at = two(0.5, 0.7);
    const auto summary = minimize(evaluate, at, two(0.0, 0.0), two(2.0, 5.0), exact());
    INFO(summary.message);
    CHECK(summary.usable());
    CHECK(at[0] == Approx(2.0).epsilon(1e-9));
    CHECK(at[1] == Approx(2.0).epsilon(1e-3));
    CHECK(summary.finalCost == Approx(1.0).epsilon(1e-3));
    // A start outside is moved to the nearest bound.
    at = two(9.0, 0.7);
    minimize(evaluate, at, two(0.0, 0.0), two(2.0, 5.0), exact());
    CHECK(at[0] == Approx(2.0).epsilon(1e-9));
}

TEST_CASE("Where the model cannot be evaluated the search shortens its step", "[least-squares]")
{
    auto b = two(250.0, 5e-4);
    int refused = 0;
    const auto evaluate = [&refused](const Eigen::VectorXd& at, bool gradient, NormalEquations& sum) {
        if (at[0] < 239.5 && at[0] > 239.0) {  // a hole on the way
            ++refused;
            return false;
        }
        return misra::evaluate(at, gradient, sum);
    };
    const auto summary = minimize(evaluate, b, two(-infinite, -infinite), two(infinite, infinite), exact());
    INFO("refused " << refused << " times");
    CHECK(summary.usable());
    CHECK(summary.finalCost <= summary.initialCost);
    const auto nowhere = [](const Eigen::VectorXd&, bool, NormalEquations&) { return false; };
    auto start = two(1.0, 1.0);
    const auto failed = minimize(nowhere, start, two(0.0, 0.0), two(2.0, 2.0), exact());
    CHECK(!failed.usable());
    CHECK(!failed.message.empty());
    CHECK(start == two(1.0, 1.0));
}

TEST_CASE("Where the slopes give out the search ends at the best place that has some", "[least-squares]")
{
    auto b = two(250.0, 5e-4);
    const auto start = b;
    const auto evaluate = [](const Eigen::VectorXd& at, bool gradient, NormalEquations& sum) {
        const bool ok = misra::evaluate(at, gradient, sum);
        if (gradient && at[0] < 239.5)  // a simulation whose derivatives run away where it does not itself
            sum.N.setConstant(infinite);
        return ok;
    };
    const auto summary = minimize(evaluate, b, two(-infinite, -infinite), two(infinite, infinite), exact());
    CHECK(summary.usable());
    CHECK_FALSE(summary.converged());
    CHECK(summary.finalCost < summary.initialCost);
    CHECK(b != start);
    NormalEquations there;
    REQUIRE(misra::evaluate(b, false, there));
    CHECK(there.cost == Approx(summary.finalCost));
}

TEST_CASE("A step of Gauss and Newton solves a linear problem at once", "[least-squares]")
{
    // A straight line through points, by its textbook formula; the third column is left out, the fourth is void.
    const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(20, -3.0, 5.0);
    Eigen::VectorXd y(20);
    for (Eigen::Index n = 0; n < 20; ++n)
        y[n] = 1.7 - 0.4 * x[n] + 0.1 * std::sin(7.0 * static_cast<double>(n));
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(20, 4);
    J.col(0).setOnes();
    J.col(1) = x;
    J.col(2) = x.array().square();
    NormalEquations normal;
    normal.N = J.transpose() * J;
    normal.g = -J.transpose() * y;
    const auto step = gaussNewtonStep(normal, {0, 1, 3});
    const double meanX = x.mean(), meanY = y.mean();
    const double slope = (x.array() - meanX).matrix().dot((y.array() - meanY).matrix())
                         / (x.array() - meanX).matrix().squaredNorm();
    CHECK(step[1] == Approx(slope).epsilon(1e-10));
    CHECK(step[0] == Approx(meanY - slope * meanX).epsilon(1e-10));
    CHECK(step[2] == 0.0);
    CHECK(step[3] == 0.0);
    CHECK(gaussNewtonStep(normal, {}).isZero());
}

TEST_CASE("A direction that the data does not see has no standard error", "[least-squares]")
{
    // Only the sum of the first two is seen, and the third on its own.
    Eigen::MatrixXd J(3, 3);
    J << 1.0, 1.0, 0.0, 2.0, 2.0, 0.0, 0.0, 0.0, 5.0;
    const auto covariance = covarianceOf(J.transpose() * J, 4.0);
    CHECK(std::isnan(covariance(0, 0)));
    CHECK(std::isnan(covariance(1, 1)));
    CHECK(covariance(2, 2) == Approx(4.0 / 25.0));
}

TEST_CASE("Search options that make no sense carry a reason", "[least-squares]")
{
    std::string reason;
    LeastSquaresOptions options;
    CHECK(options.isValid(&reason));
    options.maximumIterations = 0;
    CHECK(!options.isValid(&reason));
    CHECK(!reason.empty());
    options = {};
    options.costTolerance = 1.0;
    CHECK(!options.isValid(&reason));
}

TEST_CASE("What is noise for sure neither stops a search early nor changes what it finds", "[least-squares]")
{
    // Beside so many residuals that are nothing but noise the misfit of fourteen is too little for a tolerance of the
    // whole: the first step is the last.
    constexpr double noise = 1e9;
    const auto beside = [](double sure) {
        return [sure](const Eigen::VectorXd& b, bool gradient, NormalEquations& sum) {
            misra::evaluate(b, gradient, sum);
            sum.cost += noise;
            sum.rows += noise;
            sum.sure = sure;
            return true;
        };
    };
    LeastSquaresOptions options;
    options.costTolerance = 1e-4;
    const auto lower = two(-infinite, -infinite), upper = two(infinite, infinite);
    auto lost = two(500.0, 1e-4), found = lost;
    const auto early = minimize(beside(0.0), lost, lower, upper, options);
    const auto late = minimize(beside(noise), found, lower, upper, options);
    CHECK(early.finalCost - noise > 10.0 * misra::sumOfSquares);
    CHECK(late.finalCost - noise == Approx(misra::sumOfSquares).epsilon(1e-3));
    CHECK(found[0] == Approx(misra::b1).epsilon(1e-3));
    CHECK(late.converged());
}

namespace {

/// Rosenbrock's valley, ten times as steep: r = (100 (y - x^2), 1 - x).
class Valley {
public:
    /// How many slopes a search asks for until it is at the valley's end.
    /// @param top  the highest y
    int slopesFor(const ChordGradient& chord, const Retraction& retraction, double top)
    {
        const auto evaluate = [&](const Eigen::VectorXd& at, bool gradient, NormalEquations& sum) {
            last_ = Eigen::Vector2d(100.0 * (at[1] - at[0] * at[0]), 1.0 - at[0]);
            sum = NormalEquations(last_);
            if (gradient) {
                ++slopes_;
                J_ << -200.0 * at[0], 100.0, -1.0, 0.0;
                sum.differentiateBy(J_, last_);
            }
            return true;
        };
        auto at = two(-1.2, 1.0);
        slopes_ = 0;
        const auto summary = minimize(evaluate, at, two(-infinite, -infinite), two(infinite, top), exact(), {}, chord,
                                      retraction);
        INFO(summary.message);
        CHECK(summary.usable());
        CHECK(at[0] == Approx(1.0).epsilon(1e-6));
        CHECK(at[1] == Approx(1.0).epsilon(1e-6));
        return slopes_;
    }

    Eigen::VectorXd chord() const { return J_.transpose() * last_; }

private:
    int slopes_ = 0;
    Eigen::Matrix2d J_;
    Eigen::Vector2d last_;
};

}  // namespace

TEST_CASE("Steps that their own slopes correct go round the bend of a valley in fewer of them", "[least-squares]")
{
    Valley valley;
    const auto stepsFor = [&](const ChordGradient& chord) { return valley.slopesFor(chord, {}, infinite); };
    const int plain = stepsFor({}), corrected = stepsFor([&] { return valley.chord(); });
    INFO(plain << " steps, " << corrected << " that are corrected");
    CHECK(2 * corrected < plain);
    CHECK(stepsFor([] { return Eigen::VectorXd(); }) == plain);
}

TEST_CASE("Steps along a bend that is known need fewer slopes", "[least-squares]")
{
    const auto bent = [](const Eigen::VectorXd& from, const Eigen::VectorXd& d) -> Eigen::VectorXd {
        return two(from[0] + d[0], from[1] + d[1] + d[0] * d[0]);  // y = x^2 where the valley is lowest
    };
    Valley valley;
    const int straight = valley.slopesFor({}, {}, 1.5), along = valley.slopesFor({}, bent, 1.5);
    INFO(straight << " slopes, " << along << " along the bend");
    CHECK(2 * along < straight);
}

TEST_CASE("What is held moves in shorter steps to the same place", "[least-squares]")
{
    for (const double held : {0.0, 3.0}) {
        std::vector<double> way;
        const auto evaluate = [&](const Eigen::VectorXd& at, bool gradient, NormalEquations& sum) {
            const Eigen::Vector2d r(10.0 * (at[0] - 2.0), at[1] - 5.0);
            sum = NormalEquations(r);
            sum.held = two(0.0, held);
            if (gradient) {
                sum.differentiateBy(Eigen::Matrix2d {{10.0, 0.0}, {0.0, 1.0}}, r);
                way.push_back(at[1]);
            }
            return true;
        };
        auto at = two(0.0, 0.0);
        REQUIRE(minimize(evaluate, at, two(-infinite, -infinite), two(infinite, infinite), exact()).usable());
        CHECK(at[0] == Approx(2.0).epsilon(1e-6));
        CHECK(at[1] == Approx(5.0).epsilon(1e-4));
        REQUIRE(way.size() > 1);
        CHECK(way[1] == Approx(5.0 / (1.0 + held)).epsilon(0.01));
    }
}

TEST_CASE("A step that is corrected stays within its bounds", "[least-squares]")
{
    // The least of Rosenbrock's valley with x up to 0.5 is at its side, y = x^2.
    Eigen::Matrix2d J;
    Eigen::Vector2d last;
    const auto upper = two(0.5, infinite), lower = two(-infinite, -infinite);
    const auto evaluate = [&](const Eigen::VectorXd& at, bool gradient, NormalEquations& sum) {
        CHECK(at[0] <= 0.5);
        last = Eigen::Vector2d(10.0 * (at[1] - at[0] * at[0]), 1.0 - at[0]);
        sum = NormalEquations(last);
        if (gradient) {
            J << -20.0 * at[0], 10.0, -1.0, 0.0;
            sum.differentiateBy(J, last);
        }
        return true;
    };
    auto at = two(-1.2, 1.0);
    const auto summary = minimize(evaluate, at, lower, upper, exact(), {},
                                  [&]() -> Eigen::VectorXd { return J.transpose() * last; });
    CHECK(summary.converged());
    CHECK(at[0] == 0.5);
    CHECK(at[1] == Approx(0.25).epsilon(1e-6));
}

TEST_CASE("Slopes that are half wrong lead to the least error all the same", "[least-squares]")
{
    // What a step promises then never comes; the search goes on as long as steps go down.
    const auto evaluate = [](const Eigen::VectorXd& at, bool gradient, NormalEquations& sum) {
        const Eigen::Vector2d r(at[0] + 3.0 * at[1] - 5.0, 0.01 * (at[0] - at[1] - 1.0));
        sum = NormalEquations(r);
        if (gradient)
            sum.differentiateBy(Eigen::Matrix2d {{1.5, 4.0}, {0.006, -0.014}}, r);
        return true;
    };
    for (const double bound : {infinite, 2.5}) {
        auto at = two(0.0, 0.0);
        const auto summary = minimize(evaluate, at, two(-bound, -bound), two(bound, bound), exact());
        INFO(summary.message);
        CHECK(summary.usable());
        CHECK(at[0] == Approx(2.0).epsilon(1e-4));
        CHECK(at[1] == Approx(1.0).epsilon(1e-4));
    }
}

TEST_CASE("The trust region finds NIST's certified values, and stays within bounds", "[least-squares]")
{
    for (const auto& start : {two(500.0, 1e-4), two(250.0, 5e-4)}) {
        auto b = start;
        const auto summary = minimizeInTrustRegion(misra::evaluate, b, two(-infinite, -infinite),
                                                   two(infinite, infinite), exact());
        INFO(summary.message);
        CHECK(summary.usable());
        CHECK(b[0] == Approx(misra::b1).epsilon(1e-7));
        CHECK(b[1] == Approx(misra::b2).epsilon(1e-7));
        CHECK(summary.finalCost == Approx(misra::sumOfSquares).epsilon(1e-8));
    }
    auto free = two(250.0, 5e-4), held = free;
    const auto best = minimizeInTrustRegion(misra::evaluate, free, two(0.0, 0.0), two(infinite, infinite), exact());
    const auto bounded = minimizeInTrustRegion(misra::evaluate, held, two(0.0, 0.0), two(230.0, 1.0), exact());
    CHECK(bounded.usable());
    CHECK(held[0] == Approx(230.0).epsilon(1e-9));
    CHECK(bounded.finalCost > best.finalCost);
    auto ours = two(250.0, 5e-4);
    const auto other = minimize(misra::evaluate, ours, two(0.0, 0.0), two(230.0, 1.0), exact());
    CHECK(bounded.finalCost == Approx(other.finalCost).epsilon(1e-3));  // it ends a little early there
    CHECK(held[1] == Approx(ours[1]).epsilon(1e-2));
}
