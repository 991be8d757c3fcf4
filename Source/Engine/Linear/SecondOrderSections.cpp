// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Linear/SecondOrderSections.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace excursion {

using Complex = std::complex<double>;
using Eigen::Index;

SecondOrderSections sectionsOf(const std::vector<Complex>& poles, double sampleRate, double scale, double alpha)
{
    SecondOrderSections sections;
    sections.sampleRate = sampleRate;
    sections.scale = scale;
    sections.alpha = alpha;
    sections.factors.resize(static_cast<Index>(poles.size()));
    std::vector<double> real;
    Index at = 0;
    for (const auto& pole : poles) {
        const Complex mu = (sampleRate > 0.0 ? pole - 1.0 : pole) / scale;
        if (mu.imag() == 0.0)
            real.push_back(mu.real());
        else if (mu.imag() > 0.0) {
            sections.factors[at++] = -2.0 * mu.real();
            sections.factors[at++] = std::norm(mu);
        }
    }
    std::sort(real.begin(), real.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
    std::size_t k = 0;
    for (; k + 1 < real.size(); k += 2) {
        sections.factors[at++] = -(real[k] + real[k + 1]);
        sections.factors[at++] = real[k] * real[k + 1];
    }
    if (k < real.size())
        sections.factors[at++] = -real[k];
    sections.factors.conservativeResize(at);
    return sections;
}

std::vector<Complex> poles(const SecondOrderSections& sections)
{
    const double shift = sections.sampleRate > 0.0 ? 1.0 : 0.0;
    std::vector<Complex> result;
    for (Index i = 0; i < sections.pairs(); ++i) {
        const double b = sections.factors[2 * i], e = sections.factors[2 * i + 1];
        const double d = 0.25 * b * b - e;
        if (d < 0.0) {
            result.push_back(shift + sections.scale * Complex(-0.5 * b, -std::sqrt(-d)));
            result.push_back(std::conj(result.back()));
        } else {
            const double far = b >= 0.0 ? -0.5 * b - std::sqrt(d) : -0.5 * b + std::sqrt(d);
            result.push_back(shift + sections.scale * far);
            result.push_back(shift + sections.scale * (far != 0.0 ? e / far : 0.0));
        }
    }
    if (sections.odd())
        result.push_back(shift - sections.scale * sections.factors[sections.order() - 1]);
    return result;
}

bool isStable(const SecondOrderSections& sections)
{
    const bool discrete = sections.sampleRate > 0.0;
    const double border = sections.alpha == 1.0 ? 0.0 : -2.0 * std::cos(0.5 * std::numbers::pi * sections.alpha);
    for (Index i = 0; i < sections.pairs(); ++i) {
        const double b = sections.factors[2 * i], e = sections.factors[2 * i + 1];
        // Jury's conditions for z^2 + (b - 2) z + (1 - b + e)
        // in continuous time -b/(2 sqrt(e)) is the cosine of a complex pair's angle, and beyond 1 in size for two real
        // roots of one sign
        if (discrete ? !(e < b && e > 0.0 && 4.0 - 2.0 * b + e > 0.0) : !(e > 0.0 && b > border * std::sqrt(e)))
            return false;
    }
    if (!sections.odd())
        return true;
    const double a = sections.factors[sections.order() - 1];
    return discrete ? a > 0.0 && a < 2.0 : a > 0.0;
}

SecondOrderSections mirrored(const SecondOrderSections& sections)
{
    auto roots = poles(sections);
    for (auto& root : roots) {
        if (sections.sampleRate > 0.0) {
            if (std::norm(root) >= 1.0)
                root /= std::max(std::norm(root), 1.0 + 1e-9);
        } else if (sections.alpha != 1.0) {
            const double border = 0.5 * std::numbers::pi * sections.alpha, angle = std::abs(std::arg(root));
            const double size = std::max(std::abs(root), 1e-18 * sections.scale);
            if (root.imag() == 0.0)
                root = -size;
            else if (angle <= border) {
                const double beyond = std::clamp(2.0 * border - angle, border + 1e-9,
                                                 0.5 * (border + std::numbers::pi));
                root = std::polar(size, std::copysign(beyond, root.imag()));
            }
        } else if (root.real() >= 0.0)
            root = {-std::max(root.real(), 1e-9 * std::max(std::abs(root.imag()), 1e-9 * sections.scale)), root.imag()};
    }
    return sectionsOf(roots, sections.sampleRate, sections.scale, sections.alpha);
}

Eigen::MatrixXcd partialFractions(const SecondOrderSections& sections, const Eigen::VectorXcd& lambda)
{
    Eigen::MatrixXcd basis(lambda.size(), sections.order());
    const double unit = 1.0 / sections.scale;
    for (Index i = 0; i < sections.pairs(); ++i) {
        const double b = sections.factors[2 * i], e = sections.factors[2 * i + 1];
        for (Index k = 0; k < lambda.size(); ++k) {
            const double x = unit * lambda[k].real(), y = unit * lambda[k].imag();
            const double re = x * x - y * y + b * x + e, im = (2.0 * x + b) * y;
            const double size = 1.0 / (re * re + im * im);
            const double p = re * size, q = -im * size, h = x + 0.5 * b;
            basis(k, 2 * i) = {p, q};
            basis(k, 2 * i + 1) = {h * p - y * q, h * q + y * p};
        }
    }
    if (sections.odd())
        basis.col(sections.order() - 1) = (unit * lambda.array() + sections.factors[sections.order() - 1]).inverse();
    return basis;
}

Eigen::MatrixXcd partialFractionSlopes(const SecondOrderSections& sections, const Eigen::VectorXcd& lambda,
                                       const Eigen::MatrixXcd& basis, const Eigen::VectorXd& c)
{
    Eigen::MatrixXcd slopes(basis.rows(), basis.cols());
    const double unit = 1.0 / sections.scale;
    for (Index i = 0; i < sections.pairs(); ++i)
        for (Index k = 0; k < basis.rows(); ++k) {
            const Complex f = basis(k, 2 * i), g = basis(k, 2 * i + 1);
            const double mr = c[2 * i] * f.real() + c[2 * i + 1] * g.real(),
                         mi = c[2 * i] * f.imag() + c[2 * i + 1] * g.imag();
            // -m/q = dm/de
            const double er = -(mr * f.real() - mi * f.imag()), ei = -(mr * f.imag() + mi * f.real());
            const double x = unit * lambda[k].real(), y = unit * lambda[k].imag(), half = 0.5 * c[2 * i + 1];
            slopes(k, 2 * i) = {x * er - y * ei + half * f.real(), x * ei + y * er + half * f.imag()};
            slopes(k, 2 * i + 1) = {er, ei};
        }
    if (sections.odd()) {
        const Index last = sections.order() - 1;
        slopes.col(last) = -c[last] * basis.col(last).cwiseProduct(basis.col(last));
    }
    return slopes;
}

StateSpace realize(const SecondOrderSections& sections, const Eigen::MatrixXd& C, const Eigen::VectorXd& D)
{
    const auto n = sections.order();
    StateSpace model;
    model.sampleRate = sections.sampleRate;
    model.A = Eigen::MatrixXd::Zero(n, n);
    model.B = Eigen::VectorXd::Zero(n);
    model.C = C;
    model.D = D;
    // x1 = u/q, x2 = (mu + b/2) u/q:  mu x1 = -b/2 x1 + x2,  mu x2 = (b^2/4 - e) x1 - b/2 x2 + u; then x1 is stretched
    // to t x1.
    for (Index i = 0; i < sections.pairs(); ++i) {
        const double b = sections.factors[2 * i], e = sections.factors[2 * i + 1], d = 0.25 * b * b - e;
        const double t = std::max(std::sqrt(std::abs(d)), 1e-3 * std::max(std::abs(0.5 * b), std::sqrt(std::abs(e))));
        model.A.block(2 * i, 2 * i, 2, 2) << -0.5 * b, t, d / t, -0.5 * b;
        model.B(2 * i + 1, 0) = 1.0;
        model.C.col(2 * i) /= t;
    }
    if (sections.odd()) {
        model.A(n - 1, n - 1) = -sections.factors[n - 1];
        model.B(n - 1, 0) = 1.0;
    }
    model.A *= sections.scale;
    model.B *= sections.scale;
    if (sections.sampleRate > 0.0)
        model.A.diagonal().array() += 1.0;
    const auto level = [&model](Index first, Index size) {
        const double b = model.B.middleRows(first, size).norm(), c = model.C.middleCols(first, size).norm();
        if (!(b > 0.0 && c > 0.0))
            return;
        const double s = std::sqrt(c / b);
        model.B.middleRows(first, size) *= s;
        model.C.middleCols(first, size) /= s;
    };
    for (Index i = 0; i < sections.pairs(); ++i)
        level(2 * i, 2);
    if (sections.odd())
        level(n - 1, 1);
    return model;
}

}  // namespace excursion
