// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/GreyBox/MixedImpedance.h"

#include "Engine/Error.h"
#include "Engine/Numerics/Search.h"
#include "Engine/Numerics/TallQr.h"
#include "Engine/Signal/Level.h"
#include "Engine/Validity.h"

#include <Eigen/Cholesky>

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
constexpr std::size_t alphaIndex = 2;

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

/// The error sqrt(2) (measured - Z)/sigma, real and imaginary part, of unit variance each, as a function of the
/// logarithms of the parameters that are free.
class ImpedanceError final : public SearchProblem {
public:
    ImpedanceError(const FrequencyData& data, const Eigen::VectorXd& weights, std::optional<double> alpha)
        : data_(data),
          weights_(weights),
          alpha_(alpha),
          power_(data.value.col(0).cwiseAbs().cwiseProduct(weights).squaredNorm())
    {
    }

    Index free() const { return alpha_ ? P - 1 : P; }

    Eigen::VectorXd valuesOf(const MixedImpedance& model) const
    {
        Eigen::VectorXd values(free());
        for (Index k = 0; k < free(); ++k)
            values[k] = std::log(model.values()[place(k)]);
        return values;
    }

    MixedImpedance modelAt(const Eigen::VectorXd& values) const
    {
        std::array<double, P> v {};
        v[alphaIndex] = alpha_.value_or(0.0);
        for (Index k = 0; k < free(); ++k)
            v[place(k)] = std::exp(values[k]);
        return {v[0], v[1], v[2], v[3], v[4], v[5]};
    }

    /// Relative to what is to be explained.
    double cost(const Eigen::VectorXd& values) override { return rowsAt(values).rightCols(1).squaredNorm() / power_; }

    Eigen::MatrixXd factor(const Eigen::VectorXd& values) override
    {
        auto rows = rowsAt(values);
        TallQr qr(rows.cols());
        qr.fold(rows);
        return qr.R();
    }

    std::size_t place(Index k) const  ///< of the k-th free parameter among all
    {
        return static_cast<std::size_t>(alpha_ && k >= static_cast<Index>(alphaIndex) ? k + 1 : k);
    }

private:
    /// [J, error]
    Eigen::MatrixXd rowsAt(const Eigen::VectorXd& values) const
    {
        const auto model = modelAt(values);
        const auto K = data_.lines();
        Eigen::MatrixXd rows(2 * K, free() + 1);
        std::array<Complex, P> slope;
        for (Index k = 0; k < K; ++k) {
            const Complex e = weights_[k]
                              * (data_.value(k, 0)
                                 - slopesAt(model, data_.frequency[static_cast<std::size_t>(k)], slope));
            for (Index j = 0; j < free(); ++j) {
                rows(2 * k, j) = weights_[k] * slope[place(j)].real();
                rows(2 * k + 1, j) = weights_[k] * slope[place(j)].imag();
            }
            rows(2 * k, free()) = e.real();
            rows(2 * k + 1, free()) = e.imag();
        }
        return rows;
    }

    const FrequencyData& data_;
    const Eigen::VectorXd& weights_;
    std::optional<double> alpha_;
    double power_;
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
    requireFitting(options, data, "The impedance cannot be fitted");
    if (data.value.cols() != 1 || data.lines() < P || !(data.frequency.front() > 0.0))
        throw Error(Error::Kind::data, "An impedance is fitted to one response on at least 6 lines above 0 Hz.");
    const bool known = data.deviation.size() != 0;
    const Eigen::VectorXd weights = std::sqrt(2.0)
                                    * (known ? Eigen::VectorXd(data.deviation.col(0).cwiseInverse())
                                             : Eigen::VectorXd(weightsOf(data).col(0)));
    const auto start = startFor(data, weights, options.alpha);
    ImpedanceError error(data, weights, options.alpha);
    SearchOptions searching;
    searching.maximumIterations = options.maximumIterations;
    searching.costTolerance = 1e-14;
    const auto found = search(error, error.valuesOf(start), searching);

    MixedImpedanceFit fit;
    static_cast<SearchSummary&>(fit) = found;
    fit.model = error.modelAt(found.values);
    const auto free = error.free();
    const Eigen::MatrixXd R = error.factor(found.values);
    const double squares = R.col(free).squaredNorm(),
                 freedom = std::max(1.0, static_cast<double>(2 * data.lines() - free));
    const double spread = known ? std::max(1.0, squares / freedom) : squares / freedom;
    const Eigen::MatrixXd inverse =
        R.topLeftCorner(free, free).triangularView<Eigen::Upper>().solve(Eigen::MatrixXd::Identity(free, free));
    std::array<double, P> standardError {};
    for (Index k = 0; k < free; ++k)  // of the logarithm, to the parameter's own unit
        standardError[error.place(k)] = std::sqrt(spread) * inverse.row(k).norm() * fit.model.values()[error.place(k)];
    const auto& e = standardError;
    fit.standardErrors = {e[0], e[1], e[2], e[3], e[4], e[5]};
    double left = 0.0;
    for (Index k = 0; k < data.lines(); ++k)
        left += std::norm(fit.model.at(data.frequency[static_cast<std::size_t>(k)]) - data.value(k, 0));
    fit.errorDb = decibelsOf(left / data.value.squaredNorm());
    fit.chiSquared = known ? 0.5 * squares : std::numeric_limits<double>::quiet_NaN();
    return fit;
}

}  // namespace excursion
