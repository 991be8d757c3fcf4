// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/Pnlss/TangentTest.h"

#include "Engine/Numerics/TallQr.h"
#include "Engine/Polynomial/Monomials.h"
#include "Engine/Polynomial/Pnlss/Recursion.h"
#include "Engine/Polynomial/Autoregression.h"

#include <algorithm>
#include <random>

namespace excursion {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index mostColumns = 320, colourOrder = 30, draws = 4;
constexpr int furtherDegrees = 2;

/// The model with every monomial up to a degree and a constant, all free; what it has not is zero.
Pnlss widened(const Pnlss& model, int degree)
{
    auto wide = withTerms(model.linear, degree, TermMask::full, true);
    for (Index own = 0; own < model.terms(); ++own)
        for (Index k = 0; k < wide.terms(); ++k)
            if (wide.exponents.row(k) == model.exponents.row(own)) {
                wide.E.col(k) = model.E.col(own);
                wide.F.col(k) = model.F.col(own);
            }
    return wide;
}

/// How far monomials may go; empty where those of the model's own degree are too many already.
std::optional<int> degreeFor(const Pnlss& model, Index room)
{
    const auto variables = static_cast<int>(model.linear.order() + model.linear.inputs());
    const auto rows = model.linear.order() + model.linear.outputs();
    const int own = model.terms() > 0 ? std::max(2, model.exponents.rowwise().sum().maxCoeff()) : 2;
    for (int degree = own + furtherDegrees; degree >= own; --degree)
        if ((monomials(variables, 1, degree).rows() + 1) * rows <= room)
            return degree;
    return std::nullopt;
}

/// e, then signals of its colour.
MatrixXd withDraws(const VectorXd& e, std::mt19937_64& random)
{
    MatrixXd result(e.size(), 1 + draws);
    result.col(0) = e;
    const auto a = autoregression(e, std::min(colourOrder, e.size() / 8));
    for (auto column : result.rightCols(draws).colwise()) {
        VectorXd sign(e.size());
        for (auto& value : sign)
            value = (random() & 1) != 0 ? 1.0 : -1.0;
        column = colouredBy(a, sign);
    }
    return result;
}

}  // namespace

std::optional<OffTangent> offTangent(const Pnlss& model, const std::vector<InputOutputRecord>& records,
                                     const std::vector<VectorXd>& initial)
{
    const auto n = model.linear.order(), first = n * static_cast<Index>(records.size());
    Index samples = 0;
    for (const auto& record : records)
        samples += (record.output.rows() - record.skip) * record.output.cols();
    const auto degree = degreeFor(model, std::min(mostColumns, samples / 8) - first);
    if (!degree)
        return std::nullopt;
    const auto wide = widened(model, *degree);
    const Recursion recursion(wide, true);
    const auto own = recursion.parameters(), P = own + first;
    std::mt19937_64 random(1);
    TallQr qr(P + 1 + draws);
    MatrixXd states, output;
    for (std::size_t k = 0; k < records.size(); ++k) {
        const auto& record = records[k];
        const VectorXd begin = k < initial.size() ? initial[k] : VectorXd::Zero(n);
        if (!recursion.run(wide, record.input, begin, 1e100, states, output))
            return std::nullopt;
        const MatrixXd error = judgedError(record, output);
        if (!error.allFinite())
            return std::nullopt;
        std::vector<MatrixXd> targets;
        for (const auto column : error.colwise())
            targets.push_back(withDraws(column, random));
        recursion.differentiate(wide, record.input, states, [&](Index from, std::vector<MatrixXd>& derivatives) {
            for (std::size_t o = 0; o < derivatives.size(); ++o) {
                const auto T = derivatives[o].rows(), skipped = std::clamp<Index>(record.skip - from, 0, T);
                MatrixXd rows = MatrixXd::Zero(T - skipped, P + 1 + draws);
                rows.leftCols(own) = derivatives[o].bottomRows(T - skipped).leftCols(own);
                rows.middleCols(own + n * static_cast<Index>(k),
                                n) = derivatives[o].bottomRows(T - skipped).rightCols(n);
                rows.rightCols(1 + draws) = targets[o].middleRows(from + skipped - record.skip, T - skipped);
                if (rows.rows() > 0)
                    qr.fold(rows);
            }
        });
    }
    const auto R = qr.R();
    if (!R.allFinite())
        return std::nullopt;
    const auto drawn = R.rightCols(draws);
    OffTangent off;
    off.power = R(P, P) * R(P, P);
    off.white = 1.0 - static_cast<double>(P) / static_cast<double>(samples);
    off.alike = std::min(off.white, drawn.bottomRows(1 + draws).squaredNorm() / drawn.squaredNorm());
    return off;
}

}  // namespace excursion
