// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/SensorResponse.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace excursion {
namespace {

/// In the order of the path's parameters (Radiation.cpp): a lag of each, then T and q of each motion.
constexpr std::array sensed {Quantity::current, Quantity::displacement, Quantity::velocity, Quantity::acceleration};
constexpr Eigen::Index firstLag = 2, firstCorner = firstLag + static_cast<Eigen::Index>(sensed.size());

Parameter& placed(Model& model, Eigen::Index place) { return model.path.parameters[static_cast<std::size_t>(place)]; }

}  // namespace

std::complex<double> SensorResponse::operator()(std::complex<double> s) const
{
    const auto late = std::exp(-s * (lag - q * T));
    return T == 0.0 ? late : late / (1.0 + s * T * (q + s * T));
}

std::array<std::complex<double>, 3> SensorResponse::logSlopes(std::complex<double> s) const
{
    const auto corner = 1.0 + s * T * (q + s * T);
    const auto byDamping = s - s / corner;  // by q T
    return {-s, q * byDamping - 2.0 * s * s * T / corner, T * byDamping};
}

std::vector<Eigen::Index> sensorPlaces(Quantity quantity)
{
    const auto found = std::find(sensed.begin(), sensed.end(), quantity);
    if (found == sensed.end())
        return {};
    const auto k = static_cast<Eigen::Index>(found - sensed.begin());
    if (quantity == Quantity::current)
        return {firstLag + k};
    return {firstLag + k, firstCorner + 2 * (k - 1), firstCorner + 2 * (k - 1) + 1};
}

SensorResponse sensorOf(const Model& model, Quantity quantity)
{
    SensorResponse sensor;
    const std::array values {&sensor.lag, &sensor.T, &sensor.q};
    const auto places = sensorPlaces(quantity);
    for (std::size_t k = 0; k < places.size(); ++k)
        *values[k] = model.path.parameters[static_cast<std::size_t>(places[k])].value;
    return sensor;
}

Model withoutSensors(Model model)
{
    for (const auto quantity : sensed)
        for (const auto place : sensorPlaces(quantity))
            placed(model, place).value = 0.0;
    return model;
}

void passSensor(std::vector<std::complex<double>>& spectrum, double step, const SensorResponse& sensor)
{
    if (sensor.immediate())
        return;
    for (std::size_t k = 0; k < spectrum.size(); ++k)
        spectrum[k] *= sensor(std::complex<double>(0.0, step * static_cast<double>(k)));
}

std::vector<Parameter> toldOfPath(const Model& model)
{
    auto told = model.path.parameters;
    std::erase_if(told, [&](const Parameter& p) { return !p.free && p.value == 0.0 && std::isfinite(p.prior); });
    return told;
}

}  // namespace excursion
