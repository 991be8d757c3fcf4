// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Driver/Linearize.h"

#include "Engine/Driver/Dynamics.h"
#include "Engine/Driver/Resolvent.h"
#include "Engine/Error.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <numbers>

namespace excursion {
namespace {

/// The rates of a linear model at every unit state, and under a unit input.
template <class T>
void columns(const Model& model, const std::vector<T>& parameters, std::vector<std::vector<T>>& result)
{
    const Dynamics<T> dynamics(model, parameters);
    const auto n = static_cast<std::size_t>(dynamics.order());
    result.assign(n + 1, std::vector<T>(n, T(0.0)));
    for (std::size_t j = 0; j <= n; ++j) {
        std::vector<T> z(n, T(0.0));
        if (j < n)
            z[j] = T(1.0);
        dynamics.rates(z.data(), T(j < n ? 0.0 : 1.0), result[j].data());
    }
}

/// One entry of dA (or of dB: column n) that is not zero. A parameter acts in a few places only.
struct Entry {
    Eigen::Index parameter, row, column;
    double value;
};

std::vector<Entry> nonzero(const Linearization& linear)
{
    std::vector<Entry> entries;
    const auto n = linear.A.rows();
    for (std::size_t k = 0; k < linear.dA.size(); ++k)
        for (Eigen::Index row = 0; row < n; ++row)
            for (Eigen::Index column = 0; column <= n; ++column)
                if (const double value = column < n ? linear.dA[k](row, column) : linear.dB[k][row]; value != 0.0)
                    entries.push_back({static_cast<Eigen::Index>(k), row, column, value});
    return entries;
}

} // namespace

namespace {

/// Of a model that is linear.
Linearization linearForm(const Model& model, bool withGradient)
{
    const auto theta = parameterVector(model);
    std::vector<std::vector<double>> plain;
    columns(model, std::vector<double>(theta.begin(), theta.end()), plain);
    const auto n = static_cast<Eigen::Index>(plain.size()) - 1;
    Linearization result;
    result.A.resize(n, n);
    for (Eigen::Index j = 0; j < n; ++j)
        result.A.col(j) = Eigen::Map<const Eigen::VectorXd>(plain[static_cast<std::size_t>(j)].data(), n);
    result.B = Eigen::Map<const Eigen::VectorXd>(plain.back().data(), n);
    if (!withGradient)
        return result;

    const auto count = theta.size();
    result.dA.assign(static_cast<std::size_t>(count), Eigen::MatrixXd(n, n));
    result.dB.assign(static_cast<std::size_t>(count), Eigen::VectorXd(n));
    for (Eigen::Index first = 0; first < count; first += jetWidth) {
        std::vector<Jet> parameters(static_cast<std::size_t>(count));
        for (Eigen::Index k = 0; k < count; ++k)
            parameters[static_cast<std::size_t>(k)] = k >= first && k < first + jetWidth
                                                          ? Jet(theta[k], static_cast<int>(k - first))
                                                          : Jet(theta[k]);
        std::vector<std::vector<Jet>> jets;
        columns(model, parameters, jets);
        for (Eigen::Index k = first; k < std::min<Eigen::Index>(count, first + jetWidth); ++k) {
            auto& dA = result.dA[static_cast<std::size_t>(k)];
            for (Eigen::Index row = 0; row < n; ++row) {
                const auto derivative = [&](std::size_t column) { return jets[column][static_cast<std::size_t>(row)].v[k - first]; };
                for (Eigen::Index column = 0; column < n; ++column)
                    dA(row, column) = derivative(static_cast<std::size_t>(column));
                result.dB[static_cast<std::size_t>(k)][row] = derivative(static_cast<std::size_t>(n));
            }
        }
    }
    return result;
}

} // namespace

Linearization linearize(const Model& model, bool withGradient)
{
    // Places of the linear part's states and parameters among those of the whole.
    std::vector<Eigen::Index> states {0, 1, 2}, parameters;
    Eigen::Index n = 3, count = 0;
    for (const auto& component : model.components) {
        const bool linear = component.effect->linear();
        for (int k = component.effect->memorySize(component.extent); k > 0; --k, ++n)
            if (linear)
                states.push_back(n);
        for (std::size_t k = 0; k < component.parameters.size(); ++k, ++count)
            if (linear)
                parameters.push_back(count);
    }
    for (std::size_t k = 0; k < model.path.size(); ++k)
        parameters.push_back(count++);
    const auto part = linearForm(linearPart(model), withGradient);
    if (static_cast<Eigen::Index>(states.size()) == n && static_cast<Eigen::Index>(parameters.size()) == count)
        return part;

    const auto placed = [&](const Eigen::MatrixXd& A) {
        Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(n, A.cols() == 1 ? 1 : n);
        if (A.cols() == 1)
            whole(states, 0) = A;
        else
            whole(states, states) = A;
        return whole;
    };
    Linearization result;
    result.A = placed(part.A);
    result.B = placed(part.B);
    if (withGradient) {
        result.dA.assign(static_cast<std::size_t>(count), Eigen::MatrixXd::Zero(n, n));
        result.dB.assign(static_cast<std::size_t>(count), Eigen::VectorXd::Zero(n));
        for (std::size_t k = 0; k < parameters.size(); ++k) {
            result.dA[static_cast<std::size_t>(parameters[k])] = placed(part.dA[k]);
            result.dB[static_cast<std::size_t>(parameters[k])] = placed(part.dB[k]);
        }
    }
    return result;
}

Eigen::VectorXcd poles(const Linearization& linear)
{
    return inUnits(linear.A, stateUnits(linear.A)).eigenvalues();
}

bool isStable(const Model& model)
{
    const auto A = linearize(model).A;
    if (!A.allFinite())
        return false;
    const auto balanced = inUnits(A, stateUnits(A));
    return balanced.eigenvalues().real().maxCoeff() <= 1e-9 * balanced.cwiseAbs().maxCoeff();
}

std::vector<Response> respond(const Model& model, const std::vector<Quantity>& quantities,
                              const std::vector<double>& frequency, bool withGradient)
{
    using Complex = std::complex<double>;
    const auto linear = linearize(model, withGradient);
    const auto n = linear.A.rows();
    const auto count = static_cast<Eigen::Index>(parametersOf(model).size());
    const Eigen::VectorXcd B = linear.B.cast<Complex>();
    const double radiation = radiationPerArea() / model.microphoneDistance;
    const double area = model.path[0].value, tau = model.path[1].value;

    std::vector<Response> responses(quantities.size());
    for (auto& response : responses) {
        response.value.resize(frequency.size());
        if (withGradient)
            response.gradient = Eigen::MatrixXcd::Zero(static_cast<Eigen::Index>(frequency.size()), count);
    }
    const auto entries = nonzero(linear);
    Resolvent resolvent(linear.A);
    for (std::size_t f = 0; f < frequency.size(); ++f) {
        const Complex s(0.0, 2.0 * std::numbers::pi * frequency[f]);
        resolvent.moveTo(s);
        const Eigen::VectorXcd z = resolvent.times(B);
        for (std::size_t q = 0; q < quantities.size(); ++q) {
            // Each quantity is a state times a factor: displacement x, velocity s x, acceleration s^2 x.
            Complex factor = 1.0;
            Eigen::Index state = 1;
            switch (quantities[q]) {
            case Quantity::current: state = 0; break;
            case Quantity::displacement: break;
            case Quantity::velocity: factor = s; break;
            case Quantity::acceleration: factor = s * s; break;
            case Quantity::pressure: factor = s * s * radiation * area * std::exp(-s * tau); break;
            case Quantity::voltage:
            case Quantity::force: throw Error(Error::Kind::usage, "The input of a driver has no response to itself.");
            }
            const Complex value = factor * z[state];
            responses[q].value[f] = value;
            if (!withGradient)
                continue;
            // d(C R B) = C R (dA R B + dB) with R = (sI - A)^-1.
            const Eigen::VectorXcd left = resolvent.row(state);
            auto row = responses[q].gradient.row(static_cast<Eigen::Index>(f));
            for (const auto& entry : entries)
                row[entry.parameter] += factor * left[entry.row] * entry.value * (entry.column < n ? z[entry.column] : Complex(1.0));
            if (quantities[q] == Quantity::pressure) {
                row[count - 2] += value / area;
                row[count - 1] += -s * value;
            }
        }
    }
    return responses;
}

} // namespace excursion
