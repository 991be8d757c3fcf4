// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/SmallSignal.h"

#include "Engine/Error.h"
#include "Engine/Loudspeaker/ArrowResolvent.h"
#include "Engine/Loudspeaker/Dynamics.h"
#include "Engine/Numerics/Eigenvalues.h"
#include "Engine/Numerics/Parallel.h"

#include <algorithm>
#include <array>
#include <map>
#include <numbers>

namespace excursion {
namespace {

/// Of a linear model, column by column: dz/dt and what leaves the driver, for a unit of each state and of what drives.
template <class T>
struct Columns {
    std::vector<std::vector<T>> rates;  ///< by state, and of what drives
    std::vector<std::array<T, 2>> outputs;
    T lateness;
};

template <class T>
Columns<T> columns(const Model& model, const std::vector<T>& parameters, Drives drives)
{
    const Dynamics<T> dynamics(model, parameters);
    const auto n = static_cast<std::size_t>(dynamics.order());
    Columns<T> result;
    result.rates.assign(n + 1, std::vector<T>(n, T(0.0)));
    for (std::size_t j = 0; j <= n; ++j) {
        std::vector<T> z(n, T(0.0));
        if (j < n)
            z[j] = T(1.0);
        auto& rates = result.rates[j];
        const double voltage = j == n && drives == Drives::terminals ? 1.0 : 0.0,
                     push = j == n && drives == Drives::cone ? 1.0 : 0.0;
        dynamics.rates(z.data(), T(voltage), rates.data(), T(push));
        const auto emission = dynamics.emission(z.data(), rates.data());
        result.outputs.push_back({emission.area * emission.acceleration, emission.spot});
    }
    const std::vector<T> rest(n, T(0.0));
    std::vector<T> still(n, T(0.0));
    dynamics.rates(rest.data(), T(0.0), still.data());
    result.lateness = dynamics.emission(rest.data(), still.data()).lateness;
    return result;
}

/// A place of [A B] or [C D] in which parameters act, and how: a parameter does so in a few places only, and many share
/// one.
struct Place {
    Eigen::Index row, column;
    std::vector<std::pair<Eigen::Index, double>> slopes;  ///< parameter, derivative
};

std::vector<Place> placesOf(const std::vector<Eigen::MatrixXd>& dM, const std::vector<Eigen::VectorXd>& dv)
{
    std::map<std::pair<Eigen::Index, Eigen::Index>, Place> places;
    for (std::size_t k = 0; k < dM.size(); ++k)
        for (Eigen::Index row = 0; row < dM[k].rows(); ++row)
            for (Eigen::Index column = 0; column <= dM[k].cols(); ++column)
                if (const double value = column < dM[k].cols() ? dM[k](row, column) : dv[k][row]; value != 0.0) {
                    auto& place = places[{row, column}];
                    place.row = row;
                    place.column = column;
                    place.slopes.emplace_back(static_cast<Eigen::Index>(k), value);
                }
    std::vector<Place> result;
    for (auto& [where, place] : places)
        result.push_back(std::move(place));
    return result;
}

/// A quantity as output of the linear part: s^order (row z + direct u), that of the pressure times a gain and delayed.
struct Observed {
    Eigen::RowVectorXd row;
    double direct = 0.0, gain = 1.0;
    int order = 0, source = -1;  ///< source: the row of C that it is made of, or -1
    bool delayed = false;
};

Observed observe(const Model& model, const SmallSignal& linear, Quantity quantity)
{
    Observed observed;
    observed.row = Eigen::RowVectorXd::Zero(linear.A.rows());
    const auto motion = [&](int order) {  // of the spot that the laser sees
        observed.row = linear.C.row(SmallSignal::spot);
        observed.row[1] += 1.0;
        observed.direct = linear.D[SmallSignal::spot];
        observed.order = order;
        observed.source = SmallSignal::spot;
    };
    switch (quantity) {
    case Quantity::current: observed.row[0] = 1.0; break;
    case Quantity::displacement: motion(0); break;
    case Quantity::velocity: motion(1); break;
    case Quantity::acceleration: motion(2); break;
    case Quantity::pressure:
        observed.row = linear.C.row(SmallSignal::sound);
        observed.direct = linear.D[SmallSignal::sound];
        observed.source = SmallSignal::sound;
        observed.gain = radiationPerArea() / model.microphoneDistance;
        observed.delayed = true;
        break;
    case Quantity::voltage:
    case Quantity::force: throw Error(Error::Kind::usage, "The input of a driver has no response to itself.");
    }
    return observed;
}

/// Places of the linear part's states and parameters among those of the whole, and how many these are.
struct LinearAmongAll {
    std::vector<Eigen::Index> states {0, 1, 2}, parameters;
    Eigen::Index order = 3, count = 0;
};

LinearAmongAll linearAmongAll(const Model& model)
{
    LinearAmongAll places;
    for (const auto& component : model.components) {
        const bool linear = component.effect->linear();
        for (int k = component.effect->memorySize(component.operatingRange); k > 0; --k, ++places.order)
            if (linear)
                places.states.push_back(places.order);
        for (std::size_t k = 0; k < component.parameters.size(); ++k, ++places.count)
            if (linear)
                places.parameters.push_back(places.count);
    }
    for (std::size_t k = 0; k < model.path.parameters.size(); ++k)
        places.parameters.push_back(places.count++);
    return places;
}

/// Of a model that is linear.
SmallSignal linearForm(const Model& model, bool withGradient, Drives drives)
{
    const auto theta = parameterVector(model);
    const auto plain = columns(model, std::vector<double>(theta.begin(), theta.end()), drives);
    const auto n = static_cast<Eigen::Index>(plain.rates.size()) - 1;
    SmallSignal result;
    result.A.resize(n, n);
    result.C.resize(2, n);
    for (Eigen::Index j = 0; j < n; ++j) {
        result.A.col(j) = Eigen::Map<const Eigen::VectorXd>(plain.rates[static_cast<std::size_t>(j)].data(), n);
        result.C.col(j) = Eigen::Map<const Eigen::Vector2d>(plain.outputs[static_cast<std::size_t>(j)].data());
    }
    result.B = Eigen::Map<const Eigen::VectorXd>(plain.rates.back().data(), n);
    result.D = Eigen::Map<const Eigen::Vector2d>(plain.outputs.back().data());
    result.lateness = plain.lateness;
    if (!withGradient)
        return result;

    const auto count = theta.size();
    result.dA.assign(static_cast<std::size_t>(count), Eigen::MatrixXd(n, n));
    result.dB.assign(static_cast<std::size_t>(count), Eigen::VectorXd(n));
    result.dC.assign(static_cast<std::size_t>(count), Eigen::MatrixXd(2, n));
    result.dD.assign(static_cast<std::size_t>(count), Eigen::VectorXd(2));
    result.dLateness.assign(static_cast<std::size_t>(count), 0.0);
    for (Eigen::Index first = 0; first < count; first += jetWidth) {
        std::vector<Jet> parameters(static_cast<std::size_t>(count));
        for (Eigen::Index k = 0; k < count; ++k)
            parameters[static_cast<std::size_t>(k)] = k >= first && k < first + jetWidth
                                                          ? Jet(theta[k], static_cast<int>(k - first))
                                                          : Jet(theta[k]);
        const auto jets = columns(model, parameters, drives);
        for (Eigen::Index k = first; k < std::min<Eigen::Index>(count, first + jetWidth); ++k) {
            const auto own = static_cast<std::size_t>(k);
            for (std::size_t column = 0; column < jets.rates.size(); ++column) {
                const bool isState = column + 1 < jets.rates.size();
                const auto at = static_cast<Eigen::Index>(column);
                for (Eigen::Index row = 0; row < n; ++row)
                    (isState ? result.dA[own](row, at)
                             : result.dB[own][row]) = jets.rates[column][static_cast<std::size_t>(row)].v[k - first];
                for (Eigen::Index row = 0; row < 2; ++row)
                    (isState ? result.dC[own](row, at)
                             : result.dD[own][row]) = jets.outputs[column][static_cast<std::size_t>(row)].v[k - first];
            }
            result.dLateness[own] = jets.lateness.v[k - first];
        }
    }
    return result;
}

/// The responses of a linear part to what drives it, once z = (s I - A)^-1 B is known.
struct DrivenResponse {
    SmallSignal linear;
    std::vector<Observed> observed;
    std::vector<Place> inside, outside;

    DrivenResponse(const Model& model, SmallSignal part, const std::vector<Quantity>& quantities)
        : linear(std::move(part))
    {
        for (const auto quantity : quantities)
            observed.push_back(observe(model, linear, quantity));
        inside = placesOf(linear.dA, linear.dB);
        outside = placesOf(linear.dC, linear.dD);
    }

    std::complex<double> factor(std::size_t q, std::complex<double> s) const
    {
        std::complex<double> result = observed[q].gain;
        for (int k = 0; k < observed[q].order; ++k)
            result *= s;
        return observed[q].delayed ? result * std::exp(-s * linear.lateness) : result;
    }

    std::complex<double> value(std::size_t q, std::complex<double> s, const Eigen::VectorXcd& z) const
    {
        return factor(q, s) * ((observed[q].row * z)(0) + observed[q].direct);
    }

    /// d(C R B + D) = C R (dA R B + dB) + dC R B + dD with R = (sI - A)^-1 and left = C R.
    void differentiate(std::size_t q, std::complex<double> s, const Eigen::VectorXcd& z, const Eigen::VectorXcd& left,
                       std::complex<double> value, const std::vector<Eigen::Index>& parameters,
                       Eigen::VectorXcd& row) const
    {
        const auto by = factor(q, s);
        const auto act = [&](const Place& place, std::complex<double> through) {
            const auto moved = through * (place.column < z.size() ? z[place.column] : std::complex<double>(1.0));
            for (const auto& [parameter, slope] : place.slopes)
                row[parameters[static_cast<std::size_t>(parameter)]] += slope * moved;
        };
        for (const auto& place : inside)
            act(place, by * left[place.row]);
        for (const auto& place : outside)
            if (place.row == observed[q].source)
                act(place, by);
        if (observed[q].delayed)
            for (std::size_t k = 0; k < linear.dLateness.size(); ++k)
                row[parameters[k]] -= s * linear.dLateness[k] * value;
    }
};

}  // namespace

SmallSignal smallSignal(const Model& model, bool withGradient, Drives drives)
{
    const auto [states, parameters, n, count] = linearAmongAll(model);
    auto part = linearForm(linearPart(model), withGradient, drives);
    if (static_cast<Eigen::Index>(states.size()) == n && static_cast<Eigen::Index>(parameters.size()) == count)
        return part;

    const auto square = [&states = states, n = n](const Eigen::MatrixXd& A) {
        Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(n, n);
        whole(states, states) = A;
        return whole;
    };
    const auto wide = [&states = states, n = n](const Eigen::MatrixXd& C) {
        Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(C.rows(), n);
        whole(Eigen::all, states) = C;
        return whole;
    };
    const auto tall = [&states = states, n = n](const Eigen::VectorXd& B) {
        Eigen::VectorXd whole = Eigen::VectorXd::Zero(n);
        whole(states) = B;
        return whole;
    };
    SmallSignal result;
    result.A = square(part.A);
    result.B = tall(part.B);
    result.C = wide(part.C);
    result.D = part.D;
    result.lateness = part.lateness;
    if (withGradient) {
        const auto all = static_cast<std::size_t>(count);
        result.dA.assign(all, Eigen::MatrixXd::Zero(n, n));
        result.dB.assign(all, Eigen::VectorXd::Zero(n));
        result.dC.assign(all, Eigen::MatrixXd::Zero(2, n));
        result.dD.assign(all, Eigen::VectorXd::Zero(2));
        result.dLateness.assign(all, 0.0);
        for (std::size_t k = 0; k < parameters.size(); ++k) {
            const auto place = static_cast<std::size_t>(parameters[k]);
            result.dA[place] = square(part.dA[k]);
            result.dB[place] = tall(part.dB[k]);
            result.dC[place] = wide(part.dC[k]);
            result.dD[place] = part.dD[k];
            result.dLateness[place] = part.dLateness[k];
        }
    }
    return result;
}

Eigen::VectorXcd poles(const SmallSignal& linear) { return eigenvalues(inUnits(linear.A, stateUnits(linear.A))); }

bool isStable(const Model& model)
{
    const auto A = smallSignal(model).A;
    if (!A.allFinite())
        return false;
    const auto balanced = inUnits(A, stateUnits(A));
    return eigenvalues(balanced).real().maxCoeff() <= 1e-9 * balanced.cwiseAbs().maxCoeff();
}

std::vector<Response> respond(const Model& model, const std::vector<Quantity>& quantities,
                              const std::vector<double>& frequency, bool withGradient, Drives drives)
{
    return respondToEach(model, quantities, frequency, {drives}, withGradient).front();
}

std::vector<std::vector<Response>> respondToEach(const Model& model, const std::vector<Quantity>& quantities,
                                                 const std::vector<double>& frequency,
                                                 const std::vector<Drives>& drives, bool withGradient, unsigned threads)
{
    using Complex = std::complex<double>;
    const auto among = linearAmongAll(model);  // laws and their memories have no part in it
    const auto small = linearPart(model);
    std::vector<DrivenResponse> driven;
    for (const auto drive : drives)
        driven.emplace_back(model, linearForm(small, withGradient, drive), quantities);
    const ArrowResolvent resolvent(driven.front().linear.A);
    std::vector<Eigen::VectorXcd> inputs, outputs;
    for (const auto& d : driven)
        inputs.push_back(resolvent.turnedRight(d.linear.B.cast<std::complex<double>>()));
    for (const auto& of : driven.front().observed)
        outputs.push_back(resolvent.turnedLeft(of.row));
    std::vector<std::vector<Response>> responses(drives.size(), std::vector<Response>(quantities.size()));
    for (auto& ofDrive : responses)
        for (auto& response : ofDrive) {
            response.value.resize(frequency.size());
            if (withGradient)
                response.gradient = Eigen::MatrixXcd::Zero(static_cast<Eigen::Index>(frequency.size()), among.count);
        }
    const std::size_t parts = std::max(1U, threads);
    inParallel(parts, threads, {}, [&](std::size_t part) {
        auto at = resolvent;
        std::vector<Eigen::VectorXcd> left(quantities.size());
        // of one response by all parameters: together, as those of other frequencies lie between them
        Eigen::VectorXcd slopes(among.count);
        for (std::size_t f = part * frequency.size() / parts; f < (part + 1) * frequency.size() / parts; ++f) {
            const Complex s(0.0, 2.0 * std::numbers::pi * frequency[f]);
            at.moveTo(s);
            if (withGradient)
                for (std::size_t q = 0; q < quantities.size(); ++q)
                    left[q] = at.row(outputs[q]);
            for (std::size_t d = 0; d < driven.size(); ++d) {
                const Eigen::VectorXcd z = at.column(inputs[d]);
                for (std::size_t q = 0; q < quantities.size(); ++q) {
                    responses[d][q].value[f] = driven[d].value(q, s, z);
                    if (!withGradient)
                        continue;
                    slopes.setZero();
                    driven[d].differentiate(q, s, z, left[q], responses[d][q].value[f], among.parameters, slopes);
                    responses[d][q].gradient.row(static_cast<Eigen::Index>(f)) = slopes.transpose();
                }
            }
        }
        return true;
    });
    return responses;
}

}  // namespace excursion
