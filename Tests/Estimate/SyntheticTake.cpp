// SPDX-License-Identifier: GPL-3.0-or-later
#include "Estimate/SyntheticTake.h"

#include "Engine/Signal/Fft.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace excursion::synthetic {
namespace {

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;

std::vector<double> multisine(const Plan& plan, const std::vector<int>& lines, double level, std::mt19937_64& random)
{
    std::uniform_real_distribution<double> phase(0.0, 2.0 * pi);
    std::vector<Complex> U(static_cast<std::size_t>(plan.period / 2 + 1), 0.0);
    for (const int k : lines)
        U[static_cast<std::size_t>(k)] = std::polar(plan.pink ? 1.0 / std::sqrt(k) : 1.0, phase(random));
    auto u = inverseFft(U, static_cast<std::size_t>(plan.period));
    const double scale = level / rms(u);
    for (auto& value : u)
        value *= scale;
    return u;
}

struct Response {
    std::vector<Complex> I, X;
};

/// Linear response to the terminal voltage U and a force F on the cone.
Response respond(const Loudspeaker& driver, const Plan& plan, const std::vector<Complex>& U,
                 const std::vector<Complex>& F)
{
    Response out {std::vector<Complex>(U.size(), 0.0), std::vector<Complex>(U.size(), 0.0)};
    for (std::size_t k = 0; k < U.size(); ++k) {
        // A hair above DC keeps the logarithm of creep finite.
        const Complex s(0.0, 2.0 * pi * std::max(static_cast<double>(k), 1e-3) * plan.sampleRate / plan.period);
        const Complex Ze = driver.blockedImpedance(s), Zm = driver.mechanicalImpedance(s);
        if (plan.force) {
            out.X[k] = (U[k] + F[k]) / Zm;
            continue;
        }
        out.X[k] = (driver.Bl * U[k] / Ze + F[k]) / (Zm + driver.Bl * driver.Bl * s / Ze);
        out.I[k] = (U[k] - driver.Bl * s * out.X[k]) / Ze;
    }
    // The real DFT has no phase on its first and last line.
    for (auto* spectrum : {&out.I, &out.X}) {
        spectrum->front() = spectrum->front().real();
        spectrum->back() = spectrum->back().real();
    }
    return out;
}

std::vector<Complex> differentiated(const std::vector<Complex>& X, const Plan& plan)
{
    std::vector<Complex> V(X);
    for (std::size_t k = 0; k < V.size(); ++k)
        V[k] *= Complex(0.0, 2.0 * pi * static_cast<double>(k) * plan.sampleRate / plan.period);
    V.back() = V.back().real();
    return V;
}

Response steadyState(const Loudspeaker& driver, const Plan& plan, const std::vector<Complex>& U)
{
    const auto N = static_cast<std::size_t>(plan.period);
    const std::vector<Complex> none(U.size(), 0.0);
    auto response = respond(driver, plan, U, none);
    const bool linear = driver.evenStiffness == 0.0 && driver.oddStiffness == 0.0 && driver.evenForce == 0.0
                        && driver.oddForce == 0.0;
    for (int iteration = 0; iteration < 6 && !linear; ++iteration) {
        const auto x = inverseFft(response.X, N), i = inverseFft(response.I, N);
        const auto v = inverseFft(differentiated(response.X, plan), N);
        std::vector<double> force(N), voltage(N);
        for (std::size_t n = 0; n < N; ++n) {
            const double d = x[n] / driver.xReference;
            const double dBl = -driver.Bl * (driver.evenForce * d + driver.oddForce * d * d);
            force[n] = dBl * i[n] - driver.k * (driver.evenStiffness * d + driver.oddStiffness * d * d) * x[n];
            voltage[n] = dBl * v[n];
        }
        auto left = fft(voltage);
        for (std::size_t k = 0; k < left.size(); ++k)
            left[k] = U[k] - left[k];
        response = respond(driver, plan, plan.force ? U : left, fft(force));
    }
    return response;
}

std::vector<double> channelSamples(Quantity quantity, const Loudspeaker& driver, const Plan& plan,
                                   const std::vector<double>& u, const Response& response)
{
    const auto N = static_cast<std::size_t>(plan.period);
    switch (quantity) {
    case Quantity::current: return inverseFft(response.I, N);
    case Quantity::displacement: return inverseFft(response.X, N);
    case Quantity::velocity: return inverseFft(differentiated(response.X, plan), N);
    case Quantity::acceleration: return inverseFft(differentiated(differentiated(response.X, plan), plan), N);
    case Quantity::pressure: {
        auto P = differentiated(differentiated(response.X, plan), plan);
        for (std::size_t k = 0; k < P.size(); ++k)
            P[k] *= 8e-3
                    * std::polar(1.0, -2.0 * pi * static_cast<double>(k) * plan.sampleRate / plan.period
                                          * driver.microphoneDelay);
        P.back() = P.back().real();
        return inverseFft(P, N);
    }
    default: return u;
    }
}

}  // namespace

double Loudspeaker::resonance() const { return std::sqrt(k / m); }

Complex Loudspeaker::blockedImpedance(Complex s) const
{
    return R + L * s + (semiK > 0.0 ? semiK * std::pow(s, semiExponent) : Complex(0.0));
}

Complex Loudspeaker::mechanicalImpedance(Complex s) const
{
    return m * s * s + r * s + k / (1.0 + creep * std::log(resonance() / s) / std::log(10.0));
}

Complex Loudspeaker::impedance(Complex s) const { return blockedImpedance(s) + Bl * Bl * s / mechanicalImpedance(s); }

Complex Loudspeaker::displacementPerVoltage(Complex s) const { return Bl / mechanicalImpedance(s) / impedance(s); }

double rms(const std::vector<double>& x)
{
    double sum = 0.0;
    for (const double value : x)
        sum += value * value;
    return std::sqrt(sum / static_cast<double>(x.size()));
}

void addNoise(std::vector<double>& samples, double noiseRms, std::mt19937_64& random)
{
    std::normal_distribution<double> gauss(0.0, noiseRms);
    for (auto& value : samples)
        value += gauss(random);
}

std::vector<double> delayed(const std::vector<double>& x, double offset, double slope)
{
    constexpr int reach = 24;
    std::vector<double> y(x.size(), 0.0);
    for (std::size_t n = 0; n < x.size(); ++n) {
        const double at = static_cast<double>(n) - offset - slope * static_cast<double>(n);
        const auto centre = static_cast<long>(std::floor(at));
        for (long j = centre - reach + 1; j <= centre + reach; ++j) {
            if (j < 0 || j >= static_cast<long>(x.size()))
                continue;
            const double t = at - static_cast<double>(j);
            const double sinc = std::abs(t) < 1e-12 ? 1.0 : std::sin(pi * t) / (pi * t);
            const double window = std::cos(pi * t / (2.0 * reach));
            y[n] += x[static_cast<std::size_t>(j)] * sinc * window * window;
        }
    }
    return y;
}

std::vector<int> oddRandomLines(const Plan& plan, std::mt19937_64& random)
{
    std::vector<int> lines;
    const double spacing = plan.sampleRate / plan.period;
    const int first = static_cast<int>(std::ceil(plan.bandLow / spacing)) | 1;
    const int last = std::min(static_cast<int>(plan.bandHigh / spacing), plan.period / 2 - 1);
    std::uniform_int_distribution<int> member(0, 3);
    for (int group = first; group <= last; group += 8) {
        const int leftOut = group == first ? 3 : member(random);
        for (int i = 0; i < 4; ++i)
            if ((plan.everyOdd || i != leftOut) && group + 2 * i <= last)
                lines.push_back(group + 2 * i);
    }
    return lines;
}

Measurement record(const Loudspeaker& driver, const Plan& plan, std::mt19937_64& random)
{
    Measurement take;
    take.sampleRate = plan.sampleRate;
    Excitation e;
    e.period = plan.period;
    e.settlePeriods = plan.settlePeriods;
    e.periods = plan.periods;
    e.realizations = plan.realizations;
    e.levels = plan.levels;
    e.grid = plan.everyOdd ? "odd" : "odd-random";
    e.shape = plan.pink ? "pink" : "white";
    e.bandLow = plan.bandLow;
    e.bandHigh = plan.bandHigh;
    e.lines = oddRandomLines(plan, random);
    take.excitation = e;

    std::vector<Quantity> held {plan.force ? Quantity::force : Quantity::voltage};
    held.insert(held.end(), plan.outputs.begin(), plan.outputs.end());
    for (const auto quantity : held)
        take.channels.push_back({quantity, std::string(siUnit(quantity)), 1.0, {}});

    for (const double level : plan.levels)
        for (int realization = 0; realization < plan.realizations; ++realization) {
            const auto u = multisine(plan, e.lines, level, random);
            const auto response = steadyState(driver, plan, fft(u));
            for (auto& channel : take.channels) {
                const auto period = channelSamples(channel.quantity, driver, plan, u, response);
                for (int p = 0; p < e.periodsPerRealization(); ++p)
                    channel.samples.insert(channel.samples.end(), period.begin(), period.end());
            }
        }
    for (auto& channel : take.channels) {
        // The recorder is stopped a little late, so that a shifted record does not end in silence.
        const std::vector<double> tail(channel.samples.end() - e.period, channel.samples.end() - e.period / 2);
        channel.samples.insert(channel.samples.end(), tail.begin(), tail.end());
        const auto loudest = static_cast<std::ptrdiff_t>(e.samplesPerRealization()) * e.realizations;
        const double loud = rms({channel.samples.end() - loudest, channel.samples.end()});
        addNoise(channel.samples, loud * std::pow(10.0, plan.noiseDb / 20.0), random);
        for (const double value : channel.samples)
            channel.fullScale = std::max(channel.fullScale, 1.2 * std::abs(value));
    }
    return take;
}

}  // namespace excursion::synthetic
