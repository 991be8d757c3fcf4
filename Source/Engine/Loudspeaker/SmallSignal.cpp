// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/SmallSignal.h"

#include "Engine/Error.h"
#include "Engine/Loudspeaker/ArrowResolvent.h"
#include "Engine/Loudspeaker/Dynamics.h"
#include "Engine/Loudspeaker/SensorResponse.h"
#include "Engine/Numerics/Eigenvalues.h"
#include "Engine/Numerics/Parallel.h"

#include <algorithm>
#include <array>
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

/// Slopes as they are found, each at its place.
class Places {
public:
    Places(Eigen::Index rows, Eigen::Index columns)
        : columns_(columns), slopes_(static_cast<std::size_t>(rows * columns))
    {
    }
    void add(Eigen::Index row, Eigen::Index column, Eigen::Index parameter, double slope)
    {
        if (slope != 0.0)
            slopes_[static_cast<std::size_t>(row * columns_ + column)].emplace_back(parameter, slope);
    }
    /// Those in which something acts, row by row.
    std::vector<Place> taken() &&
    {
        std::vector<Place> places;
        for (std::size_t n = 0; n < slopes_.size(); ++n)
            if (!slopes_[n].empty()) {
                const auto at = static_cast<Eigen::Index>(n);
                places.push_back({at / columns_, at % columns_, std::move(slopes_[n])});
            }
        return places;
    }

private:
    Eigen::Index columns_;
    std::vector<std::vector<std::pair<Eigen::Index, double>>> slopes_;
};

/// A quantity as output of the linear part: s^order (row z + direct u), that of the pressure times a gain and delayed.
struct Observed {
    Eigen::RowVectorXd row;
    double direct = 0.0, gain = 1.0;
    int order = 0, source = -1;  ///< source: the row of C that it is made of, or -1
    bool delayed = false;
    SensorResponse sensor;
    std::vector<SensorParameter> ofSensor;  ///< placed among all parameters of the model
};

Observed observe(const Model& model, const SmallSignal& linear, Quantity quantity)
{
    Observed observed;
    observed.row = Eigen::RowVectorXd::Zero(linear.A.rows());
    observed.sensor = sensorOf(model, quantity);
    for (const auto& p : sensorParameters(quantity))
        observed.ofSensor.push_back({firstParameterOf(model, model.components.size()) + p.place, p.value});
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

/// A linear part, and where its parameters act.
struct LinearForm {
    SmallSignal part;
    std::vector<Place> inside, outside;  ///< [A B], [C D]
    std::vector<double> dLateness;       ///< by parameter
};

/// Of a model that is linear.
LinearForm linearForm(const Model& model, bool withGradient, Drives drives)
{
    const auto theta = parameterVector(model);
    const auto plain = columns(model, std::vector<double>(theta.begin(), theta.end()), drives);
    const auto n = static_cast<Eigen::Index>(plain.rates.size()) - 1;
    LinearForm form;
    auto& part = form.part;
    part.A.resize(n, n);
    part.C.resize(2, n);
    for (Eigen::Index j = 0; j < n; ++j) {
        part.A.col(j) = Eigen::Map<const Eigen::VectorXd>(plain.rates[static_cast<std::size_t>(j)].data(), n);
        part.C.col(j) = Eigen::Map<const Eigen::Vector2d>(plain.outputs[static_cast<std::size_t>(j)].data());
    }
    part.B = Eigen::Map<const Eigen::VectorXd>(plain.rates.back().data(), n);
    part.D = Eigen::Map<const Eigen::Vector2d>(plain.outputs.back().data());
    part.lateness = plain.lateness;
    if (!withGradient)
        return form;

    const auto count = theta.size();
    Places inside(n, n + 1), outside(2, n + 1);
    for (Eigen::Index first = 0; first < count; first += jetWidth) {
        std::vector<Jet> parameters(static_cast<std::size_t>(count));
        for (Eigen::Index k = 0; k < count; ++k)
            parameters[static_cast<std::size_t>(k)] = k >= first && k < first + jetWidth
                                                          ? Jet(theta[k], static_cast<int>(k - first))
                                                          : Jet(theta[k]);
        const auto jets = columns(model, parameters, drives);
        for (Eigen::Index k = first; k < std::min<Eigen::Index>(count, first + jetWidth); ++k) {
            for (Eigen::Index column = 0; column <= n; ++column) {
                const auto at = static_cast<std::size_t>(column);
                for (Eigen::Index row = 0; row < n; ++row)
                    inside.add(row, column, k, jets.rates[at][static_cast<std::size_t>(row)].v[k - first]);
                for (Eigen::Index row = 0; row < 2; ++row)
                    outside.add(row, column, k, jets.outputs[at][static_cast<std::size_t>(row)].v[k - first]);
            }
            form.dLateness.push_back(jets.lateness.v[k - first]);
        }
    }
    form.inside = std::move(inside).taken();
    form.outside = std::move(outside).taken();
    return form;
}

/// The responses of a linear part to what drives it, once z = (s I - A)^-1 B is known.
struct DrivenResponse {
    LinearForm linear;
    std::vector<Observed> observed;

    DrivenResponse(const Model& model, LinearForm form, const std::vector<Quantity>& quantities)
        : linear(std::move(form))
    {
        for (const auto quantity : quantities)
            observed.push_back(observe(model, linear.part, quantity));
    }

    std::complex<double> factor(std::size_t q, std::complex<double> s) const
    {
        std::complex<double> result = observed[q].gain;
        for (int k = 0; k < observed[q].order; ++k)
            result *= s;
        if (observed[q].delayed)
            result *= std::exp(-s * linear.part.lateness);
        return observed[q].sensor.immediate() ? result : result * observed[q].sensor(s);
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
        for (const auto& place : linear.inside)
            act(place, by * left[place.row]);
        for (const auto& place : linear.outside)
            if (place.row == observed[q].source)
                act(place, by);
        if (observed[q].delayed)
            for (std::size_t k = 0; k < linear.dLateness.size(); ++k)
                row[parameters[k]] -= s * linear.dLateness[k] * value;
        for (const auto& p : observed[q].ofSensor)
            row[p.place] += observed[q].sensor.logSlope(p.value, s) * value;
    }
};

}  // namespace

SmallSignal smallSignal(const Model& model, bool withGradient, Drives drives)
{
    const auto among = linearAmongAll(model);
    const auto n = among.order;
    const auto form = linearForm(linearPart(model), withGradient, drives);
    SmallSignal result;
    result.A = Eigen::MatrixXd::Zero(n, n);
    for (std::size_t k = 0; k < among.states.size(); ++k)
        result.A.col(among.states[k])(among.states) = form.part.A.col(static_cast<Eigen::Index>(k));
    result.B = Eigen::VectorXd::Zero(n);
    result.B(among.states) = form.part.B;
    result.C = Eigen::MatrixXd::Zero(2, n);
    result.C(Eigen::all, among.states) = form.part.C;
    result.D = form.part.D;
    result.lateness = form.part.lateness;
    if (!withGradient)
        return result;
    const auto all = static_cast<std::size_t>(among.count);
    result.dA.assign(all, Eigen::MatrixXd::Zero(n, n));
    result.dB.assign(all, Eigen::VectorXd::Zero(n));
    result.dC.assign(all, Eigen::MatrixXd::Zero(2, n));
    result.dD.assign(all, Eigen::VectorXd::Zero(2));
    result.dLateness.assign(all, 0.0);
    const auto of = [&](Eigen::Index parameter) {
        return static_cast<std::size_t>(among.parameters[static_cast<std::size_t>(parameter)]);
    };
    const auto fill = [&](const std::vector<Place>& places, auto&& rowOf, auto& matrices, auto& vectors) {
        for (const auto& place : places)
            for (const auto& [parameter, slope] : place.slopes)
                if (const auto own = of(parameter), column = static_cast<std::size_t>(place.column);
                    column < among.states.size())
                    matrices[own](rowOf(place.row), among.states[column]) = slope;
                else
                    vectors[own][rowOf(place.row)] = slope;
    };
    fill(
        form.inside, [&](Eigen::Index row) { return among.states[static_cast<std::size_t>(row)]; }, result.dA,
        result.dB);
    fill(
        form.outside, [](Eigen::Index row) { return row; }, result.dC, result.dD);
    for (std::size_t k = 0; k < form.dLateness.size(); ++k)
        result.dLateness[of(static_cast<Eigen::Index>(k))] = form.dLateness[k];
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
    const ArrowResolvent resolvent(driven.front().linear.part.A);
    std::vector<Eigen::VectorXcd> inputs, outputs;
    for (const auto& d : driven)
        inputs.push_back(resolvent.turnedRight(d.linear.part.B.cast<std::complex<double>>()));
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
