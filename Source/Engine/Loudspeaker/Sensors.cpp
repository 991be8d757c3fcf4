// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/Sensors.h"

#include "Engine/Loudspeaker/SensorResponse.h"
#include "Engine/Signal/Fft.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>

namespace excursion {
namespace {

/// A motion as a derivative of the displacement.
struct Order {
    Trace trace;
    int order;  ///< derivatives of the displacement
};

std::optional<Order> motionOf(Quantity quantity)
{
    switch (quantity) {
    case Quantity::displacement: return Order {Trace::displacement, 0};
    case Quantity::velocity: return Order {Trace::velocity, 1};
    case Quantity::acceleration: return Order {Trace::acceleration, 2};
    default: return std::nullopt;
    }
}

std::vector<double> beyond(const std::vector<double>& lateness, double rest)
{
    auto result = lateness;
    for (auto& l : result)
        l -= rest;
    return result;
}

}  // namespace

Sensors::Sensors(const Model& model, const SmallSignal& linear, const Trajectory& run, double sampleRate)
    : model_(model),
      run_(run),
      sampleRate_(sampleRate),
      gain_(radiationPerArea() / model.microphoneDistance),
      restLateness_(linear.lateness),
      later_(linear.lateness - static_cast<double>(run.ahead) / sampleRate),
      spot_(linear.shiftsSpot()),
      arrival_(beyond(run[Trace::lateness], restLateness_), sampleRate)
{
}

std::vector<Trace> Sensors::tracesOf(Quantity quantity) const
{
    const auto first = mainTraceOf(quantity);
    if (quantity == Quantity::pressure)
        return {first, Trace::lateness};
    return spot_ && motionOf(quantity) ? std::vector {first, Trace::spot} : std::vector {first};
}

double Sensors::step() const
{
    return 2.0 * std::numbers::pi * sampleRate_ / static_cast<double>(run_[Trace::current].size());
}

void Sensors::delay(Spectrum& spectrum) const
{
    for (auto& line : spectrum)
        line *= gain_;
    auto sensor = sensorOf(model_, Quantity::pressure);
    sensor.lag = later_;
    passSensor(spectrum, step(), sensor);
}

void Sensors::addSpot(Spectrum& spectrum, std::span<const double> spot, int order) const
{
    const auto shift = fft(spot);
    for (std::size_t k = 0; k < spectrum.size(); ++k) {
        const std::complex<double> s(0.0, step() * static_cast<double>(k));
        spectrum[k] += order == 0 ? shift[k] : order == 1 ? s * shift[k] : s * s * shift[k];
    }
}

Sensors::Spectrum Sensors::seen(Quantity quantity) const
{
    if (quantity == Quantity::pressure) {
        auto spectrum = fft(arrival_.heard(run_[Trace::flow]));
        delay(spectrum);
        return spectrum;
    }
    const auto motion = motionOf(quantity);
    auto spectrum = fft(run_[motion ? motion->trace : Trace::current]);
    if (motion && spot_)
        addSpot(spectrum, run_[Trace::spot], motion->order);
    passSensor(spectrum, step(), sensorOf(model_, quantity));
    return spectrum;
}

Sensors::Spectrum Sensors::slope(Quantity quantity, const Eigen::MatrixXd& slopes)
{
    const auto row = [&](Eigen::Index r) {
        const Eigen::VectorXd values = slopes.row(r).transpose();
        return std::vector<double>(values.begin(), values.end());
    };
    if (quantity == Quantity::pressure) {
        // What arrives at t has left at s, so d(flow) there is that of the flow and that of s: ds = -d(lateness)/(1 +
        // lateness').
        if (flowByLeaving_.empty())
            flowByLeaving_ = slopeByLeaving(run_[Trace::flow], run_[Trace::lateness], sampleRate_);
        auto change = row(0);
        for (std::size_t n = 0; n < change.size(); ++n)
            change[n] -= flowByLeaving_[n] * slopes(1, static_cast<Eigen::Index>(n));
        auto spectrum = fft(arrival_.heard(change));
        delay(spectrum);
        return spectrum;
    }
    auto spectrum = fft(row(0));
    if (const auto motion = motionOf(quantity); motion && spot_)
        addSpot(spectrum, row(1), motion->order);
    passSensor(spectrum, step(), sensorOf(model_, quantity));
    return spectrum;
}

std::vector<double> Sensors::record(Quantity quantity) const
{
    const auto inTime = [this](Spectrum& spectrum) {
        const auto length = run_[Trace::current].size();
        if (length % 2 == 0)
            spectrum.back() = spectrum.back().real();  // the Nyquist line of a real record is real
        return inverseFft(spectrum, length);
    };
    if (quantity == Quantity::pressure) {
        if (later_ == 0.0 && sensorOf(model_, quantity).immediate()) {
            auto samples = arrival_.heard(run_[Trace::flow]);
            std::transform(samples.begin(), samples.end(), samples.begin(),
                           [this](double flow) { return gain_ * flow; });
            return samples;
        }
        auto spectrum = seen(quantity);
        return inTime(spectrum);
    }
    if (!sensorOf(model_, quantity).immediate()) {
        auto spectrum = seen(quantity);
        return inTime(spectrum);
    }
    auto samples = run_[tracesOf(quantity).front()];
    if (const auto motion = motionOf(quantity); motion && spot_) {
        const auto& spot = run_[Trace::spot];
        Spectrum shift(spot.size() / 2 + 1);
        if (motion->order > 0)
            addSpot(shift, spot, motion->order);
        const auto ahead = motion->order > 0 ? inTime(shift) : spot;
        std::transform(samples.begin(), samples.end(), ahead.begin(), samples.begin(), std::plus<> {});
    }
    return samples;
}

Trace mainTraceOf(Quantity quantity)
{
    if (quantity == Quantity::pressure)
        return Trace::flow;
    const auto motion = motionOf(quantity);
    return motion ? motion->trace : Trace::current;
}

std::size_t aheadOf(const Model& model, double sampleRate)
{
    return static_cast<std::size_t>(std::round(std::max(0.0, smallSignal(model).lateness) * sampleRate));
}

}  // namespace excursion
