// SPDX-License-Identifier: GPL-3.0-or-later
// The search on problems that are known, without any recursion.
#include "Engine/Error.h"
#include "Engine/Numerics/Search.h"
#include "Engine/Numerics/TallQr.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

using namespace excursion;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Rosenbrock's valley, e = (b (y - x^2), 1 - x), which is the narrower the larger b is; and a place beyond which
/// nothing is finite.
class Valley final : public SearchProblem {
public:
    Valley(double steepness, bool bends) : b_(steepness), bends_(bends) {}

    double cost(const VectorXd& v) override
    {
        return v[0] > 3.0 ? std::numeric_limits<double>::infinity() : error(v).squaredNorm();
    }

    MatrixXd factor(const VectorXd& v) override
    {
        MatrixXd rows(2, 3);
        rows << jacobian(v), error(v);
        TallQr qr(3);
        qr.fold(rows);
        return qr.R();
    }

    VectorXd curvature(const VectorXd& v, const VectorXd& step) override
    {
        if (!bends_)
            return {};
        return jacobian(v).transpose() * Eigen::Vector2d(-2.0 * b_ * step[0] * step[0], 0.0);
    }

private:
    VectorXd error(const VectorXd& v) const { return Eigen::Vector2d(b_ * (v[1] - v[0] * v[0]), 1.0 - v[0]); }
    MatrixXd jacobian(const VectorXd& v) const
    {
        Eigen::Matrix2d J;
        J << 2.0 * b_ * v[0], -b_, 1.0, 0.0;
        return J;
    }

    double b_;
    bool bends_;
};

}  // namespace

TEST_CASE("A search finds the end of a narrow curved valley, and sooner where it knows how the valley bends")
{
    for (const double steepness : {10.0, 100.0, 1e3}) {
        CAPTURE(steepness);
        int iterations[2];
        for (const bool bends : {false, true}) {
            Valley valley(steepness, bends);
            SearchOptions options;
            options.maximumIterations = 5000;
            const auto found = search(valley, Eigen::Vector2d(-1.2, 1.0), options);
            CHECK(found.converged());
            CHECK(found.finalCost < 1e-25);
            CHECK(found.values[0] == Approx(1.0).margin(1e-10));
            CHECK(found.values[1] == Approx(1.0).margin(1e-10));
            iterations[bends] = found.iterations;
        }
        CAPTURE(iterations[0], iterations[1]);
        CHECK(3 * iterations[1] < iterations[0]);
    }
}

TEST_CASE("A search says why it stopped, tells of what it takes, and may go on")
{
    Valley valley(100.0, false);
    SearchOptions options;
    options.maximumIterations = 3;
    std::vector<double> costs;
    int begun = 0;
    options.begun = [&] { ++begun; };
    options.accepted = [&](const VectorXd&, double cost) { costs.push_back(cost); };
    const auto first = search(valley, Eigen::Vector2d(-1.2, 1.0), options);
    CHECK_FALSE(first.converged());
    CHECK(first.termination == Termination::maximumIterations);
    CHECK(begun == 3);
    REQUIRE(costs.size() == 4);
    CHECK(std::is_sorted(costs.rbegin(), costs.rend()));
    CHECK(costs.back() == first.finalCost);

    // With the damping that was reached, two searches are one.
    options.maximumIterations = 6;
    const auto whole = search(valley, Eigen::Vector2d(-1.2, 1.0), options);
    options.maximumIterations = 3;
    options.damping.last = first.damping;
    const auto second = search(valley, first.values, options);
    CHECK(second.finalCost == whole.finalCost);

    const auto nowhere = search(valley, Eigen::Vector2d(4.0, 0.0), options);
    CHECK_FALSE(nowhere.converged());
    CHECK(nowhere.iterations == 0);
    CHECK(nowhere.termination == Termination::startUndefined);
}

TEST_CASE("A search reports failure where it must fail, and what ended it where it does not", "[search]")
{
    CHECK(SearchSummary().termination == Termination::notRun);
    CHECK_FALSE(SearchSummary().usable());
    Valley valley(10.0, false);
    SearchOptions options;
    options.maximumIterations = 0;
    const auto none = search(valley, Eigen::Vector2d(-1.2, 1.0), options);
    CHECK(none.termination == Termination::maximumIterations);
    CHECK(none.usable());
    CHECK_FALSE(none.converged());
    CHECK(none.finalCost == none.initialCost);
    CHECK(search(valley, VectorXd()).termination == Termination::nothingFree);

    const auto whole = search(valley, Eigen::Vector2d(-1.2, 1.0));
    CHECK(whole.termination == Termination::rounding);
    CHECK(whole.initialCost == valley.cost(Eigen::Vector2d(-1.2, 1.0)));
    CHECK(whole.message == sentenceFor(Termination::rounding));
    // From the end there is nowhere to go.
    options = {};
    options.roundingCost = 0.0;
    CHECK(search(valley, Eigen::Vector2d(1.0, 1.0), options).termination == Termination::noBetterStep);

    class Blind final : public SearchProblem {
        double cost(const VectorXd&) override { return 1.0; }
        MatrixXd factor(const VectorXd&) override { return MatrixXd::Constant(2, 2, std::nan("")); }
    } blind;
    const auto broken = search(blind, VectorXd::Ones(1));
    CHECK(broken.termination == Termination::brokeDown);
    CHECK_FALSE(broken.usable());
    CHECK(broken.values == VectorXd::Ones(1));
    CHECK(broken.message.size() > std::string(sentenceFor(Termination::brokeDown)).size());
}

TEST_CASE("A step may have fewer numbers than a place: the point of a circle next to another", "[search]")
{
    // Values are the point, a step is an angle.
    class Circle final : public SearchProblem {
        double cost(const VectorXd& at) override { return (aim - at).squaredNorm(); }
        MatrixXd factor(const VectorXd& at) override
        {
            MatrixXd rows(2, 2);
            rows << Eigen::Vector2d(-at[1], at[0]), aim - at;
            TallQr qr(2);
            qr.fold(rows);
            return qr.R();
        }
        VectorXd moved(const VectorXd& at, const VectorXd& step) override
        {
            const double c = std::cos(step[0]), s = std::sin(step[0]);
            return Eigen::Vector2d(c * at[0] - s * at[1], s * at[0] + c * at[1]);
        }
        const Eigen::Vector2d aim {3.0, 4.0};
    } circle;
    for (const auto& damping : {Damping {}, Damping::steady()}) {
        SearchOptions options;
        options.costTolerance = 1e-15;
        options.damping = damping;
        const auto found = search(circle, Eigen::Vector2d(-1.0, 0.0), options);
        CHECK(found.converged());
        CHECK(found.values[0] == Approx(0.6).epsilon(1e-7));
        CHECK(found.values[1] == Approx(0.8).epsilon(1e-7));
        CHECK(found.values.norm() == Approx(1.0).epsilon(1e-14));
        CHECK(found.finalCost == Approx(16.0).epsilon(1e-14));
    }
}

TEST_CASE("Options of a search that make no sense carry a reason, and every end of one a sentence of its own",
          "[search]")
{
    Valley valley(10.0, false);
    const auto refused = [&](auto change) {
        SearchOptions options;
        change(options);
        std::string reason;
        CHECK_FALSE(options.isValid(&reason));
        CHECK_FALSE(reason.empty());
        CHECK_THROWS_AS(search(valley, Eigen::Vector2d(0.0, 0.0), options), Error);
    };
    CHECK(SearchOptions().isValid());
    SearchOptions least;  // the bounds themselves are allowed
    least.maximumIterations = 0;
    least.settledSteps = 1;
    least.costTolerance = least.rankTolerance = least.roundingCost = 0.0;
    least.damping.attempts = 1;
    least.damping.least = 0.0;
    CHECK(least.isValid());
    refused([](auto& o) { o.maximumIterations = -1; });
    refused([](auto& o) { o.settledSteps = 0; });
    refused([](auto& o) { o.costTolerance = 1.0; });
    refused([](auto& o) { o.rankTolerance = std::nan(""); });
    refused([](auto& o) { o.roundingCost = -1.0; });
    refused([](auto& o) { o.damping.fall = 1.0; });
    refused([](auto& o) { o.damping.attempts = 0; });
    refused([](auto& o) { o.damping.last = 0.0; });

    std::vector<std::string> sentences;
    for (int k = 0; k <= static_cast<int>(Termination::solvedAtOnce); ++k) {
        SearchSummary summary;
        summary.end(static_cast<Termination>(k));
        CAPTURE(summary.message);
        CHECK(summary.message == sentenceFor(summary.termination));
        CHECK(summary.message.back() != '.');
        CHECK(std::find(sentences.begin(), sentences.end(), summary.message) == sentences.end());
        sentences.push_back(summary.message);
        if (summary.converged())
            CHECK(summary.usable());
    }
}
