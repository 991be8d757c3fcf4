// SPDX-License-Identifier: GPL-3.0-or-later
// The search on problems that are known, without any recursion.
#include "Engine/Linear/TallQr.h"
#include "Engine/Polynomial/Search.h"
#include "Linear/Problem.h"

#include <algorithm>
#include <cmath>

using namespace excursion;
using namespace excursion::test;
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
            CHECK(found.converged);
            CHECK(found.cost < 1e-25);
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
    CHECK_FALSE(first.converged);
    CHECK(first.reason == "the largest number of iterations was reached");
    CHECK(begun == 3);
    REQUIRE(costs.size() == 4);
    CHECK(std::is_sorted(costs.rbegin(), costs.rend()));
    CHECK(costs.back() == first.cost);

    // With the damping that was reached, two searches are one.
    options.maximumIterations = 6;
    const auto whole = search(valley, Eigen::Vector2d(-1.2, 1.0), options);
    options.maximumIterations = 3;
    options.damping = first.damping;
    const auto second = search(valley, first.values, options);
    CHECK(second.cost == whole.cost);

    const auto nowhere = search(valley, Eigen::Vector2d(4.0, 0.0), options);
    CHECK_FALSE(nowhere.converged);
    CHECK(nowhere.iterations == 0);
    CHECK(nowhere.reason == "the model runs away at its start");
}
