// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Linear/PoleZero.h"

#include "Engine/Error.h"
#include "Engine/Linear/Response.h"
#include "Engine/Linear/SecondOrderSections.h"
#include "Engine/Numerics/Eigenvalues.h"
#include "Engine/Numerics/LuFactors.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace excursion {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

/// Partners next to each other, by ascending size.
std::vector<Complex> paired(std::vector<Complex> roots)
{
    std::sort(roots.begin(), roots.end(), [](Complex a, Complex b) {
        if (std::abs(a) != std::abs(b))
            return std::abs(a) < std::abs(b);
        return a.real() != b.real() ? a.real() < b.real() : a.imag() > b.imag();
    });
    std::vector<Complex> result;
    for (const auto& root : roots)
        if (root.imag() >= 0.0) {
            result.push_back(root);
            if (root.imag() > 0.0)
                result.push_back(std::conj(root));
        }
    return result;
}

/// Multiplied in turns, so that neither product runs out of range.
Complex product(const PoleZeroGain& g, Complex lambda)
{
    Complex value = 1.0;
    for (std::size_t k = 0; k < g.poles.size(); ++k) {
        value /= lambda - g.poles[k];
        if (k < g.zeros.size())
            value *= lambda - g.zeros[k];
    }
    return value;
}

/// The states scaled so that each receives as much as it gives (Osborne 1960): diag(T, 1) as a similarity of [A, B; C,
/// D].
StateSpace levelled(StateSpace model)
{
    auto& [A, B, C, D, rate] = model;
    const double b = B.norm(), c = C.norm(), a = A.norm();
    if (!(a > 0.0 && b > 0.0 && c > 0.0))
        return model;
    B *= a / b;
    C *= a / c;
    D *= (a / b) * (a / c);
    for (int sweep = 0; sweep < 30; ++sweep)
        for (Index i = 0; i < A.rows(); ++i) {
            const double self = A(i, i) * A(i, i);
            const double in = A.row(i).squaredNorm() - self + B.row(i).squaredNorm();
            const double out = A.col(i).squaredNorm() - self + C.col(i).squaredNorm();
            if (!(in > 0.0 && out > 0.0))
                continue;
            const double t = std::pow(in / out, 0.25);
            A.row(i) /= t;
            B.row(i) /= t;
            A.col(i) *= t;
            C.col(i) *= t;
        }
    return model;
}

/// Zeros as seen from a place on the real axis, by the pencil of StateSpace.h.
std::vector<Complex> zerosFrom(StateSpace model, double place)
{
    model.A.diagonal().array() -= place;
    auto roots = zeros(model);
    for (auto& root : roots)
        root += place;
    return roots;
}

/// The same without a pencil: in w = 1/(lambda - place) the model has a direct term, its response at the place, and
/// zeros at infinity lie at w = 0.
///     G = G(place) - C N^2 (w I - N)^-1 B,  N = (A - place I)^-1,  zeros: eigenvalues of N + B C N^2 / G(place)
std::vector<Complex> zerosInverted(const StateSpace& model, double place)
{
    Eigen::MatrixXd A = model.A;
    A.diagonal().array() -= place;
    const Eigen::MatrixXd N = RealLu(A).inverse();
    const Eigen::RowVectorXd CN = model.C * N;
    const double direct = model.D(0, 0) - (CN * model.B)(0, 0);
    const Eigen::MatrixXd Z = N + model.B * (CN * N) / direct;
    std::vector<Complex> roots;
    if (!Z.allFinite() || Z.rows() == 0)
        return roots;
    for (const auto& w : eigenvalues(Z))
        if (std::abs(w) > 0.0)
            roots.push_back(place + 1.0 / w);
    return roots;
}

std::vector<Complex> atMost(std::size_t most, std::vector<Complex> roots)
{
    roots = paired(std::move(roots));
    while (roots.size() > most)  // rounding has brought one in from infinity
        roots.resize(roots.size() - (roots.back().imag() < 0.0 ? 2 : 1));
    return roots;
}

/// One or two roots as mu^2 + b mu + e, or mu + e, of mu = lambda / scale.
struct Factor {
    int degree = 0;
    double b = 0.0, e = 1.0, size = 0.0;
};

std::vector<Factor> factorsOf(const std::vector<Complex>& roots)
{
    std::vector<Factor> factors;
    std::vector<double> real;
    for (const auto& root : roots)
        if (root.imag() > 0.0)
            factors.push_back({2, -2.0 * root.real(), std::norm(root), std::abs(root)});
        else if (root.imag() == 0.0)
            real.push_back(root.real());
    std::size_t k = 0;
    for (; k + 1 < real.size(); k += 2)
        factors.push_back(
            {2, -(real[k] + real[k + 1]), real[k] * real[k + 1], std::sqrt(std::abs(real[k] * real[k + 1]))});
    if (k < real.size())
        factors.push_back({1, 0.0, -real[k], std::abs(real[k])});
    return factors;
}

/// zeros / poles as a model, by partial fractions.
StateSpace section(const Factor& zeros, const Factor& poles, double sampleRate)
{
    const double scale = poles.size > 0.0 ? poles.size : 1.0;
    SecondOrderSections sections;
    sections.sampleRate = sampleRate;
    sections.scale = scale;
    // realize() takes mu with A = scale mu + 1 in discrete time as well.
    Eigen::MatrixXd C(1, poles.degree);
    double D = 0.0;
    if (poles.degree == 1) {
        sections.factors = Eigen::VectorXd::Constant(1, poles.e / scale);
        const bool proper = zeros.degree == 1;
        D = proper ? 1.0 : 0.0;
        C(0, 0) = proper ? (zeros.e - poles.e) / scale : 1.0 / scale;
    } else {
        const double b = poles.b / scale, e = poles.e / (scale * scale);
        sections.factors.resize(2);
        sections.factors << b, e;
        double first = 0.0, constant = 1.0 / (scale * scale);  // numerator beyond D, in mu
        if (zeros.degree == 2) {
            D = 1.0;
            first = (zeros.b - poles.b) / scale;
            constant = (zeros.e - poles.e) / (scale * scale);
        } else if (zeros.degree == 1) {
            first = 1.0 / scale;
            constant = zeros.e / (scale * scale);
        }
        C << constant - 0.5 * first * b, first;
    }
    return realize(sections, C, Eigen::VectorXd::Constant(1, D));
}

}  // namespace

Complex respond(const PoleZeroGain& g, double frequency)
{
    return g.gain * product(g, evaluationPoint(frequency, g.sampleRate));
}

PoleZeroGain poleZeroGainOf(const StateSpace& model)
{
    std::string reason;
    if (!model.isValid(&reason))
        throw Error(Error::Kind::usage, "The model has no poles and zeros: " + reason + ".");
    if (model.inputs() != 1 || model.outputs() != 1)
        throw Error(Error::Kind::usage, "Poles and zeros are told of models with one input and one output.");
    auto shifted = model;
    shifted.sampleRate = 0.0;
    if (!model.continuous())
        shifted.A.diagonal().array() -= 1.0;
    PoleZeroGain g;
    g.sampleRate = model.sampleRate;
    g.poles = paired(poles(shifted));
    const auto data = sampled(model, 101);
    Index strongest = 0;
    const double largest = data.value.col(0).cwiseAbs().maxCoeff(&strongest);
    if (!(largest > 0.0))
        throw Error(Error::Kind::data, "The response of the model is zero, so it has no zeros that could be told.");
    // Of a pencil with many zeros at infinity rounding makes finite ones, seen from one place and not from another.
    double logarithm = 0.0, least = std::numeric_limits<double>::infinity();
    for (const auto& pole : g.poles)
        logarithm += std::log(std::max(std::abs(pole), 1e-12));
    const double middle = g.poles.empty() ? 1.0 : std::exp(logarithm / static_cast<double>(g.poles.size()));
    const auto level = levelled(shifted);
    std::vector<std::vector<Complex>> candidates;
    for (const double place : {0.0, middle, -1.7 * middle})
        candidates.push_back(zerosFrom(level, place));
    for (const double place : {1.0, 0.31, 3.3, -1.3, -3.7})
        candidates.push_back(zerosInverted(level, place * middle));
    for (auto& candidate : candidates) {
        auto trial = g;
        trial.zeros = atMost(g.poles.size(), std::move(candidate));
        const auto pointAt = [&](Index k) {
            return evaluationPoint(data.frequency[static_cast<std::size_t>(k)], g.sampleRate);
        };
        trial.gain = (data.value(strongest, 0) / product(trial, pointAt(strongest))).real();
        double error = 0.0;
        for (Index k = 0; k < data.lines(); ++k)
            error = std::max(error, std::abs(trial.gain * product(trial, pointAt(k)) - data.value(k, 0)) / largest);
        if (error < least) {
            least = error;
            g.zeros = trial.zeros;
            g.gain = trial.gain;
        }
    }
    if (!(least < 1e-6))
        throw Error(
            Error::Kind::numerical,
            "The model's poles and zeros cannot be told well enough: their product does not give the response back.");
    return g;
}

StateSpace series(const StateSpace& first, const StateSpace& second)
{
    if (first.sampleRate != second.sampleRate || first.outputs() != second.inputs())
        throw Error(Error::Kind::usage, "Models follow one another when sample rates agree, and the outputs of the one "
                                        "are the inputs of the other.");
    const auto n = first.order(), k = second.order();
    StateSpace result;
    result.sampleRate = first.sampleRate;
    result.A = Eigen::MatrixXd::Zero(n + k, n + k);
    result.A.topLeftCorner(n, n) = first.A;
    result.A.bottomLeftCorner(k, n) = second.B * first.C;
    result.A.bottomRightCorner(k, k) = second.A;
    result.B.resize(n + k, first.inputs());
    result.B << first.B, second.B * first.D;
    result.C.resize(second.outputs(), n + k);
    result.C << second.D * first.C, second.C;
    result.D = second.D * first.D;
    return result;
}

StateSpace realize(const PoleZeroGain& g)
{
    if (g.zeros.size() > g.poles.size())
        throw Error(Error::Kind::usage, "A model cannot have more zeros than poles.");
    auto zeros = factorsOf(g.zeros);
    const auto poles = factorsOf(g.poles);
    std::vector<Factor> partner(poles.size());
    // The lone zero first: it goes to the lone pole where there is one, as a pair of zeros cannot.
    std::stable_sort(zeros.begin(), zeros.end(), [](const Factor& a, const Factor& b) { return a.degree < b.degree; });
    const bool odd = !poles.empty() && poles.back().degree == 1;
    for (const auto& zero : zeros) {
        std::size_t best = poles.size();
        double nearest = std::numeric_limits<double>::infinity();
        for (std::size_t k = 0; k < poles.size(); ++k) {
            const bool fits = zero.degree == 2 ? poles[k].degree == 2 : !odd || poles[k].degree == 1;
            const double apart = std::abs(std::log((poles[k].size + 1e-300) / (zero.size + 1e-300)));
            if (fits && partner[k].degree == 0 && apart < nearest) {
                best = k;
                nearest = apart;
            }
        }
        partner[best] = zero;
    }
    StateSpace model;
    model.sampleRate = g.sampleRate;
    model.A.resize(0, 0);
    model.B.resize(0, 1);
    model.C.resize(1, 0);
    model.D = Eigen::MatrixXd::Ones(1, 1);
    double gain = g.gain;
    for (std::size_t k = 0; k < poles.size(); ++k) {
        auto next = section(partner[k], poles[k], g.sampleRate);
        // Levelled where its poles are, so that the sections couple evenly.
        const double corner = std::min(poles[k].size, g.sampleRate > 0.0 ? 2.0 : poles[k].size);
        const double level = std::abs(next.D(0, 0)) + (next.C.norm() * next.B.norm()) / (corner > 0.0 ? corner : 1.0);
        next.C /= level;
        next.D /= level;
        gain *= level;
        model = series(model, next);
    }
    model.C *= gain;
    model.D *= gain;
    return model;
}

}  // namespace excursion
