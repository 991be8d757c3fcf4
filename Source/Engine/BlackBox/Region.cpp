// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/BlackBox/Region.h"

#include "Engine/Error.h"
#include "Engine/Numerics/Eigenvalues.h"
#include "Engine/Numerics/LuFactors.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double widening = 1.05;  // of the ellipsoid, as the phases of the records were others
constexpr double thinnest = 1e-6;  // variance of an axis, of the thickest, each coordinate scaled to 1
constexpr int implicitSteps = 6;   // for z, which depends on q at fractional orders

/// The equations as they stand in BlackBox.h, step by step.
class PlainRecursion {
public:
    explicit PlainRecursion(const BlackBox& box) : box_(box), x(VectorXd::Zero(box.linear.order()))
    {
        q = VectorXd::Zero(box.combinations());
        s = VectorXd::Zero(box.seen() + 1);
        p_ = VectorXd::Zero(box.exponents.rows());
    }

    double step(double u)
    {
        const auto seen = box_.seen();
        const VectorXd explicitly = box_.S * x + box_.T * u;
        s[seen] = u;
        const bool implicit = !box_.G.isZero(0.0);
        for (int k = 0; k < (implicit ? implicitSteps : 1); ++k) {
            s.head(seen) = explicitly + box_.G * q;
            for (Index m = 0; m < p_.size(); ++m) {
                double value = 1.0;
                for (Index v = 0; v <= seen; ++v)
                    for (int power = box_.exponents(m, v); power > 0; --power)
                        value *= s[v];
                p_[m] = value;
            }
            q = box_.R * p_;
        }
        const double y = box_.linear.C.row(0).dot(x) + box_.linear.D(0, 0) * u + box_.F.row(0).dot(q);
        x = (box_.linear.A * x + box_.linear.B * u + box_.E * q).eval();
        return y;
    }

private:
    const BlackBox& box_;
    VectorXd p_;

public:
    VectorXd x, q, s;  ///< the state of the next sample; the latest combinations, and place
};

}  // namespace

VectorXd simulate(const BlackBox& box, const VectorXd& input)
{
    PlainRecursion run(box);
    VectorXd output(input.size());
    for (Index t = 0; t < input.size(); ++t)
        output[t] = run.step(input[t]);
    return output;
}

Rest restOf(const BlackBox& box)
{
    PlainRecursion run(box);
    const auto n = box.linear.order();
    const bool constant = box.exponents.rows() > 0 && (box.exponents.rowwise().sum().array() == 0).any();
    if (!constant)
        return {run.x, run.q};
    // Newton's method would need slopes; the equation x = (I - A)^-1 E q(x) contracts, as constants are small.
    const RealLu solver(MatrixXd::Identity(n, n) - box.linear.A);
    VectorXd before = run.x;
    for (int k = 0; k < 200; ++k) {
        run.x = before;
        run.step(0.0);
        const VectorXd now = solver.solve(box.E * run.q);
        const bool still = (now - before).norm() <= 1e-12 * (now.norm() + 1e-300);
        before = now;
        if (still)
            return {now, run.q};
        if (!now.allFinite())
            break;
    }
    throw Error(Error::Kind::data, "The model does not come to rest in silence: its constants move it too far.");
}

Region visitedBy(const BlackBox& box)
{
    const double rate = box.linear.sampleRate;
    int period = 4096;
    while (period < 1 << 17 && rate / period > 0.2 * box.stimulus.lowest())
        period *= 2;
    Region region;
    const auto size = box.seen() + 1;
    region.centre = VectorXd::Zero(size);
    MatrixXd moments = MatrixXd::Zero(size, size);
    std::vector<VectorXd> places;
    const Rest rest = restOf(box);
    double outputs = 0.0, power = 0.0;
    for (const std::uint64_t seed : {1U, 2U}) {
        PlainRecursion run(box);
        run.x = rest.x;
        run.q = rest.q;
        const double still = box.linear.C.row(0).dot(rest.x) + box.F.row(0).dot(rest.q);
        const auto input = playedAs(box.stimulus, rate, period, seed);
        for (int t = -period / 2; t < period; ++t) {
            const double y = run.step(input[static_cast<std::size_t>((t + period) % period)]);
            if (!std::isfinite(y) || !run.s.allFinite())
                throw Error(Error::Kind::data,
                            "The model runs away when it plays what it was fitted under, so it cannot be used.");
            if (t < 0)
                continue;
            region.centre += run.s;
            moments += run.s * run.s.transpose();
            places.push_back(run.s);
            outputs += y;
            power += y * y;
            region.farthest = std::max(region.farthest, std::abs(y - still));
        }
    }
    const auto count = static_cast<double>(places.size());
    region.centre /= count;
    region.output = std::sqrt(std::max(power / count - std::pow(outputs / count, 2), 0.0));
    moments = (moments / count - region.centre * region.centre.transpose()).eval();
    VectorXd scale = moments.diagonal().cwiseMax(0.0).cwiseSqrt();
    for (auto& one : scale)
        one = one > 0.0 ? 1.0 / one : 0.0;  // a place that never moves is not looked at
    const auto axes = symmetricEigenvectors(scale.asDiagonal() * moments * scale.asDiagonal());
    const VectorXd variance = axes.values.cwiseMax(thinnest * axes.values.maxCoeff());
    region.W = variance.cwiseSqrt().cwiseInverse().asDiagonal() * axes.vectors.transpose() * scale.asDiagonal();
    double furthest = 0.0;
    for (const auto& place : places)
        furthest = std::max(furthest, region.distance(place));
    region.W /= widening * furthest;
    return region;
}

}  // namespace excursion
