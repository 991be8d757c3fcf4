// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/GreyBox/CascadeRefinement.h"

#include "Engine/Error.h"
#include "Engine/Linear/RelativeDegree.h"
#include "Engine/Linear/Response.h"
#include "Engine/Numerics/RealRows.h"
#include "Engine/Numerics/Search.h"
#include "Engine/Numerics/TallQr.h"

#include <complex>

namespace excursion {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

/// [basis, 1] of a half at all lines, and its response.
struct Half {
    Half(const PartialFractionFit& fit, const VectorXcd& lambda) : columns(lambda.size(), fit.sections.order() + 1)
    {
        columns << partialFractions(fit.sections, lambda), VectorXcd::Ones(lambda.size());
        VectorXd coefficients(columns.cols());
        coefficients << fit.C.row(0).transpose(), fit.D;
        response = columns * coefficients;
    }

    /// By the factors, coefficients moving along as the relative degree asks, then by the permitted coefficients.
    MatrixXcd slopes(const PartialFractionFit& fit, const VectorXcd& lambda) const
    {
        const auto n = fit.sections.order();
        const VectorXd c = fit.C.row(0).transpose();
        const MatrixXd permitted = permittedCoefficients(fit.sections);
        MatrixXcd result(lambda.size(), n + permitted.cols());
        result << partialFractionSlopes(fit.sections, lambda, columns.leftCols(n), c)
                      + columns * coefficientSlopes(fit.sections, c),
            columns * permitted;
        return result;
    }

    MatrixXcd columns;
    VectorXcd response;
};

/// A half after a step of its factors and permitted coefficients.
PartialFractionFit moved(PartialFractionFit fit, const VectorXd& step)
{
    const auto n = fit.sections.order();
    const MatrixXd permitted = permittedCoefficients(fit.sections);
    VectorXd coefficients(n + 1);
    coefficients << fit.C.row(0).transpose(), fit.D;
    coefficients += coefficientSlopes(fit.sections, fit.C.row(0).transpose()) * step.head(n)
                    + permitted * step.tail(permitted.cols());
    fit.sections.factors += step.head(n);
    const MatrixXd next = permittedCoefficients(fit.sections);  // along a curve, of which the slope is a tangent
    coefficients = (next * (next.transpose() * coefficients)).eval();
    fit.C.row(0) = coefficients.head(n).transpose();
    fit.D[0] = coefficients[n];
    return fit;
}

/// Numbers that a step has for a half; one whose displacement has to fall fast enough has fewer than it has values.
Index freedomOf(const PartialFractionFit& fit) { return 2 * fit.sections.order() + 1 - fit.sections.relativeDegree; }

/// The error as a function of [factors, C, D] of the first half, then of the second.
class Cascade final : public SearchProblem {
public:
    Cascade(const PartialFractionFit& first, const PartialFractionFit& second, const FrequencyData& between,
            const FrequencyData& after)
        : first_(first),
          second_(second),
          between_(between),
          after_(after),
          lambda_(evaluationPoints(between.frequency, 0.0)),
          square_(lambda_.cwiseAbs2().cast<std::complex<double>>() * -1.0),
          ofBetween_(between.deviation.col(0).cwiseInverse()),
          ofAfter_(after.deviation.col(0).cwiseInverse())
    {
    }

    static VectorXd valuesOf(const PartialFractionFit& one, const PartialFractionFit& other)
    {
        VectorXd values(2 * (one.sections.order() + other.sections.order()) + 2);
        values << one.sections.factors, one.C.row(0).transpose(), one.D, other.sections.factors,
            other.C.row(0).transpose(), other.D;
        return values;
    }

    PartialFractionFit first(const VectorXd& values) const
    {
        return half(first_, values.head(2 * first_.sections.order() + 1));
    }
    PartialFractionFit second(const VectorXd& values) const
    {
        return half(second_, values.tail(2 * second_.sections.order() + 1));
    }

    double cost(const VectorXd& values) override
    {
        const auto one = first(values), other = second(values);
        return isStable(one.sections) && isStable(other.sections) ? chiSquared(one, other) : ranAway;
    }

    MatrixXd factor(const VectorXd& values) override
    {
        auto rows = system(first(values), second(values));
        TallQr qr(rows.cols());
        qr.fold(rows);
        return qr.R();
    }

    VectorXd moved(const VectorXd& values, const VectorXd& step) override
    {
        const auto one = first(values), other = second(values);
        return valuesOf(excursion::moved(one, step.head(freedomOf(one))),
                        excursion::moved(other, step.tail(freedomOf(other))));
    }

private:
    static PartialFractionFit half(PartialFractionFit fit, const VectorXd& values)
    {
        const auto n = fit.sections.order();
        fit.sections.factors = values.head(n);
        fit.C.row(0) = values.segment(n, n).transpose();
        fit.D[0] = values[2 * n];
        return fit;
    }

    double chiSquared(const PartialFractionFit& first, const PartialFractionFit& second) const
    {
        const VectorXcd M = Half(first, lambda_).response,
                        P = square_.cwiseProduct(M).cwiseProduct(Half(second, lambda_).response);
        return (M - between_.value.col(0)).cwiseProduct(ofBetween_).squaredNorm()
               + (P - after_.value.col(0)).cwiseProduct(ofAfter_).squaredNorm();
    }

    /// [J, what is left], 4 K rows.
    MatrixXd system(const PartialFractionFit& first, const PartialFractionFit& second) const
    {
        const Half M(first, lambda_), K(second, lambda_);
        const MatrixXcd ofFirst = M.slopes(first, lambda_), ofSecond = K.slopes(second, lambda_);
        const VectorXcd throughSecond = square_.cwiseProduct(K.response),
                        throughFirst = square_.cwiseProduct(M.response);
        const Index lines = lambda_.size(), a = ofFirst.cols(), b = ofSecond.cols();
        MatrixXd top = MatrixXd::Zero(2 * lines, a + b + 1), bottom(2 * lines, a + b + 1);
        placeRealRows(top, 0, ofFirst, ofBetween_);
        placeRealRows(top, a + b, between_.value.col(0) - M.response, ofBetween_);
        placeRealRows(bottom, 0, throughSecond.asDiagonal() * ofFirst, ofAfter_);
        placeRealRows(bottom, a, throughFirst.asDiagonal() * ofSecond, ofAfter_);
        placeRealRows(bottom, a + b, after_.value.col(0) - throughFirst.cwiseProduct(K.response), ofAfter_);
        MatrixXd rows(4 * lines, a + b + 1);
        rows << top, bottom;
        return rows;
    }

    const PartialFractionFit &first_, &second_;  // of which factors, C and D are not used
    const FrequencyData &between_, &after_;
    VectorXcd lambda_, square_;
    VectorXd ofBetween_, ofAfter_;
};

void requireCascade(const PartialFractionFit& first, const PartialFractionFit& second, const FrequencyData& between,
                    const FrequencyData& after, const PoleRefinementOptions& options)
{
    std::string reason;
    if (!options.isValid(&reason) || !between.isValid(&reason) || !after.isValid(&reason))
        throw Error(Error::Kind::usage, "The cascade cannot be refined: " + reason + ".");
    if (between.value.cols() != 1 || after.value.cols() != 1 || between.frequency != after.frequency
        || between.deviation.size() == 0 || after.deviation.size() == 0)
        throw Error(Error::Kind::usage,
                    "The cascade cannot be refined: it takes two responses at the same frequencies, with deviations.");
    for (const auto* fit : {&first, &second})
        if (fit->C.rows() != 1 || fit->sections.sampleRate != 0.0 || fit->sections.alpha != 1.0
            || !isStable(fit->sections))
            throw Error(
                Error::Kind::usage,
                "The cascade cannot be refined: its models are not stable ones of continuous time with one output.");
    if (first.sections.relativeDegree < 2)
        throw Error(Error::Kind::usage,
                    "The cascade cannot be refined: the relative degree of its first model is below 2.");
}

}  // namespace

CascadeRefinement refineCascade(const PartialFractionFit& first, const PartialFractionFit& second,
                                const FrequencyData& between, const FrequencyData& after,
                                const PoleRefinementOptions& options)
{
    requireCascade(first, second, between, after, options);
    Cascade cascade(first, second, between, after);
    auto searching = searchFor(options);
    searching.roundingCost = 0.0;  // this cost is not a relative one
    const auto found = search(cascade, Cascade::valuesOf(first, second), searching);
    CascadeRefinement result;
    static_cast<SearchSummary&>(result) = found;
    result.first = cascade.first(found.values);
    result.second = cascade.second(found.values);
    return result;
}

}  // namespace excursion
