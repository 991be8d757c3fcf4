// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/SensorResponse.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

namespace excursion {
namespace {

constexpr std::array sensed {Quantity::current, Quantity::displacement, Quantity::velocity, Quantity::acceleration,
                             Quantity::pressure};

}  // namespace

std::complex<double> SensorResponse::operator()(std::complex<double> s) const
{
    auto result = std::exp(-s * (lag - q * T));
    if (T != 0.0)
        result /= 1.0 + s * T * (q + s * T);
    if (further != 0.0)
        result *= (s + rolledOff) / (s + rolledOff + further);
    return result;
}

std::complex<double> SensorResponse::logSlope(double SensorResponse::*by, std::complex<double> s) const
{
    const auto corner = 1.0 + s * T * (q + s * T);
    const auto byDamping = s - s / corner;  // by q T
    if (by == &SensorResponse::lag)
        return -s;
    if (by == &SensorResponse::T)
        return q * byDamping - 2.0 * s * s * T / corner;
    if (by == &SensorResponse::q)
        return T * byDamping;
    const auto rolled = -1.0 / (s + rolledOff + further);
    return by == &SensorResponse::further ? rolled : rolled + 1.0 / (s + rolledOff);
}

std::span<const SensorParameter> sensorParameters(Quantity quantity)
{
    using S = SensorResponse;
    // in the order of the path's parameters (Radiation.cpp)
    static constexpr std::array current {SensorParameter {2, &S::lag}};
    static constexpr std::array displacement {SensorParameter {3, &S::lag}, SensorParameter {6, &S::T},
                                              SensorParameter {7, &S::q}};
    static constexpr std::array velocity {SensorParameter {4, &S::lag}, SensorParameter {8, &S::T},
                                          SensorParameter {9, &S::q}};
    static constexpr std::array acceleration {SensorParameter {5, &S::lag}, SensorParameter {10, &S::T},
                                              SensorParameter {11, &S::q}};
    static constexpr std::array pressure {SensorParameter {12, &S::rolledOff}, SensorParameter {13, &S::further}};
    switch (quantity) {
    case Quantity::current: return current;
    case Quantity::displacement: return displacement;
    case Quantity::velocity: return velocity;
    case Quantity::acceleration: return acceleration;
    case Quantity::pressure: return pressure;
    case Quantity::voltage:
    case Quantity::force: break;
    }
    return {};
}

SensorResponse sensorOf(const Model& model, Quantity quantity)
{
    SensorResponse sensor;
    for (const auto& p : sensorParameters(quantity))
        sensor.*p.value = model.path.parameters[static_cast<std::size_t>(p.place)].value;
    return sensor;
}

Model withoutSensors(Model model)
{
    for (const auto quantity : sensed)
        for (const auto& p : sensorParameters(quantity))
            model.path.parameters[static_cast<std::size_t>(p.place)].value = 0.0;
    return model;
}

void passSensor(std::vector<std::complex<double>>& spectrum, double step, const SensorResponse& sensor)
{
    if (sensor.immediate())
        return;
    for (std::size_t k = 0; k < spectrum.size(); ++k)
        spectrum[k] *= sensor(std::complex<double>(0.0, step * static_cast<double>(k)));
}

namespace {

/// 1/p, in another unit.
Parameter inverted(Parameter p, std::string name, std::string unit, double times)
{
    p.name = std::move(name);
    p.unit = std::move(unit);
    p.standardError *= times / (p.value * p.value);
    p.value = times / p.value;
    return p;
}

}  // namespace

std::vector<Parameter> toldOfPath(const Model& model)
{
    constexpr double turn = 2.0 * std::numbers::pi;
    std::vector<Parameter> told;
    const auto isTold = [](const Parameter& p) {
        return !std::isfinite(p.prior) || std::isfinite(p.standardError) || (!p.free && p.value != 0.0);
    };
    std::optional<Parameter> rolledOff;  // until it is told with what it is off
    for (auto p : model.path.parameters) {
        if (!isTold(p))
            continue;
        const bool isCorner = p.name.starts_with("T_"), isLoss = p.name.starts_with("q_");
        if ((isCorner || isLoss) && p.value == 0.0)
            continue;
        if (isCorner)
            p = inverted(p, "corner_" + p.name.substr(2), "Hz", 1.0 / turn);
        else if (isLoss)
            p = inverted(p, "Q_" + p.name.substr(2), "", 1.0);
        else if (p.name == "w_p") {
            rolledOff = p;
            continue;
        } else if (p.name == "dw_p") {
            p.value += rolledOff ? rolledOff->value : 0.0;
            rolledOff = std::move(p);
            continue;
        }
        told.push_back(std::move(p));
    }
    if (rolledOff) {
        rolledOff->name = "corner_p";
        rolledOff->unit = "Hz";
        rolledOff->value /= turn;
        rolledOff->standardError /= turn;
        told.push_back(std::move(*rolledOff));
    }
    return told;
}

}  // namespace excursion
