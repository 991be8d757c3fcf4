// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/LawMemory.h"

#include "Engine/Numerics/RungeKutta.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace excursion {
namespace {

double rateOf(double value) { return std::abs(value); }
double rateOf(const Jet& value) { return std::abs(value.a); }

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

    double fastest() const
    {
        double most = 0.0;
        for (const auto& value : B)
            most = std::max(most, rateOf(value));
        return most;
    }

    /// m a time later (or earlier), by the fourth-order Runge-Kutta method.
    void advance(std::vector<T>& m, double time) const
    {
        if (time == 0.0)
            return;
        const int steps = static_cast<int>(std::clamp(std::ceil(2.0 * fastest() * std::abs(time)), 1.0, 2000.0));
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

/// What the first samples of a period have brought a memory near `m` beyond as many of the mean: power comes in bursts.
template <class T>
std::vector<T> ripple(const Component& component, const std::vector<T>& coefficients, const PeriodicMotion& motion,
                      std::size_t samples, double sampleRate, const Affine<T>& mean, const std::vector<T>& m)
{
    std::vector<T> sum(m.size(), T(0.0)), rate(m.size());
    for (std::size_t n = 0; n < samples; ++n) {
        Balance<T> unused;
        component.effect->contribute(component.operatingRange, coefficients.data(),
                                     {T(motion.i[n]), T(motion.x[n]), T(motion.v[n])}, m.data(), rate.data(), unused);
        for (std::size_t k = 0; k < m.size(); ++k)
            sum[k] += rate[k];
    }
    const auto meanThere = mean.rate(m);
    for (std::size_t k = 0; k < m.size(); ++k)
        sum[k] = (sum[k] - meanThere[k] * static_cast<double>(samples)) * (1.0 / sampleRate);
    return sum;
}

PeriodicMotion louder(PeriodicMotion motion, double power)
{
    for (double& i : motion.i)
        i *= std::sqrt(power);
    return motion;
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
    for (const auto n : order) {
        const auto& section = record.sections[n];
        const auto mean = meanRate(component, coefficients, motions[n]);
        const auto first = section.settlingPower == 1.0
                               ? mean
                               : meanRate(component, coefficients, louder(motions[n], section.settlingPower));
        const double averaged = 2.0 * (section.end - section.middle),
                     settle = std::max(0.0, section.end - section.begin - averaged);
        const auto later = [&](double time) {  // from the begin of the section
            auto there = m;
            first.advance(there, std::min(time, settle));
            mean.advance(there, std::max(0.0, time - settle));
            return there;
        };
        const double since = section.middle - section.begin - run[n];  // where the drive begins
        if (since >= 0.0) {
            starts[n] = later(since);
        } else {
            // The lead-in is longer than what was really played before: so much has to come on top of it.
            starts[n] = m;
            const auto rate = mean.rate(m);
            for (std::size_t k = 0; k < m.size(); ++k)
                starts[n][k] += since * rate[k];
        }
        // From the middle back, as far as errors do not grow too much; farther back, a start is forgotten anyway.
        constexpr double near = 2.0, far = 3.0;  // time constants
        const double share = section.periodic ? std::clamp(far - run[n] * mean.fastest(), 0.0, far - near) : 0.0;
        if (share > 0.0) {
            auto there = later(section.middle - section.begin);
            const double window = static_cast<double>(section.window) / record.sampleRate;
            const auto more = bulge(mean, there, averaged * averaged - window * window);
            for (std::size_t k = 0; k < m.size(); ++k)
                there[k] += more[k];
            mean.advance(there, -run[n]);
            for (std::size_t k = 0; k < m.size(); ++k)
                starts[n][k] = starts[n][k] * (1.0 - share) + there[k] * share;
        }
        if (section.periodic && section.window > 0) {
            const auto lead = std::llround(run[n] * record.sampleRate - 0.5 * static_cast<double>(section.window));
            const auto N = static_cast<long long>(section.window);
            const auto begun = static_cast<std::size_t>(((-lead) % N + N) % N);  // sample of the period
            const auto more = ripple(component, coefficients, motions[n], begun, record.sampleRate, mean, starts[n]);
            for (std::size_t k = 0; k < m.size(); ++k)
                starts[n][k] += more[k];
        }
        m = later(section.end - section.begin);
    }
    return starts;
}

}  // namespace

MemoryStart settledMemory(const Component& component, const PeriodicMotion& motion, std::size_t begin,
                          double sampleRate)
{
    const auto size = static_cast<std::size_t>(component.effect->memorySize(component.operatingRange));
    const auto coefficients = coefficientsOf(component, valuesOf(component));
    constexpr int parts = 2;  // steps a sample
    const double h = 1.0 / (parts * sampleRate);
    const std::size_t N = motion.i.size();
    std::vector<double> m(size, 0.0), k1(size);
    RungeKutta<double> method(size);
    const auto rate = [&](std::size_t n, double s, const std::vector<double>& memory, std::vector<double>& out) {
        const std::size_t from = (begin + n) % N, to = (from + 1) % N;
        const auto at = [&](const std::vector<double>& q) { return q[from] + s * (q[to] - q[from]); };
        Balance<double> unused;
        component.effect->contribute(component.operatingRange, coefficients.data(),
                                     {at(motion.i), at(motion.x), at(motion.v)}, memory.data(), out.data(), unused);
    };
    std::vector<double> once;  // after the first period
    for (std::size_t n = 0; n < 2 * N; ++n) {
        if (n == N)
            once = m;
        for (int part = 0; part < parts; ++part) {
            const double begun = static_cast<double>(part) / parts;
            rate(n, begun, m, k1);
            method.step(m, k1, h, [&](double share, const std::vector<double>& memory, std::vector<double>& out) {
                rate(n, begun + share / parts, memory, out);
            });
        }
    }
    // What a period leaves of a difference, the next one leaves again: where the memory repeats, m = once + q m.
    for (std::size_t k = 0; k < size; ++k)
        if (const double q = (m[k] - once[k]) / once[k]; q >= 0.0 && q < 1.0)
            m[k] = once[k] / (1.0 - q);
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
