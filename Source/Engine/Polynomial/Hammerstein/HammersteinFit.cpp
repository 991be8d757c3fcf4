// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/Hammerstein/HammersteinFit.h"

#include "Engine/Error.h"
#include "Engine/Numerics/TallQr.h"
#include "Engine/Polynomial/Hammerstein/LongHammerstein.h"
#include "Engine/Polynomial/InputOutputRecord.h"
#include "Engine/Polynomial/Powers.h"
#include "Engine/Validity.h"

#include <Eigen/Cholesky>

#include <cmath>
#include <limits>
#include <numbers>

namespace excursion {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// P = [u, u^2 .. u^N] T with unit mean square on the records.
MatrixXd orthonormalPolynomials(const std::vector<InputOutputRecord>& records, int degree)
{
    TallQr qr(degree);
    double samples = 0.0, size = 0.0;
    for (const auto& record : records)
        size = std::max(size, record.input.cwiseAbs().maxCoeff());
    if (!(size > 0.0))
        throw Error(Error::Kind::data, "The model cannot be fitted: the input is silent.");
    for (const auto& record : records) {
        MatrixXd P = powersOf(record.input.col(0) / size, 1, degree);
        qr.fold(P);
        samples += static_cast<double>(record.input.rows());
    }
    const VectorXd diagonal = qr.R().diagonal().cwiseAbs();
    if (diagonal.minCoeff() < 1e-12 * diagonal.maxCoeff())
        throw Error(Error::Kind::data, "The model cannot be fitted: the input takes too few values for degree "
                                           + std::to_string(degree) + ".");
    MatrixXd T = std::sqrt(samples) * qr.R().triangularView<Eigen::Upper>().solve(MatrixXd::Identity(degree, degree));
    for (int n = 0; n < degree; ++n)
        T.row(n) *= std::pow(size, -(n + 1));
    return T;
}

/// The normal equations of [1, P_1(u(t)) .. P_N(u(t)), P_1(u(t-1)) ..]: tap by tap, the branches of a tap together.
struct BranchEquations {
    MatrixXd gram;
    VectorXd right;
    double samples = 0.0;

    BranchEquations(Index N, Index K) : gram(MatrixXd::Zero(1 + N * K, 1 + N * K)), right(VectorXd::Zero(1 + N * K)) {}

    /// The lower triangle. @param P  of one record, from its first sample on
    void add(const MatrixXd& P, const VectorXd& y, Index skip, Index K)
    {
        const auto N = P.cols(), length = P.rows(), judged = length - skip;
        const auto at = [&](Index t) {
            return t >= 0 ? Eigen::RowVectorXd(P.row(t)) : Eigen::RowVectorXd(Eigen::RowVectorXd::Zero(N));
        };
        const auto place = [N](Index k) { return 1 + N * k; };
        samples += static_cast<double>(judged);
        gram(0, 0) += static_cast<double>(judged);
        right[0] += y.tail(judged).sum();
        for (Index k = 0; k < std::min(K, length); ++k) {
            const Index from = std::max(skip, k), rows = length - from;  // before its first sample the input is 0
            const auto late = P.middleRows(from - k, rows);
            gram.block(place(k), 0, N, 1) += late.colwise().sum().transpose();
            right.segment(place(k), N) += late.transpose() * y.tail(rows);
            // Tap k with tap 0, then along the diagonal, where sums differ by what comes in at one end and leaves at
            // the other
            MatrixXd sum = late.transpose() * P.bottomRows(rows);
            gram.block(place(k), place(0), N, N) += sum;
            for (Index j = 1; k + j < K; ++j) {
                sum += at(skip - k - j).transpose() * at(skip - j) - at(length - k - j).transpose() * at(length - j);
                gram.block(place(k + j), place(j), N, N) += sum;
            }
        }
    }
};

std::vector<double> regularizations(const HammersteinFitOptions& options, bool choose)
{
    if (options.regularization > 0.0)
        return {options.regularization};
    return choose ? std::vector {1e-10, 1e-8, 1e-6, 1e-4, 1e-2} : std::vector {1e-8};
}

std::vector<Index> lengthsUpTo(Index longest, bool choose)
{
    std::vector<Index> lengths {longest};
    for (double K = static_cast<double>(longest) / std::numbers::sqrt2; choose && K >= 4.0; K /= std::numbers::sqrt2)
        lengths.push_back(static_cast<Index>(K));
    return lengths;
}

constexpr Index mostDense = 4096;  // unknowns: their matrix of normal equations takes 134 MB

HammersteinFit fittedByIteration(double sampleRate, const std::vector<InputOutputRecord>& estimation,
                                 const std::vector<InputOutputRecord>& validation, const MatrixXd& T, Index K,
                                 const HammersteinFitOptions& options, const Progress& progress)
{
    // iterations, between looks at the validation records, looks without a better one
    constexpr int most = 400, every = 10, patience = 5;
    HammersteinFit best;
    best.regularization = options.regularization > 0.0 ? options.regularization : 1e-8;
    double least = std::numeric_limits<double>::infinity();
    int waited = 0;
    const auto modelOf = [&](const VectorXd& unknowns) {
        return ParallelHammerstein {
            sampleRate, Eigen::Map<const MatrixXd>(unknowns.data() + 1, K, T.cols()) * T.transpose(), unknowns[0]};
    };
    const LongHammerstein problem(estimation, T, K);
    auto last = problem.solve(best.regularization, most, every, [&](const VectorXd& unknowns, int k) {
        progress.at(static_cast<double>(k) / most, "iterating for the branch filters");
        if (validation.empty())
            return true;
        auto model = modelOf(unknowns);
        const double error = simulationErrorDb(model, validation);
        waited = error < least - 0.01 ? 0 : waited + 1;
        if (error < least) {
            least = error;
            best.model = std::move(model);
        }
        return waited < patience;
    });
    static_cast<SearchSummary&>(best) = last;
    if (best.model.filters.size() == 0)
        best.model = modelOf(last.unknowns);
    best.estimationDb = simulationErrorDb(best.model, estimation);
    best.validationDb = simulationErrorDb(best.model, validation);
    return best;
}

}  // namespace

bool HammersteinFitOptions::isValid(std::string* reason) const
{
    if (degree < 1 || degree > 20)
        return refuse(reason, "the degree of a parallel Hammerstein model must be 1 to 20");
    if (length < 1 || length * degree > 262144)
        return refuse(reason, "the branches need at least one tap, and at most 262144 taps together");
    if (!(regularization >= 0.0 && regularization < 1.0))
        return refuse(reason, "the regularization must be at least 0 and less than 1");
    return true;
}

HammersteinFit fitHammerstein(double sampleRate, const std::vector<InputOutputRecord>& estimation,
                              const std::vector<InputOutputRecord>& validation, const HammersteinFitOptions& options,
                              const Progress& progress)
{
    requireFitting(options, sampleRate, estimation, validation);
    const Index N = options.degree;
    Index longest = 0;
    for (const auto& record : estimation)
        longest = std::max(longest, record.input.rows());
    const Index K = std::min(options.length, longest);

    const MatrixXd T = orthonormalPolynomials(estimation, options.degree);
    if (N * K > mostDense)
        return fittedByIteration(sampleRate, estimation, validation, T, K, options, progress);
    BranchEquations equations(N, K);
    for (std::size_t r = 0; r < estimation.size(); ++r) {
        progress.at(0.3 * static_cast<double>(r) / static_cast<double>(estimation.size()),
                    "correlating powers of the input");
        const auto& record = estimation[r];
        equations.add(powersOf(record.input.col(0), 1, N) * T, record.output.col(0), record.skip, K);
    }

    HammersteinFit best;
    double least = std::numeric_limits<double>::infinity();
    const bool choose = !validation.empty();
    const auto candidates = regularizations(options, choose);
    for (std::size_t c = 0; c < candidates.size(); ++c) {
        progress.at(0.3 + 0.7 * static_cast<double>(c) / static_cast<double>(candidates.size()),
                    "solving for the branch filters");
        MatrixXd damped = equations.gram;
        damped.diagonal().tail(N * K).array() += candidates[c] * equations.samples;
        const Eigen::LLT<Eigen::Ref<MatrixXd>> factor(damped);  // in place
        if (factor.info() != Eigen::Success)
            continue;
        const auto L = damped.triangularView<Eigen::Lower>();
        const VectorXd forward = L.solve(equations.right);
        for (const Index taps : lengthsUpTo(K, choose)) {
            const Index unknowns = 1 + N * taps;
            const auto leading = damped.topLeftCorner(unknowns, unknowns).triangularView<Eigen::Lower>();
            const VectorXd solution = leading.transpose().solve(forward.head(unknowns));
            if (!solution.allFinite())
                continue;
            HammersteinFit fit;
            fit.model.sampleRate = sampleRate;
            fit.model.offset = solution[0];
            fit.model.filters = Eigen::Map<const MatrixXd>(solution.data() + 1, N, taps).transpose() * T.transpose();
            fit.regularization = candidates[c];
            fit.validationDb = simulationErrorDb(fit.model, validation);
            const double judged = choose ? fit.validationDb : 0.0;
            if (judged < least) {
                least = judged;
                best = std::move(fit);
            }
        }
    }
    if (best.model.filters.size() == 0)
        throw Error(Error::Kind::numerical,
                    "The branch filters cannot be solved for; a larger regularization or fewer taps may help.");
    best.estimationDb = simulationErrorDb(best.model, estimation);
    best.end(Termination::solvedAtOnce);
    return best;
}

}  // namespace excursion
