// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/Pnlss/ResidualTest.h"

#include "Engine/Numerics/TallQr.h"
#include "Engine/Polynomial/Monomials.h"
#include "Engine/Polynomial/Pnlss/Recursion.h"
#include "Engine/Polynomial/Pnlss/TangentTest.h"
#include "Engine/Polynomial/Autoregression.h"
#include "Engine/Signal/Level.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index residualLags = 3, longestFilter = 30, mostRegressors = 120;

/// The highest degree of which all monomials fit into what the record carries.
int degreeFor(Index variables, Index room)
{
    int degree = 0;
    while (degree < 3 && monomials(static_cast<int>(variables), 1, degree + 1).rows() * residualLags <= room)
        ++degree;
    return degree;
}

/// Monomials of states and inputs at each sample, each variable over its rms.
MatrixXd monomialColumns(const MatrixXd& states, const MatrixXd& input, int degree)
{
    const auto N = input.rows(), n = states.rows(), m = input.cols();
    MatrixXd z(N, n + m);
    z << states.leftCols(N).transpose(), input;
    const auto exponents = monomials(static_cast<int>(n + m), 1, degree);
    for (auto column : z.colwise())
        column /= std::max(column.norm() / std::sqrt(static_cast<double>(N)), 1e-300);
    MatrixXd result = MatrixXd::Ones(N, exponents.rows());
    for (Index k = 0; k < exponents.rows(); ++k)
        for (Index v = 0; v < n + m; ++v)
            for (int power = exponents(k, v); power > 0; --power)
                result.col(k).array() *= z.col(v).array();
    return result;
}

/// Columns of x delayed by first .. last samples, from sample `from` on.
MatrixXd delayed(const MatrixXd& x, Index first, Index last, Index from)
{
    const auto rows = x.rows() - from;
    MatrixXd result(rows, x.cols() * (last - first + 1));
    for (Index lag = first; lag <= last; ++lag)
        result.middleCols((lag - first) * x.cols(), x.cols()) = x.middleRows(from - lag, rows);
    return result;
}

/// Power of a sample that no combination of the regressors tells, without what chance tells.
double leftOver(const MatrixXd& regressors, const VectorXd& target)
{
    const auto P = regressors.cols();
    TallQr qr(P + 1);
    MatrixXd rows(target.size(), P + 1);
    rows << regressors, target;
    qr.fold(rows);
    return qr.R()(P, P) * qr.R()(P, P) / static_cast<double>(target.size() - P);
}

/// The part of the innovations of e, which are what its own past does not tell, that also the past of output and input
/// does not tell: no more than that is noise.
double innovationShare(const VectorXd& e, const MatrixXd& output, const MatrixXd& input)
{
    const auto N = e.size(), p = output.cols(), m = input.cols();
    const Index longest = 2 * residualLags + 4;
    const double alone = leftOver(delayed(e, 1, longest, longest), e.tail(N - longest));
    MatrixXd lately(N - longest, residualLags * (p + m) + m);
    lately << delayed(output, 1, residualLags, longest), delayed(input, 0, residualLags, longest);
    const int degree = degreeFor(lately.cols(), std::min(2 * mostRegressors, N / 8) * residualLags);
    const auto bent = monomialColumns(lately.transpose(), MatrixXd(lately.rows(), 0), std::max(degree, 1));
    MatrixXd all(lately.rows(), bent.cols() + (longest - residualLags) * (p + m));
    all << bent, delayed(output, residualLags + 1, longest, longest),
        delayed(input, residualLags + 1, longest, longest);
    // What is left of the output before is no more than what is left of e, if that is noise.
    MatrixXd known(lately.rows(), all.cols() + longest);
    known << all, delayed(e, 1, longest, longest);
    const double told = leftOver(known, e.tail(N - longest));
    return alone > 0.0 ? std::min(1.0, told / alone) : 1.0;
}

/// Of one output's residual, the power that is left untold.
std::optional<double> untold(const VectorXd& e, const MatrixXd& states, const MatrixXd& input, const VectorXd& output)
{
    const auto N = e.size(), first = input.rows() - N;
    const int degree = degreeFor(states.rows() + input.cols(), std::min(mostRegressors, N / 8));
    if (degree == 0 || N < 8 * longestFilter)
        return std::nullopt;
    const double power = e.squaredNorm(), share = innovationShare(e, output.tail(N), input.bottomRows(N));
    const VectorXd a = autoregression(e, longestFilter);
    const VectorXd white = whitenedBy(a, e);
    const auto now = monomialColumns(states, input, degree);
    const Index K = now.cols(), P = K * residualLags;
    MatrixXd M = MatrixXd::Zero(N, P);
    for (Index lag = 0; lag < residualLags; ++lag) {
        const Index delay = std::max<Index>(0, lag - first);  // no samples are known before the record
        M.block(delay, lag * K, N - delay, K) = now.middleRows(first + delay - lag, N - delay);
    }
    const VectorXd scale = M.colwise().norm().transpose().cwiseMax(1e-300).cwiseInverse();
    M = (M * scale.asDiagonal()).eval();
    MatrixXd gram = MatrixXd::Zero(P, P);
    gram.selfadjointView<Eigen::Lower>().rankUpdate(M.transpose());
    gram.diagonal().array() += 1e-11;
    const VectorXd rest = white - M * gram.selfadjointView<Eigen::Lower>().ldlt().solve(M.transpose() * white);
    const double untold = colouredBy(a, rest).squaredNorm() * static_cast<double>(N) / static_cast<double>(N - P);
    return std::min({power, untold, share * power});
}

/// Power of the output of a judged sample, dB.
double sampleDb(const std::vector<InputOutputRecord>& records)
{
    double samples = 0.0;
    for (const auto& record : records)
        samples += static_cast<double>((record.output.rows() - record.skip) * record.output.cols());
    return decibelsOf(judgedPower(records) / samples);
}

}  // namespace

std::optional<bool> UntoldNoise::reachedBy(double errorDb) const
{
    if (errorDb <= leastDb + atUntoldDb)
        return true;
    return errorDb <= db + atUntoldDb ? std::optional<bool>() : false;
}

double heldOutDb(double estimationDb, const std::vector<InputOutputRecord>& estimation, double validationDb,
                 const std::vector<InputOutputRecord>& validation)
{
    return validationDb + sampleDb(validation) - estimationDb - sampleDb(estimation);
}

bool isHeld(double estimationDb, const std::vector<InputOutputRecord>& estimation, double validationDb,
            const std::vector<InputOutputRecord>& validation)
{
    return validationDb <= exactDb || heldOutDb(estimationDb, estimation, validationDb, validation) <= heldOutMostDb;
}

std::optional<UntoldNoise> untoldNoise(const Pnlss& model, const std::vector<InputOutputRecord>& records,
                                       const std::vector<VectorXd>& initial)
{
    const Recursion recursion(model, false);
    double sum = 0.0;
    MatrixXd states, output;
    for (std::size_t k = 0; k < records.size(); ++k) {
        const auto& record = records[k];
        const VectorXd begin = k < initial.size() ? initial[k] : VectorXd::Zero(model.linear.order());
        if (!recursion.run(model, record.input, begin, 1e100, states, output))
            return std::nullopt;
        const MatrixXd error = judgedError(record, output);
        if (!error.allFinite())
            return std::nullopt;
        for (Eigen::Index o = 0; o < error.cols(); ++o) {
            const auto power = untold(error.col(o), states, record.input, record.output.col(o));
            if (!power)
                return std::nullopt;
            sum += *power;
        }
    }
    double least = sum;
    if (const auto off = offTangent(model, records, initial)) {
        sum = std::min(sum, off->power / off->alike);
        least = std::min(least, off->power / off->white);
    }
    const double power = judgedPower(records);
    return UntoldNoise {decibelsOf(sum / power), decibelsOf(least / power)};
}

}  // namespace excursion
