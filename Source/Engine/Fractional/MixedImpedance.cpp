// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Fractional/MixedImpedance.h"

#include "Engine/Error.h"
#include "Engine/Signal/Level.h"
#include "Engine/Validity.h"

#include <Eigen/LU>
#include <Eigen/QR>
#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace excursion {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using std::numbers::pi;

constexpr int P = MixedImpedance::parameters;
constexpr int alphaIndex = 2;
using Parameters = Eigen::Matrix<double, P, 1>;

MixedImpedance modelOf(const double* logarithms)
{
    const auto v = [&](int k) { return std::exp(logarithms[k]); };
    return {v(0), v(1), v(2), v(3), v(4), v(5)};
}

/// Z and its derivatives by the logarithms of the parameters.
Complex slopesAt(const MixedImpedance& z, double frequency, std::array<Complex, P>& slope)
{
    const Complex s(0.0, 2.0 * pi * frequency);
    const double w0 = 2.0 * pi * z.resonance;
    const Complex power = z.semiInductance * std::pow(s, z.alpha), q = s * s + (w0 / z.quality) * s + w0 * w0,
                  motional = z.motional * s / q;
    slope = {z.resistance,
             power,
             z.alpha * power * std::log(s),
             motional,
             -motional / q * (w0 / z.quality * s + 2.0 * w0 * w0),
             motional / q * (w0 / z.quality) * s};
    return z.resistance + power + motional;
}

/// sqrt(2) e/sigma, real and imaginary part: unit variance each.
class Residual final : public ceres::CostFunction {
public:
    Residual(const FrequencyData& data, const Eigen::VectorXd& weights, bool freeAlpha)
        : data_(data), weights_(weights), freeAlpha_(freeAlpha)
    {
        set_num_residuals(2 * static_cast<int>(data.lines()));
        mutable_parameter_block_sizes()->push_back(P);
    }

    bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override
    {
        const auto model = modelOf(parameters[0]);
        std::array<Complex, P> slope;
        for (Index k = 0; k < data_.lines(); ++k) {
            const Complex e = weights_[k]
                              * (slopesAt(model, data_.frequency[static_cast<std::size_t>(k)], slope)
                                 - data_.value(k, 0));
            residuals[2 * k] = e.real();
            residuals[2 * k + 1] = e.imag();
            if (!std::isfinite(e.real()) || !std::isfinite(e.imag()))
                return false;
            if (!jacobians || !jacobians[0])
                continue;
            for (int j = 0; j < P; ++j) {
                const bool fixed = j == alphaIndex && !freeAlpha_;
                jacobians[0][2 * k * P + j] = fixed ? 0.0 : weights_[k] * slope[static_cast<std::size_t>(j)].real();
                jacobians[0][(2 * k + 1) * P + j] = fixed ? 0.0
                                                          : weights_[k] * slope[static_cast<std::size_t>(j)].imag();
            }
        }
        return true;
    }

private:
    const FrequencyData& data_;
    const Eigen::VectorXd& weights_;
    bool freeAlpha_;
};

/// The best of a grid, with R, L and K by least squares; those with a negative one are no driver.
MixedImpedance startFor(const FrequencyData& data, const Eigen::VectorXd& weights, std::optional<double> alpha)
{
    const auto K = data.lines();
    const double low = data.frequency.front(), high = data.frequency.back();
    Eigen::MatrixXd rows(2 * K, 4);  // R, L s^alpha, resonance, measured
    const auto place = [&](Index column, auto value) {
        for (Index k = 0; k < K; ++k) {
            const Complex z = weights[k] * value(k);
            rows(2 * k, column) = z.real();
            rows(2 * k + 1, column) = z.imag();
        }
    };
    const auto s = [&](Index k) { return Complex(0.0, 2.0 * pi * data.frequency[static_cast<std::size_t>(k)]); };
    place(0, [](Index) { return Complex(1.0); });
    place(3, [&](Index k) { return data.value(k, 0); });
    std::vector<double> alphas {0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0};
    if (alpha)
        alphas = {*alpha};
    MixedImpedance best;
    double least = std::numeric_limits<double>::infinity();
    for (const double a : alphas) {
        place(1, [&](Index k) { return std::pow(s(k), a); });
        for (int f = 0; f < 60; ++f)
            for (const double quality : {0.7, 1.5, 3.0, 6.0, 12.0}) {
                const double f0 = low * std::pow(high / low, f / 59.0), w0 = 2.0 * pi * f0;
                place(2, [&](Index k) { return s(k) / (s(k) * s(k) + (w0 / quality) * s(k) + w0 * w0); });
                // Columns of unit length: they differ by many powers of ten.
                const Eigen::Vector4d length = rows.colwise().norm();
                const Eigen::Matrix4d normal = length.cwiseInverse().asDiagonal() * (rows.transpose() * rows)
                                               * length.cwiseInverse().asDiagonal();
                const Eigen::Vector3d x = normal.topLeftCorner<3, 3>().ldlt().solve(normal.col(3).head<3>());
                const double left = 1.0 - x.dot(normal.col(3).head<3>());
                if (x.allFinite() && x.minCoeff() > 0.0 && left < least) {
                    least = left;
                    const Eigen::Vector3d c = x.cwiseQuotient(length.head<3>()) * length[3];
                    best = {c[0], c[1], a, c[2], f0, quality};
                }
            }
    }
    if (!std::isfinite(least))
        throw Error(Error::Kind::numerical, "No impedance R + L s^alpha with a resonance resembles the response; R, L "
                                            "and the resonance must be positive.");
    return best;
}

}  // namespace

Complex MixedImpedance::at(double frequency) const
{
    const Complex s(0.0, 2.0 * pi * frequency);
    const double w0 = 2.0 * pi * resonance;
    return resistance + semiInductance * std::pow(s, alpha) + motional * s / (s * s + (w0 / quality) * s + w0 * w0);
}

bool MixedImpedanceOptions::isValid(std::string* reason) const
{
    const bool valid = (!alpha || (*alpha > 0.0 && *alpha < 2.0)) && maximumIterations >= 1;
    return valid || refuse(reason, "alpha must lie between 0 and 2, and at least one iteration is needed");
}

MixedImpedanceFit fitMixedImpedance(const FrequencyData& data, const MixedImpedanceOptions& options)
{
    std::string reason;
    if (!options.isValid(&reason))
        throw Error(Error::Kind::usage, "The impedance cannot be fitted: " + reason + ".");
    if (!data.isValid(&reason))
        throw Error(Error::Kind::data, "The impedance cannot be fitted: " + reason + ".");
    if (data.value.cols() != 1 || data.lines() < P || !(data.frequency.front() > 0.0))
        throw Error(Error::Kind::data, "An impedance is fitted to one response on at least 6 lines above 0 Hz.");
    const bool known = data.deviation.size() != 0;
    const Eigen::VectorXd weights = std::sqrt(2.0)
                                    * (known ? Eigen::VectorXd(data.deviation.col(0).cwiseInverse())
                                             : Eigen::VectorXd(weightsOf(data).col(0)));
    const auto start = startFor(data, weights, options.alpha);
    Parameters x;
    for (int k = 0; k < P; ++k)
        x[k] = std::log(start.values()[static_cast<std::size_t>(k)]);

    const Residual residual(data, weights, !options.alpha);
    ceres::Problem::Options owning;
    owning.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    ceres::Problem problem(owning);
    problem.AddResidualBlock(const_cast<Residual*>(&residual), nullptr, x.data());
    ceres::Solver::Options solving;
    solving.linear_solver_type = ceres::DENSE_QR;
    solving.max_num_iterations = options.maximumIterations;
    solving.function_tolerance = 1e-14;
    solving.parameter_tolerance = 1e-12;
    solving.gradient_tolerance = 1e-30;
    solving.logging_type = ceres::SILENT;
    solving.num_threads = 1;
    ceres::Solver::Summary summary;
    ceres::Solve(solving, &problem, &summary);

    MixedImpedanceFit fit;
    fit.model = modelOf(x.data());
    if (options.alpha)
        fit.model.alpha = *options.alpha;
    fit.converged = summary.termination_type == ceres::CONVERGENCE;
    fit.reason = fit.converged                                       ? "the error no longer falls"
                 : summary.termination_type == ceres::NO_CONVERGENCE ? "the largest number of iterations was reached"
                                                                     : "the search broke down";

    Eigen::Matrix<double, Eigen::Dynamic, P, Eigen::RowMajor> J(2 * data.lines(), P);
    Eigen::VectorXd r(2 * data.lines());
    const double* at[] = {x.data()};
    double* jacobians[] = {J.data()};
    residual.Evaluate(at, r.data(), jacobians);
    const int free = options.alpha ? P - 1 : P;
    const double freedom = std::max(1.0, static_cast<double>(2 * data.lines() - free));
    const double spread = known ? std::max(1.0, r.squaredNorm() / freedom) : r.squaredNorm() / freedom;
    Eigen::MatrixXd columns = J;
    if (options.alpha) {
        columns.middleCols(alphaIndex, P - 1 - alphaIndex) = J.rightCols(P - 1 - alphaIndex);
        columns.conservativeResize(Eigen::NoChange, P - 1);
    }
    const Eigen::MatrixXd R =
        Eigen::HouseholderQR<Eigen::MatrixXd>(columns).matrixQR().topRows(free).triangularView<Eigen::Upper>();
    const Eigen::MatrixXd inverse = R.triangularView<Eigen::Upper>().solve(Eigen::MatrixXd::Identity(free, free));
    std::array<double, P> error {};
    for (int k = 0, column = 0; k < P; ++k)
        if (!(options.alpha && k == alphaIndex)) {
            const auto j = static_cast<std::size_t>(k);
            // of the logarithm, to the parameter's own unit
            error[j] = std::sqrt(spread) * inverse.row(column++).norm() * fit.model.values()[j];
        }
    fit.deviation = {error[0], error[1], error[2], error[3], error[4], error[5]};
    double left = 0.0;
    for (Index k = 0; k < data.lines(); ++k)
        left += std::norm(fit.model.at(data.frequency[static_cast<std::size_t>(k)]) - data.value(k, 0));
    fit.errorDb = decibelsOf(left / data.value.squaredNorm());
    fit.likelihood = known ? 0.5 * r.squaredNorm() : std::numeric_limits<double>::quiet_NaN();
    return fit;
}

}  // namespace excursion
