// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Driver/LawDrive.h"

#include "Engine/Signal/Fft.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

constexpr std::size_t fine = ShownMotion::fine;   // a law is asked once a sample, and its memory in between; a record's rate leaves room for products

template <class T>
struct Asked {
    std::vector<T> voltage, force, lateness;   // one value a sample
};

/// Steps a sample in which a law's memory can be followed: its fastest rate along the motion times the step stays below one.
int stepsFor(const Component& law, const ShownMotion& motion, double sampleRate)
{
    const auto size = static_cast<std::size_t>(law.effect->memorySize(law.extent));
    const auto coefficients = coefficientsOf(law, valuesOf(law));
    std::vector<double> memory(size, 0.0), rest(size), moved(size);
    double fastest = 0.0;
    for (std::size_t n = 0; n < motion.i.size(); n += 2 * fine) {
        const auto rates = [&](std::vector<double>& out) {
            Balance<double> unused;
            law.effect->contribute(law.extent, coefficients.data(), {motion.i[n], motion.x[n], motion.v[n]}, memory.data(), out.data(), unused);
        };
        rates(rest);
        for (std::size_t k = 0; k < size; ++k) {
            memory[k] = 1.0;
            rates(moved);
            memory[k] = 0.0;
            fastest = std::max(fastest, std::abs(moved[k] - rest[k]));
        }
    }
    constexpr double most = 32.0;
    return static_cast<int>(std::clamp(std::ceil(fastest / sampleRate), 1.0, most));
}

template <class T>
Asked<T> ask(const Component& law, const std::vector<T>& parameters, const ShownMotion& motion, std::vector<T> memory, int steps, double sampleRate)
{
    const auto coefficients = coefficientsOf(law, parameters);
    const std::size_t length = motion.i.size(), size = memory.size();
    const double h = 1.0 / (steps * sampleRate);
    const bool heard = law.effect->emits();
    std::vector<T> rate(size), stage(size), k2(size), k3(size), k4(size);
    const auto at = [&](std::size_t n, double share) -> Motion<T> {   // of the way from there to the next value
        const std::size_t next = (n + 1) % length;
        const auto between = [&](const std::vector<double>& q) { return T(q[n] + share * (q[next] - q[n])); };
        return {between(motion.i), between(motion.x), between(motion.v)};
    };
    const auto contribute = [&](std::size_t n, double later, const std::vector<T>& held, std::vector<T>& out) {   // later: values
        const auto whole = static_cast<std::size_t>(later);
        Balance<T> sum;
        law.effect->contribute(law.extent, coefficients.data(), at((n + whole) % length, later - static_cast<double>(whole)), held.data(), out.data(), sum);
        return sum;
    };
    const auto moved = [&](const std::vector<T>& by, double time) -> const std::vector<T>& {
        for (std::size_t k = 0; k < size; ++k)
            stage[k] = memory[k] + time * by[k];
        return stage;
    };
    Asked<T> asked;
    asked.voltage.reserve(length / fine);
    asked.force.reserve(length / fine);
    const std::size_t leadIn = size > 0 ? length / fine / 4 * fine : 0;
    for (std::size_t step = 0; step < leadIn + length; step += fine) {
        const std::size_t n = (length - leadIn + step) % length;
        const auto sum = contribute(n, 0.0, memory, rate);
        if (step >= leadIn) {
            asked.voltage.push_back(sum.drop + sum.fluxSlope * motion.v[n] + sum.inductance * motion.slope[n]);
            asked.force.push_back(sum.force - sum.mass * motion.a[n]);
            if (heard) {
                Emission<T> emission;
                law.effect->emit(law.extent, coefficients.data(), at(n, 0.0), T(motion.a[n]), memory.data(), rate.data(), emission);
                asked.lateness.push_back(emission.lateness);
            }
        }
        if (size == 0)
            continue;
        for (int part = 0; part < steps; ++part) {
            const double begin = static_cast<double>(fine) * part / steps, half = 0.5 * static_cast<double>(fine) / steps;
            if (part > 0)
                contribute(n, begin, memory, rate);
            contribute(n, begin + half, moved(rate, 0.5 * h), k2);
            contribute(n, begin + half, moved(k2, 0.5 * h), k3);
            contribute(n, begin + 2.0 * half, moved(k3, h), k4);
            for (std::size_t k = 0; k < size; ++k)
                memory[k] += (h / 6.0) * (rate[k] + 2.0 * (k2[k] + k3[k]) + k4[k]);
        }
    }
    return asked;
}

template <class T, class Read>
std::vector<double> series(const std::vector<T>& samples, const Read& read)
{
    std::vector<double> result(samples.size());
    std::transform(samples.begin(), samples.end(), result.begin(), read);
    return result;
}

} // namespace

LawDrive driveOf(const Component& law, const ShownMotion& motion, const MemoryStart& start, double sampleRate, const std::vector<bool>& wanted)
{
    const auto count = law.parameters.size();
    const auto size = static_cast<std::size_t>(start.value.size());
    const int steps = size > 0 ? stepsFor(law, motion, sampleRate) : 1;
    LawDrive drive;
    const auto plain = ask<double>(law, valuesOf(law), motion, {start.value.begin(), start.value.end()}, steps, sampleRate);
    drive.voltage = fft(plain.voltage);
    drive.force = fft(plain.force);
    drive.lateness = plain.lateness;
    if (std::none_of(wanted.begin(), wanted.end(), [](bool w) { return w; }))
        return drive;
    drive.voltageSlopes.resize(count);
    drive.forceSlopes.resize(count);
    drive.latenessSlopes.resize(count);
    std::vector<std::size_t> own;   // of a chunk
    const auto differentiate = [&] {
        auto parameters = valuesOf<Jet>(law);
        std::vector<Jet> memory(size);
        for (std::size_t m = 0; m < size; ++m)
            memory[m] = Jet(start.value[static_cast<Eigen::Index>(m)]);
        for (std::size_t j = 0; j < own.size(); ++j) {
            const auto slot = static_cast<Eigen::Index>(j);
            parameters[own[j]].v[slot] = 1.0;
            for (std::size_t m = 0; m < size; ++m)
                memory[m].v[slot] = start.gradient(static_cast<Eigen::Index>(m), static_cast<Eigen::Index>(own[j]));
        }
        const auto jets = ask<Jet>(law, parameters, motion, memory, steps, sampleRate);
        for (std::size_t j = 0; j < own.size(); ++j) {
            const auto slope = [slot = static_cast<Eigen::Index>(j)](const Jet& value) { return value.v[slot]; };
            drive.voltageSlopes[own[j]] = fft(series(jets.voltage, slope));
            drive.forceSlopes[own[j]] = fft(series(jets.force, slope));
            drive.latenessSlopes[own[j]] = series(jets.lateness, slope);
        }
        own.clear();
    };
    for (std::size_t k = 0; k < count; ++k) {
        if (wanted[k])
            own.push_back(k);
        if (own.size() == static_cast<std::size_t>(jetWidth) || (k + 1 == count && !own.empty()))
            differentiate();
    }
    return drive;
}

} // namespace excursion
