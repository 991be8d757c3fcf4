// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Ranking/TaylorExpansion.h"

#include "Engine/Error.h"
#include "Engine/Loudspeaker/Dynamics.h"
#include "Engine/Numerics/Exponential.h"
#include "Engine/Numerics/QrFactors.h"
#include "Engine/Validity.h"

#include <cmath>
#include <map>
#include <random>

namespace excursion {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index motions = 3;  // i, x, v

/// f(z, u) of a model.
class RatesOf {
public:
    explicit RatesOf(const Model& model) : dynamics_(model, valuesOf(model)) {}

    Index order() const { return dynamics_.order(); }

    VectorXd operator()(const VectorXd& z, double u) const
    {
        VectorXd rate = VectorXd::Zero(order());
        dynamics_.rates(z.data(), u, rate.data());
        return rate;
    }

private:
    static std::vector<double> valuesOf(const Model& model)
    {
        const auto vector = parameterVector(model);
        return {vector.data(), vector.data() + vector.size()};
    }

    Dynamics<double> dynamics_;
};

/// The largest of what any component was fitted to hold for: of i, x and v.
Eigen::Vector3d visited(const Model& model)
{
    Eigen::Vector3d range = Eigen::Vector3d::Zero();
    for (const auto& component : model.components)
        range = range.cwiseMax(Eigen::Vector3d(component.operatingRange.current, component.operatingRange.displacement,
                                               component.operatingRange.velocity));
    return range;
}

double power(const Eigen::RowVectorXi& exponents, const Eigen::Vector3d& w)
{
    double value = 1.0;
    for (Index v = 0; v < motions; ++v)
        value *= std::pow(w[v], exponents[v]);
    return value;
}

void requireAffine(const RatesOf& rates, const Eigen::Vector3d& w, const std::vector<VectorXd>& slopes,
                   const VectorXd& atRest, std::mt19937& random)
{
    const auto n = rates.order();
    std::normal_distribution<double> normal;
    VectorXd z(n);
    z.head(motions) = w;
    VectorXd expected = atRest;
    for (Index a = motions; a < n; ++a) {
        z[a] = normal(random);
        expected += z[a] * slopes[static_cast<std::size_t>(a - motions)];
    }
    const double u = normal(random);
    expected += u * slopes.back();
    if (!((rates(z, u) - expected).norm() <= 1e-6 * (expected.norm() + 1e-300)))
        throw Error(Error::Kind::numerical,
                    "The model's equations are not affine in its memories, so this expansion does not hold for it.");
}

}  // namespace

bool TaylorOptions::isValid(std::string* reason) const
{
    const bool valid = degree >= 1 && degree <= 9 && reach > 1e-4 && reach <= 1.0;
    return valid || refuse(reason, "a Taylor expansion needs a degree of 1 to 9 and a reach above 1e-4, at most 1");
}

FractionalPnlss expand(const Model& model, Quantity output, const TaylorOptions& options)
{
    std::string reason;
    if (!options.isValid(&reason))
        throw Error(Error::Kind::usage, "The model cannot be expanded: " + reason + ".");
    const RatesOf rates(model);
    const auto n = rates.order(), affine = n - motions + 1;  // memories, and the input
    const bool guarded = options.reach < 0.1;
    const int fitted = options.degree + (guarded ? 2 : 0);
    Exponents basis(1, motions);
    basis.setZero();
    const auto rising = monomials(static_cast<int>(motions), 1, fitted);
    basis.conservativeResize(1 + rising.rows(), motions);
    basis.bottomRows(rising.rows()) = rising;

    // Points within the reach, and at each f_0 and all f_a
    const Eigen::Vector3d scale = options.reach * visited(model);
    std::mt19937 random(1);
    std::uniform_real_distribution<double> within(-1.0, 1.0);
    const Index points = 4 * basis.rows();
    MatrixXd M(points, basis.rows());
    std::vector<MatrixXd> values(static_cast<std::size_t>(affine + 1), MatrixXd(points, n));  // f_0, then f_a
    for (Index k = 0; k < points; ++k) {
        Eigen::Vector3d s;
        for (auto& value : s)
            value = within(random);
        for (Index b = 0; b < basis.rows(); ++b)
            M(k, b) = power(basis.row(b), s);
        VectorXd z = VectorXd::Zero(n);
        z.head(motions) = s.cwiseProduct(scale);
        const VectorXd zero = rates(z, 0.0);
        std::vector<VectorXd> slopes;
        for (Index a = motions; a < n; ++a) {
            VectorXd moved = z;
            moved[a] = 1.0;
            slopes.push_back(rates(moved, 0.0) - zero);
        }
        slopes.push_back(rates(z, 1.0) - zero);
        if (k < 3)
            requireAffine(rates, z.head<3>(), slopes, zero, random);
        values[0].row(k) = zero.transpose();
        for (std::size_t a = 0; a < slopes.size(); ++a)
            values[a + 1].row(k) = slopes[a].transpose();
    }
    // Polynomials in w/scale, then monomials in z and u with their coefficients, by exponents
    const QrFactors qr(M);
    std::map<std::vector<int>, VectorXd> terms;
    for (std::size_t a = 0; a < values.size(); ++a) {
        const MatrixXd c = qr.solve(values[a]);
        for (Index b = 0; b < basis.rows(); ++b) {
            std::vector<int> exponents(static_cast<std::size_t>(n + 1), 0);
            for (Index v = 0; v < motions; ++v)
                exponents[static_cast<std::size_t>(v)] = basis(b, v);
            if (a > 0)
                exponents[static_cast<std::size_t>(motions) + a - 1] = 1;
            const int degree = basis.row(b).sum() + (a > 0 ? 1 : 0);
            if (degree == 0 || degree > options.degree)
                continue;
            terms[exponents] = c.row(b).transpose() / power(basis.row(b), scale);
        }
    }
    // What a coefficient does over the visited range, against what all of its row do
    const Eigen::Vector3d range = visited(model);
    VectorXd largest = VectorXd::Zero(n);
    for (const auto& [exponents, c] : terms) {
        const Eigen::RowVectorXi w = Eigen::Map<const Eigen::RowVectorXi>(exponents.data(), motions);
        largest = largest.cwiseMax(c.cwiseAbs() * power(w, range));
    }
    for (auto& [exponents, c] : terms) {
        const Eigen::RowVectorXi w = Eigen::Map<const Eigen::RowVectorXi>(exponents.data(), motions);
        for (Index i = 0; i < n; ++i)
            if (std::abs(c[i]) * power(w, range) < 1e-9 * largest[i])
                c[i] = 0.0;
    }

    FractionalPnlss result;
    result.alpha = 0.5;
    result.fractional = Eigen::Array<bool, Eigen::Dynamic, 1>::Constant(n, false);
    auto& form = result.form;
    form.linear.A = MatrixXd::Zero(n, n);
    form.linear.B = MatrixXd::Zero(n, 1);
    std::vector<std::pair<Eigen::RowVectorXi, VectorXd>> kept;
    for (const auto& [exponents, c] : terms) {
        const Eigen::RowVectorXi e = Eigen::Map<const Eigen::RowVectorXi>(exponents.data(), n + 1);
        if (e.sum() == 1) {
            Index v = 0;
            e.maxCoeff(&v);
            if (v < n)
                form.linear.A.col(v) = c;
            else
                form.linear.B.col(0) = c;
        } else if (!c.isZero(0.0)) {
            kept.emplace_back(e, c);
        }
    }
    const auto K = static_cast<Index>(kept.size());
    form.exponents.resize(K, n + 1);
    form.E.resize(n, K);
    for (Index k = 0; k < K; ++k) {
        form.exponents.row(k) = kept[static_cast<std::size_t>(k)].first;
        form.E.col(k) = kept[static_cast<std::size_t>(k)].second;
    }
    form.linear.C = MatrixXd::Zero(1, n);
    form.linear.D = MatrixXd::Zero(1, 1);
    form.F = MatrixXd::Zero(1, K);
    switch (output) {
    case Quantity::current: form.linear.C(0, 0) = 1.0; break;
    case Quantity::displacement: form.linear.C(0, 1) = 1.0; break;
    case Quantity::velocity: form.linear.C(0, 2) = 1.0; break;
    case Quantity::acceleration:
        form.linear.C = form.linear.A.row(2);
        form.linear.D = form.linear.B.row(2);
        form.F = form.E.row(2);
        break;
    default:
        throw Error(Error::Kind::usage,
                    "A driver is expanded with its current, displacement, velocity or acceleration as the output.");
    }
    form.free.resize(n + 1, K);
    form.free.topRows(n) = form.E.array() != 0.0;
    form.free.bottomRows(1) = form.F.array() != 0.0;
    return result;
}

Pnlss discretized(const FractionalPnlss& model, double sampleRate)
{
    if (model.fractional.any() || !(sampleRate > 0.0))
        throw Error(Error::Kind::usage,
                    "Only a model of whole orders is discretized by holding its input, at a sample rate above 0 Hz.");
    const auto n = model.form.linear.order();
    MatrixXd S(n, n), decay(n, n);
    for (Index j = 0; j < n; ++j) {
        const auto stepped = exponential(model.form.linear.A, VectorXd::Unit(n, j), 1.0 / sampleRate, 1);
        decay = stepped.decay;
        S.col(j) = stepped.phi.col(0);
    }
    Pnlss result = model.form;
    result.linear.sampleRate = sampleRate;
    result.linear.A = decay;
    result.linear.B = S * model.form.linear.B;
    result.E = S * model.form.E;
    // A monomial acts on all states that S couples.
    for (Index k = 0; k < result.terms(); ++k)
        for (Index i = 0; i < n; ++i)
            result.free(i, k) = result.E(i, k) != 0.0;
    return result;
}

}  // namespace excursion
