// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/LawMemory.h"

#include "Engine/Loudspeaker/LawPace.h"
#include "Engine/Loudspeaker/SteadyMemory.h"
#include "Engine/Numerics/RungeKutta.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace excursion {
namespace {

double sizeOf(double value) { return std::abs(value); }
double sizeOf(const Jet& value) { return std::abs(value.a); }

/// dm/dt = a + B m
template <class T>
struct Affine {
    std::size_t size = 0;
    std::vector<T> a, B;  ///< B by columns

    std::vector<T> rate(const std::vector<T>& m) const
    {
        auto result = a;
        for (std::size_t column = 0; column < size; ++column)
            for (std::size_t row = 0; row < size; ++row)
                result[row] += B[column * size + row] * m[column];
        return result;
    }

    T fastest() const
    {
        T most(0.0);
        for (const auto& value : B)
            if (sizeOf(value) > sizeOf(most))
                most = value < 0.0 ? -value : value;
        return most;
    }

    /// m a time later (or earlier), by the fourth-order Runge-Kutta method.
    void advance(std::vector<T>& m, double time) const
    {
        if (time == 0.0)
            return;
        const int steps = static_cast<int>(
            std::clamp(std::ceil(2.0 * sizeOf(fastest()) * std::abs(time)), 1.0, 2000.0));
        RungeKutta<T> method(size);
        for (int n = 0; n < steps; ++n)
            method.step(m, rate(m), time / steps,
                        [&](double, const std::vector<T>& memory, std::vector<T>& out) { out = rate(memory); });
    }
};

template <class T>
Affine<T> meanRate(const Component& component, const std::vector<T>& coefficients, const PeriodicMotion& motion)
{
    Affine<T> result;
    result.size = static_cast<std::size_t>(component.effect->memorySize(component.operatingRange));
    const auto mean = [&](const std::vector<T>& memory) {
        std::vector<T> sum(result.size, T(0.0)), rate(result.size);
        for (std::size_t n = 0; n < motion.i.size(); ++n) {
            Balance<T> unused;
            component.effect->contribute(component.operatingRange, coefficients.data(),
                                         {T(motion.i[n]), T(motion.x[n]), T(motion.v[n])}, memory.data(), rate.data(),
                                         unused);
            for (std::size_t k = 0; k < result.size; ++k)
                sum[k] += rate[k];
        }
        for (auto& value : sum)
            value = value * (1.0 / static_cast<double>(std::max<std::size_t>(motion.i.size(), 1)));
        return sum;
    };
    std::vector<T> memory(result.size, T(0.0));
    result.a = mean(memory);
    for (std::size_t column = 0; column < result.size; ++column) {
        memory[column] = T(1.0);
        const auto there = mean(memory);
        memory[column] = T(0.0);
        for (std::size_t row = 0; row < result.size; ++row)
            result.B.push_back(there[row] - result.a[row]);
    }
    return result;
}

/// Power comes in bursts: they swing a memory about the one that follows the mean rate.
template <class T>
struct Swing {
    std::vector<T> begin, drive;  ///< where the section and where its drive begins
};

/// The swing of a memory near `m` that repeats with the motion, each of its states by itself.
/// @param begun  the sample of the period at which the drive begins
template <class T>
Swing<T> swingOf(const Component& component, const std::vector<T>& coefficients, const PeriodicMotion& motion,
                 std::size_t begun, double sampleRate, const Affine<T>& mean, const std::vector<T>& m)
{
    using std::exp;
    const std::size_t size = m.size(), N = motion.i.size();
    const auto meanRate = mean.rate(m);
    std::vector<T> rate(size);
    const auto swing = [&](std::vector<T> r, std::size_t samples) {
        for (std::size_t n = 0; n < samples; ++n) {
            Balance<T> unused;
            component.effect->contribute(component.operatingRange, coefficients.data(),
                                         {T(motion.i[n]), T(motion.x[n]), T(motion.v[n])}, m.data(), rate.data(),
                                         unused);
            for (std::size_t k = 0; k < size; ++k)
                r[k] += (rate[k] - meanRate[k] + mean.B[k * size + k] * r[k]) * (1.0 / sampleRate);
        }
        return r;
    };
    Swing<T> result;
    result.begin = swing(std::vector<T>(size, T(0.0)), N);
    for (std::size_t k = 0; k < size; ++k) {  // what a period brings is what it forgets
        const T forgets = T(1.0) - exp(mean.B[k * size + k] * (static_cast<double>(N) / sampleRate));
        if (!(forgets > 0.0))  // nothing: it runs away, and no swing repeats
            return {std::vector<T>(size, T(0.0)), std::vector<T>(size, T(0.0))};
        result.begin[k] = result.begin[k] / forgets;
    }
    result.drive = swing(result.begin, begun);
    return result;
}

template <class T>
void add(std::vector<T>& sum, const std::vector<T>& more, double times)
{
    for (std::size_t k = 0; k < sum.size(); ++k)
        sum[k] += more[k] * times;
}

/// The motion without its power.
PeriodicMotion silent(PeriodicMotion motion)
{
    std::fill(motion.i.begin(), motion.i.end(), 0.0);
    return motion;
}

/// The rate at a share of the power: what is slow is moved by that.
template <class T>
Affine<T> between(const Affine<T>& idle, const Affine<T>& whole, double power)
{
    auto result = whole;
    for (const auto part : {&Affine<T>::a, &Affine<T>::B})
        for (std::size_t k = 0; k < (result.*part).size(); ++k)
            (result.*part)[k] = (idle.*part)[k] + ((whole.*part)[k] - (idle.*part)[k]) * power;
    return result;
}

/// By how much the mean of a memory over some time exceeds its value in the middle, which it has at `m`: that bends as
/// d2m/dt2 = B dm/dt, with a mean of that times the time squared over 24.
template <class T>
std::vector<T> bulge(const Affine<T>& mean, const std::vector<T>& m, double timeSquared)
{
    auto bend = mean.rate(m);
    const auto none = std::vector<T>(bend.size(), T(0.0));
    const auto constant = mean.rate(none);
    bend = mean.rate(bend);  // a + B dm/dt
    for (std::size_t k = 0; k < bend.size(); ++k)
        bend[k] = (bend[k] - constant[k]) * (timeSquared / 24.0);
    return bend;
}

/// The memory at the start of every section's drive.
template <class T>
std::vector<std::vector<T>> walk(const Component& component, const std::vector<T>& parameters, const Record& record,
                                 const std::vector<PeriodicMotion>& motions, const std::vector<double>& run)
{
    const auto coefficients = coefficientsOf(component, parameters);
    std::vector<std::size_t> order(record.sections.size());
    std::iota(order.begin(), order.end(), std::size_t {0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return record.sections[a].begin < record.sections[b].begin; });
    std::vector<std::vector<T>> starts(order.size());
    std::vector<T> m(static_cast<std::size_t>(component.effect->memorySize(component.operatingRange)), T(0.0));
    const auto none = std::vector<T>(m.size(), T(0.0));
    for (const auto n : order) {
        const auto& section = record.sections[n];
        const auto mean = meanRate(component, coefficients, motions[n]);
        const auto idle = section.power.empty() ? mean : meanRate(component, coefficients, silent(motions[n]));
        const double window = static_cast<double>(section.window) / record.sampleRate,
                     averaged = 2.0 * (section.end - section.middle),
                     settle = std::max(0.0, section.end - section.begin - averaged);
        Swing<T> swing {none, none};
        if (section.periodic && section.window > 0) {
            const auto N = static_cast<std::ptrdiff_t>(section.window);
            const auto lead = static_cast<std::ptrdiff_t>(std::llround((run[n] - 0.5 * window) * record.sampleRate));
            swing = swingOf(component, coefficients, motions[n], static_cast<std::size_t>(((-lead) % N + N) % N),
                            record.sampleRate, mean, m);
        }
        add(m, swing.begin, -1.0);  // what is left follows the mean rate
        // A part of the section after the other, each with its power.
        const auto count = window > 0.0 ? static_cast<std::size_t>(std::max(1.0, std::round(averaged / window))) : 1;
        const auto settles = section.power.size() > count ? section.power.size() - count : 1;
        const double since = section.middle - section.begin - run[n];  // where the drive begins
        // The lead-in may be longer than what was really played before: so much has to come on top of it.
        starts[n] = m;
        add(starts[n], mean.rate(m), std::min(since, 0.0));
        auto sum = none;
        double time = 0.0;
        for (std::size_t p = 0; p < settles + count; ++p) {
            const double length = p < settles ? settle / static_cast<double>(settles)
                                              : averaged / static_cast<double>(count);
            const auto rate = p < section.power.size() ? between(idle, mean, section.power[p]) : mean;
            if (since >= time && since < time + length) {
                starts[n] = m;
                rate.advance(starts[n], since - time);
            }
            rate.advance(m, 0.5 * length);
            if (p >= settles) {
                add(sum, m, 1.0 / static_cast<double>(count));
                add(sum, bulge(rate, m, length * length), 1.0 / static_cast<double>(count));
            }
            rate.advance(m, 0.5 * length);
            time += length;
        }
        // From the mean back, as far as errors do not grow too much; farther back, a start is forgotten anyway.
        constexpr double near = 2.0, far = 3.0;  // time constants
        if (const T beyond = mean.fastest() * run[n] - near; section.periodic && beyond < far - near) {
            const T share = beyond > 0.0 ? T(1.0) - beyond * (1.0 / (far - near)) : T(1.0);
            add(sum, bulge(mean, sum, window * window), -1.0);
            mean.advance(sum, -run[n]);
            for (std::size_t k = 0; k < m.size(); ++k)
                starts[n][k] = starts[n][k] * (T(1.0) - share) + sum[k] * share;
        }
        add(starts[n], swing.drive, 1.0);
        add(m, swing.begin, 1.0);
    }
    return starts;
}

/// The steady memory that repeats with a motion of N samples: a period from rest brings 1 - exp(-r T) of it.
template <class Rate>
std::vector<double> settledSteady(const Rate& rate, std::size_t size, std::size_t N, std::size_t begin,
                                  double sampleRate)
{
    SteadyMemory on(rate, std::vector<double>(size, 0.0), begin, 1, sampleRate);
    for (std::size_t n = 0; n < N; ++n)
        on.advance((begin + n) % N);
    auto m = on.memory;
    for (std::size_t k = 0; k < size; ++k)
        m[k] /= -std::expm1(-on.rates[k] * static_cast<double>(N) / sampleRate);
    return m;
}

/// Any memory that repeats: two periods from rest, and then on as each state has come from the first to the second.
/// @param fastest  1/s, of its rates
template <class Rate>
std::vector<double> settledAnyhow(const Rate& rate, std::size_t size, std::size_t N, std::size_t begin,
                                  double sampleRate, double fastest)
{
    // Where the memory is slow a step takes some samples: the motion is known in its middle then.
    constexpr double share = 0.3;  // of the fastest rate's time
    constexpr std::size_t mostSamples = 4;
    std::size_t samples = 1;
    while (samples < mostSamples && N % (2 * samples) == 0
           && 2.0 * static_cast<double>(samples) * fastest < share * sampleRate)
        samples *= 2;
    const int parts = samples > 1 ? 1 : 2;  // steps a sample
    const auto across = static_cast<double>(samples) / parts;
    const double h = across / sampleRate;
    std::vector<double> m(size, 0.0), k1(size);
    RungeKutta<double> method(size);
    std::vector<double> once;  // after the first period
    for (std::size_t n = 0; n < 2 * N; n += samples) {
        if (n == N)
            once = m;
        for (int part = 0; part < parts; ++part) {
            const double from = static_cast<double>((begin + n) % N) + across * part;
            rate(from, m.data(), k1.data());
            method.step(m, k1, h, [&](double way, const std::vector<double>& memory, std::vector<double>& out) {
                rate(from + across * way, memory.data(), out.data());
            });
        }
    }
    // What a period leaves of a difference, the next one leaves again: where the memory repeats, m = once + q m.
    for (std::size_t k = 0; k < size; ++k)
        if (const double q = (m[k] - once[k]) / once[k]; q >= 0.0 && q < 1.0)
            m[k] = once[k] / (1.0 - q);
    return m;
}

}  // namespace

MemoryStart settledMemory(const Component& component, const PeriodicMotion& motion, std::size_t begin,
                          double sampleRate)
{
    const auto size = static_cast<std::size_t>(component.effect->memorySize(component.operatingRange));
    const auto coefficients = coefficientsOf(component, valuesOf(component));
    const MotionView view {motion.i, motion.x, motion.v};
    const auto rate = [&](double place, const double* memory, double* out) {
        Balance<double> unused;
        component.effect->contribute(component.operatingRange, coefficients.data(), view.at<double>(place), memory, out,
                                     unused);
    };
    const auto pace = paceOf(component, view, 1, sampleRate);
    const auto m = pace.steady ? settledSteady(rate, size, motion.i.size(), begin, sampleRate)
                               : settledAnyhow(rate, size, motion.i.size(), begin, sampleRate, pace.fastest);
    MemoryStart result;
    result.value = Eigen::Map<const Eigen::VectorXd>(m.data(), static_cast<Eigen::Index>(size));
    if (!result.value.allFinite())
        result.value.setZero();
    result.gradient = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(size),
                                            static_cast<Eigen::Index>(component.parameters.size()));
    return result;
}

std::vector<MemoryStart> historyOf(const Component& component, const Record& record,
                                   const std::vector<PeriodicMotion>& motions, const std::vector<double>& run,
                                   bool withGradient)
{
    const auto size = static_cast<Eigen::Index>(component.effect->memorySize(component.operatingRange));
    const auto count = static_cast<Eigen::Index>(component.parameters.size());
    std::vector<MemoryStart> starts(record.sections.size(),
                                    {Eigen::VectorXd::Zero(size), Eigen::MatrixXd::Zero(size, count)});
    if (!withGradient) {
        const auto values = walk(component, valuesOf(component), record, motions, run);
        for (std::size_t n = 0; n < starts.size(); ++n)
            starts[n].value = Eigen::Map<const Eigen::VectorXd>(values[n].data(), size);
        return starts;
    }
    for (Eigen::Index first = 0; first < count; first += jetWidth) {
        auto parameters = valuesOf<Jet>(component);
        for (Eigen::Index k = first; k < std::min<Eigen::Index>(count, first + jetWidth); ++k)
            parameters[static_cast<std::size_t>(k)].v[k - first] = 1.0;
        const auto values = walk(component, parameters, record, motions, run);
        for (std::size_t n = 0; n < starts.size(); ++n)
            for (Eigen::Index row = 0; row < size; ++row) {
                const auto& value = values[n][static_cast<std::size_t>(row)];
                starts[n].value[row] = value.a;
                for (Eigen::Index k = first; k < std::min<Eigen::Index>(count, first + jetWidth); ++k)
                    starts[n].gradient(row, k) = value.v[k - first];
            }
    }
    return starts;
}

}  // namespace excursion
