// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/FractionalPnlss/FractionalRecursion.h"

#include "Engine/Numerics/LuFactors.h"
#include "Engine/Polynomial/SensitivityKernels.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// What the equations are at one point: v, and its slopes by the states.
struct Equations {
    Equations(const Pnlss& wanted, const MonomialProducts& compiled)
        : form(wanted),
          monomials(compiled),
          nodes(compiled.nodes()),
          terms(wanted.terms()),
          slopes(wanted.linear.order(), wanted.linear.order()),
          outputSlopes(wanted.linear.outputs(), wanted.linear.order())
    {
    }

    void at(const VectorXd& zeta, const Eigen::Ref<const Eigen::RowVectorXd>& u)
    {
        const auto n = form.linear.order();
        nodes.segment(1, n) = zeta;
        nodes.segment(1 + n, u.size()) = u.transpose();
        monomials.evaluate(nodes.data());
        for (Index k = 0; k < terms.size(); ++k)
            terms[k] = nodes[monomials.termNode(k)];
    }

    void derivative(VectorXd& v) const
    {
        const auto n = form.linear.order(), m = form.linear.inputs();
        v.noalias() = form.linear.A * nodes.segment(1, n);
        v.noalias() += form.linear.B * nodes.segment(1 + n, m);
        v.noalias() += form.E * terms;
    }

    VectorXd output() const
    {
        const auto n = form.linear.order(), m = form.linear.inputs();
        return form.linear.C * nodes.segment(1, n) + form.linear.D * nodes.segment(1 + n, m) + form.F * terms;
    }

    void slope(bool ofOutput)
    {
        slopes = form.linear.A;
        for (const auto& s : monomials.slopes())
            slopes.col(s.state) += (s.factor * nodes[s.node]) * form.E.col(s.term);
        if (!ofOutput)
            return;
        outputSlopes = form.linear.C;
        for (const auto& s : monomials.slopes())
            outputSlopes.col(s.state) += (s.factor * nodes[s.node]) * form.F.col(s.term);
    }

    const Pnlss& form;
    const MonomialProducts& monomials;
    VectorXd nodes, terms;
    MatrixXd slopes, outputSlopes;  // A + E dp/dzeta, C + F dp/dzeta
};

/// The past of one trajectory: cells of all states and the last four derivatives, the newest first.
class Past {
public:
    Past(const std::vector<FractionalIntegrator>& integrators)
        : integrators_(integrators), history_(static_cast<Index>(integrators.size()), 4)
    {
        history_.setZero();
        for (const auto& f : integrators) {
            cells_.push_back(VectorXd::Zero(f.cells()));
            kept_.push_back(f.readout.cwiseProduct(f.decay));
        }
    }

    /// h of the step to come.
    void held(VectorXd& h) const
    {
        for (Index i = 0; i < h.size(); ++i) {
            const auto k = static_cast<std::size_t>(i);
            h[i] = kept_[k].dot(cells_[k])
                   + history_.row(i).head<3>().dot(integrators_[k].direct.tail<3>().transpose());
        }
    }

    void advance(const VectorXd& v)
    {
        for (Index j = 3; j > 0; --j)
            history_.col(j) = history_.col(j - 1);
        history_.col(0) = v;
        for (Index i = 0; i < v.size(); ++i) {
            const auto& f = integrators_[static_cast<std::size_t>(i)];
            auto& z = cells_[static_cast<std::size_t>(i)];
            z.array() *= f.decay.array();
            for (Index j = 0; j < 4; ++j)
                z += history_(i, j) * f.weight.col(j);
        }
    }

    const VectorXd& cells(Index state) const { return cells_[static_cast<std::size_t>(state)]; }
    const MatrixXd& history() const { return history_; }

private:
    const std::vector<FractionalIntegrator>& integrators_;
    std::vector<VectorXd> cells_, kept_;  // z_k, R_k e_k
    MatrixXd history_;                    // n x 4
};

}  // namespace

FractionalRecursion::FractionalRecursion(const FractionalPnlss& structure, const FractionalGrid& grid, bool linearFree,
                                         bool alphaFree)
    : grid_(grid),
      n_(structure.form.linear.order()),
      m_(structure.form.linear.inputs()),
      p_(structure.form.linear.outputs()),
      fractional_(structure.fractional),
      alphaFree_(alphaFree && structure.fractional.any()),
      linear_(structure.form, linearFree),
      monomials_(structure.form.exponents, n_ + m_, n_)
{
}

VectorXd FractionalRecursion::valuesOf(const FractionalPnlss& model) const
{
    VectorXd values(parameters());
    values.head(linear_.parameters()) = linear_.valuesOf(model.form);
    if (alphaFree_)
        values[values.size() - 1] = model.alpha;
    return values;
}

void FractionalRecursion::setValues(FractionalPnlss& model, const VectorXd& values) const
{
    linear_.setValues(model.form, values.head(linear_.parameters()));
    if (alphaFree_)
        model.alpha = values[values.size() - 1];
}

bool FractionalRecursion::run(const FractionalPnlss& model, const MatrixXd& input, double bound, Trajectory& out) const
{
    if (fractional_.any() && !(model.alpha > 0.01 && model.alpha < 0.99))
        return false;
    const auto cut = integratorsOf(fractional_, model.alpha, grid_);
    VectorXd gain(n_);
    for (Index i = 0; i < n_; ++i)
        gain[i] = cut[static_cast<std::size_t>(i)].direct[0];
    const auto N = input.rows();
    out.states.resize(n_, N);
    out.derivatives.resize(n_, N);
    out.output.resize(N / grid_.substeps, p_);
    Equations equations(model.form, monomials_);
    Past past(cut);
    VectorXd zeta = VectorXd::Zero(n_), before = zeta, size = zeta, h = zeta, v = zeta, rest = zeta, guess = zeta;
    MatrixXd M(n_, n_);
    RealLu solver;
    for (Index t = 0; t < N; ++t) {
        past.held(h);
        guess = 2.0 * zeta - before;
        before = zeta;
        zeta = guess;
        bool solved = false;
        for (int iteration = 0; iteration < 12 && !solved; ++iteration) {
            equations.at(zeta, input.row(t));
            equations.slope(false);
            equations.derivative(v);
            rest = zeta - h - gain.cwiseProduct(v);
            M.noalias() = -(gain.asDiagonal() * equations.slopes);
            M.diagonal().array() += 1.0;
            solver.compute(M);
            rest = solver.solve(rest);
            zeta -= rest;
            size = size.cwiseMax(zeta.cwiseAbs());
            solved = (rest.array().abs() <= 1e-13 * size.array() + 1e-300).all();
            if (!(zeta.cwiseAbs().maxCoeff() <= bound))
                return false;
        }
        // Rounding may keep the last digits in motion; a step that is further off has no solution near.
        equations.at(zeta, input.row(t));
        equations.derivative(v);
        if (!solved && !((zeta - h - gain.cwiseProduct(v)).array().abs() <= 1e-9 * size.array()).all())
            return false;
        past.advance(v);
        out.states.col(t) = zeta;
        out.derivatives.col(t) = v;
        if (t % grid_.substeps == 0)
            out.output.row(t / grid_.substeps) = equations.output().transpose();
    }
    return true;
}

void FractionalRecursion::differentiate(const FractionalPnlss& model, const MatrixXd& input, const Trajectory& run,
                                        const Recursion::Consumer& consume) const
{
    const auto cut = integratorsOf(fractional_, model.alpha, grid_);
    FractionalIntegrator slope;
    if (alphaFree_)
        slope = integratorSlope(model.alpha, grid_.step(), grid_.band);
    const auto P = parameters(), N = input.rows();
    const auto& columns = linear_.columns();
    VectorXd gain(n_);
    for (Index i = 0; i < n_; ++i)
        gain[i] = cut[static_cast<std::size_t>(i)].direct[0];
    Equations equations(model.form, monomials_);
    Past past(cut);  // for the slope of alpha
    std::vector<RowMajor> cells, history(4, RowMajor::Zero(n_, P));
    for (const auto& f : cut)
        cells.push_back(RowMajor::Zero(f.cells(), P));
    RowMajor held = RowMajor::Zero(n_, P), source(n_, P), states(n_, P), output(p_, P);
    std::vector<MatrixXd> block(static_cast<std::size_t>(p_));
    Index filled = 0, first = 0;
    for (auto& target : block)
        target.resize(kernels::stretch, P);
    for (Index t = 0; t < N; ++t) {
        const bool sampled = t % grid_.substeps == 0;
        const VectorXd zeta = run.states.col(t);
        equations.at(zeta, input.row(t));
        equations.slope(sampled);
        const auto regressor = [&](Index r) {
            return equations.nodes[r < n_ + m_ ? 1 + r : monomials_.termNode(r - n_ - m_)];
        };
        // d zeta = (I - diag(d_0) S)^-1 (held + diag(d_0) dv/dtheta [+ slope of alpha])
        states = held;
        source.setZero();
        for (std::size_t c = 0; c < columns.size(); ++c)
            if (columns[c].row < n_)
                source(columns[c].row, static_cast<Index>(c)) = regressor(columns[c].regressor);
        states += gain.asDiagonal() * source;
        if (alphaFree_) {
            const VectorXd v = run.derivatives.col(t);
            for (Index i = 0; i < n_; ++i)
                if (fractional_[i]) {
                    const auto& f = cut[static_cast<std::size_t>(i)];
                    const auto& z = past.cells(i).array();
                    states(i, P - 1) +=
                        ((slope.readout.array() * f.decay.array() + f.readout.array() * slope.decay.array()) * z).sum()
                        + slope.direct[0] * v[i]
                        + past.history().row(i).head<3>().dot(slope.direct.tail<3>().transpose());
                }
        }
        const MatrixXd inverse = RealLu(MatrixXd::Identity(n_, n_) - gain.asDiagonal() * equations.slopes).inverse();
        states = (inverse * states).eval();
        source.noalias() += equations.slopes * states;  // dv
        if (sampled) {
            output.noalias() = equations.outputSlopes * states;
            for (std::size_t c = 0; c < columns.size(); ++c)
                if (columns[c].row >= n_)
                    output(columns[c].row - n_, static_cast<Index>(c)) += regressor(columns[c].regressor);
            for (Index o = 0; o < p_; ++o)
                block[static_cast<std::size_t>(o)].row(filled) = output.row(o);
            if (++filled == kernels::stretch || t + grid_.substeps >= N) {
                for (auto& target : block)
                    target.conservativeResize(filled, P);
                consume(first, block);
                first += filled;
                filled = 0;
                for (auto& target : block)
                    target.resize(kernels::stretch, P);
            }
        }
        std::rotate(history.begin(), history.end() - 1, history.end());
        history[0] = source;
        for (Index i = 0; i < n_; ++i) {
            const auto& f = cut[static_cast<std::size_t>(i)];
            auto& z = cells[static_cast<std::size_t>(i)];
            kernels::advance(z.data(), f.cells(), P, f.decay.data(), f.weight.data(),
                             {history[0].row(i).data(), history[1].row(i).data(), history[2].row(i).data(),
                              history[3].row(i).data()},
                             f.readout.data(), f.direct.data(), held.row(i).data());
            if (alphaFree_ && fractional_[i]) {  // z and v of the step that ends here
                Eigen::RowVector4d v;
                v << run.derivatives(i, t), past.history().row(i).head<3>();
                const VectorXd moved = (slope.decay.array() * past.cells(i).array()).matrix()
                                       + slope.weight * v.transpose();
                z.col(P - 1) += moved;
                held(i, P - 1) += (f.readout.array() * f.decay.array() * moved.array()).sum();
            }
        }
        past.advance(run.derivatives.col(t));
    }
}

}  // namespace excursion
