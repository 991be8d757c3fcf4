// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/Block/BlockError.h"

#include "Engine/Linear/Simulation.h"
#include "Engine/Numerics/TallQr.h"
#include "Engine/Polynomial/Powers.h"

#include <cmath>
#include <limits>

namespace excursion {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

Pnlss withoutTerms(const StateSpace& linear) { return withTerms(linear, Exponents(0, linear.order() + 1)); }

}  // namespace

MatrixXd filtered(const StateSpace& G, const MatrixXd& columns)
{
    MatrixXd result(columns.rows(), columns.cols());
    for (Index c = 0; c < columns.cols(); ++c)
        result.col(c) = simulate(G, MatrixXd(columns.col(c)));
    return result;
}

BlockError::BlockError(const BlockModel& structure, const std::vector<InputOutputRecord>& records)
    : structure_(structure),
      recursion_(withoutTerms(structure.linear), true),
      records_(records),
      power_(judgedPower(records))
{
}

VectorXd BlockError::valuesOf(const BlockModel& model) const
{
    const VectorXd ofG = recursion_.valuesOf(withoutTerms(model.linear));
    VectorXd values(ofG.size() + model.hammerstein.size() + model.wiener.size() + model.feedback.size() + 1);
    values << ofG, model.hammerstein, model.wiener, model.feedback, model.offset;
    return values;
}

BlockModel BlockError::modelAt(const VectorXd& values) const
{
    auto linear = withoutTerms(structure_.linear);
    auto model = structure_;
    Index at = recursion_.parameters();
    recursion_.setValues(linear, values.head(at));
    model.linear = linear.linear;
    for (const auto branch : blockBranches()) {
        VectorXd& c = model.of(branch);
        c = values.segment(at, c.size()).eval();
        at += c.size();
    }
    model.offset = values[at];
    return model;
}

double BlockError::cost(const VectorXd& values)
{
    const auto model = modelAt(values);
    if (!isStable(model.linear))
        return ranAway;
    double sum = 0.0;
    for (const auto& record : records_)
        sum += judgedError(record, simulate(model, record.input)).squaredNorm();
    return std::isfinite(sum) ? sum / power_ : ranAway;
}

MatrixXd BlockError::factor(const VectorXd& values)
{
    const auto model = modelAt(values);
    TallQr qr(values.size() + 1);
    for (const auto& record : records_) {
        const VectorXd u = record.input.col(0), w = simulate(model.linear, u);
        // A long record times all coefficients is large: every column is made where it stays.
        MatrixXd rows(u.size(), values.size() + 1);
        const Index ofG = recursion_.parameters(), powers = values.size() - ofG - 1;
        rows.leftCols(ofG) = derivatives(model, u);
        const VectorXd direct = 1.0 + polynomialSlope(model.wiener, w.array()),
                       back = polynomialSlope(model.feedback, w.array());
        for (auto dw : rows.leftCols(ofG).colwise()) {
            const VectorXd dG = direct.cwiseProduct(dw);
            dw = model.feedback.size() > 0 ? VectorXd(dG + filtered(model.linear, back.cwiseProduct(dw))) : dG;
        }
        if (model.hammerstein.size() + model.feedback.size() > 0)
            rows.leftCols(ofG) += derivatives(model, polynomial(model.hammerstein, u.array())
                                                         + polynomial(model.feedback, w.array()));
        rows.middleCols(ofG, powers) << filtered(model.linear, powersOf(u, 2, model.hammerstein.size())),
            powersOf(w, 2, model.wiener.size()), filtered(model.linear, powersOf(w, 2, model.feedback.size()));
        rows.rightCols(2) << VectorXd::Ones(u.size()), record.output - simulate(model, record.input);
        qr.fold(rows.bottomRows(rows.rows() - record.skip));
    }
    return qr.R() / std::sqrt(power_);
}

MatrixXd BlockError::derivatives(const BlockModel& model, const VectorXd& v) const
{
    const auto linear = withoutTerms(model.linear);
    MatrixXd states, outputs, J(v.size(), recursion_.parameters());
    recursion_.run(linear, v, VectorXd::Zero(model.linear.order()), std::numeric_limits<double>::max(), states,
                   outputs);
    recursion_.differentiate(linear, v, states, [&](Index first, std::vector<MatrixXd>& d) {
        J.middleRows(first, d[0].rows()) = d[0].leftCols(J.cols());
    });
    return J;
}

}  // namespace excursion
