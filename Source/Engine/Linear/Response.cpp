// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Linear/Response.h"

#include "Engine/Error.h"
#include "Engine/Numerics/Schur.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace excursion {

using Complex = std::complex<double>;
using Eigen::Index;

Complex evaluationPoint(double frequency, double sampleRate, double alpha)
{
    const double omega = 2.0 * std::numbers::pi * frequency;
    if (sampleRate == 0.0)
        return alpha == 1.0 ? Complex(0.0, omega) : std::polar(std::pow(omega, alpha), 0.5 * std::numbers::pi * alpha);
    const double half = 0.5 * omega / sampleRate, s = std::sin(half), c = std::cos(half);
    return {-2.0 * s * s, 2.0 * s * c};
}

Eigen::VectorXcd evaluationPoints(const std::vector<double>& frequency, double sampleRate, double alpha)
{
    Eigen::VectorXcd points(static_cast<Index>(frequency.size()));
    for (Index k = 0; k < points.size(); ++k)
        points[k] = evaluationPoint(frequency[static_cast<std::size_t>(k)], sampleRate, alpha);
    return points;
}

Resolvent::Resolvent(const StateSpace& model)
{
    std::string reason;
    if (!model.isValid(&reason))
        throw Error(Error::Kind::usage, "The model has no frequency response: " + reason + ".");
    D_ = model.D.cast<Complex>();
    if (model.order() == 0)
        return;
    Eigen::MatrixXd L = model.A;
    if (!model.continuous())
        L.diagonal().array() -= 1.0;
    auto schur = complexSchur(L);
    T_ = std::move(schur.T);
    U_ = std::move(schur.U);
    CU_ = model.C.cast<Complex>() * U_;
    UB_ = U_.adjoint() * model.B.cast<Complex>();
}

Eigen::MatrixXcd Resolvent::solveLeft(Complex lambda) const
{
    // X (lambda I - T) = C U, column by column: x_j = (c_j + sum_{i<j} x_i T_ij) / (lambda - T_jj)
    const auto n = T_.rows(), p = CU_.rows();
    Eigen::MatrixXcd X(p, n);
    for (Index o = 0; o < p; ++o)
        for (Index j = 0; j < n; ++j) {
            double re = CU_(o, j).real(), im = CU_(o, j).imag();
            for (Index i = 0; i < j; ++i) {
                const Complex x = X(o, i), t = T_(i, j);
                re += x.real() * t.real() - x.imag() * t.imag();
                im += x.real() * t.imag() + x.imag() * t.real();
            }
            X(o, j) = Complex(re, im) / (lambda - T_(j, j));
        }
    return X;
}

Eigen::MatrixXcd Resolvent::left(Complex lambda) const { return solveLeft(lambda) * U_.adjoint(); }

Eigen::MatrixXcd Resolvent::response(Complex lambda) const
{
    if (T_.rows() == 0)
        return D_;
    return solveLeft(lambda) * UB_ + D_;
}

std::vector<Eigen::MatrixXcd> respond(const StateSpace& model, const std::vector<double>& frequency)
{
    const Resolvent resolvent(model);
    std::vector<Eigen::MatrixXcd> result;
    result.reserve(frequency.size());
    for (const double f : frequency)
        result.push_back(resolvent.response(evaluationPoint(f, model.sampleRate)));
    return result;
}

Frf frfOf(const StateSpace& model, const std::vector<double>& frequency, Index output, Index input)
{
    Frf frf;
    frf.frequency = frequency;
    const Resolvent resolvent(model);
    for (const double f : frequency)
        frf.value.push_back(resolvent.response(evaluationPoint(f, model.sampleRate))(output, input));
    return frf;
}

FrequencyData sampled(const StateSpace& model, int lines, double alpha)
{
    double slow = std::numeric_limits<double>::infinity(), fast = 0.0;
    for (auto pole : poles(model)) {
        const double size = model.continuous() ? std::pow(std::abs(pole), 1.0 / alpha)
                                               : std::abs(pole - 1.0) * model.sampleRate;
        if (size > 0.0) {
            slow = std::min(slow, size);
            fast = std::max(fast, size);
        }
    }
    if (fast == 0.0)
        slow = fast = model.continuous() ? 1.0 : model.sampleRate;
    const double high = model.continuous() ? 10.0 * fast / (2.0 * std::numbers::pi) : 0.5 * model.sampleRate;
    const double low = std::min(0.1 * slow / (2.0 * std::numbers::pi), 0.1 * high);
    FrequencyData data;
    data.inputs = model.inputs();
    data.outputs = model.outputs();
    for (int k = 0; k < std::max(lines, 2); ++k)
        data.frequency.push_back(low * std::pow(high / low, static_cast<double>(k) / (std::max(lines, 2) - 1)));
    const Resolvent resolvent(model);
    data.value.resize(static_cast<Index>(data.frequency.size()), data.inputs * data.outputs);
    for (Index k = 0; k < data.lines(); ++k)
        data.value.row(
            k) = resolvent
                     .response(evaluationPoint(data.frequency[static_cast<std::size_t>(k)], model.sampleRate, alpha))
                     .reshaped()
                     .transpose();
    return data;
}

double relativeErrorDb(const Frf& measured, const Frf& model)
{
    double error = 0.0, power = 0.0;
    for (std::size_t k = 0; k < measured.value.size(); ++k) {
        error += std::norm(model.value[k] - measured.value[k]);
        power += std::norm(measured.value[k]);
    }
    return 10.0 * std::log10(error / power);
}

}  // namespace excursion
