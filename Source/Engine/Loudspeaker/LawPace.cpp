// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/LawPace.h"

#include <algorithm>
#include <cmath>

namespace excursion {

Pace paceOf(const Component& law, const MotionView& motion, std::size_t perSample, double sampleRate)
{
    const auto size = static_cast<std::size_t>(law.effect->memorySize(law.operatingRange));
    if (size == 0)
        return {};
    const auto coefficients = coefficientsOf(law, valuesOf(law));
    std::vector<double> memory(size, 0.0), rest(size), moved(size), sum(size, 0.0), first;
    double fastest = 0.0, asked = 0.0;
    bool steady = true;
    constexpr std::size_t closest = 8, places = 400;  // enough to meet the fastest rate of a motion nearly
    const std::size_t apart = std::max(closest, motion.i.size() / (places * perSample)) * perSample;
    constexpr double same = 1e-9;
    for (std::size_t n = 0; n < motion.i.size(); n += apart, asked += 1.0) {
        const auto rates = [&](std::vector<double>& out) {
            Balance<double> unused;
            law.effect->contribute(law.operatingRange, coefficients.data(), {motion.i[n], motion.x[n], motion.v[n]},
                                   memory.data(), out.data(), unused);
        };
        rates(rest);
        for (std::size_t k = 0; k < size; ++k) {
            const double held = n % (2 * apart) == 0 ? 1.0 : 2.0;  // a rate that is not affine tells them apart
            memory[k] = held;
            rates(moved);
            memory[k] = 0.0;
            const double rate = std::abs(moved[k] - rest[k]) / held;
            fastest = std::max(fastest, rate);
            sum[k] += rate;
            if (first.size() < size)
                first.push_back(rate);
            steady = steady && moved[k] < rest[k] && std::abs(rate - first[k]) <= same * first[k];
            for (std::size_t other = 0; other < size && steady; ++other)
                steady = other == k || std::abs(moved[other] - rest[other]) <= same * std::abs(rest[other]);
        }
    }
    constexpr double most = 32.0, forgotten = 7.0;  // exp(-7): a thousandth
    const double quarter = static_cast<double>(motion.i.size()) / (static_cast<double>(perSample) * 4.0 * sampleRate);
    const double slowest = *std::min_element(sum.begin(), sum.end()) / asked;
    return {static_cast<int>(std::clamp(std::ceil(fastest / sampleRate), 1.0, most)), slowest * quarter > forgotten,
            steady, slowest, fastest};
}

Pace paceOf(const Component& law, double sampleRate)
{
    const auto& e = law.operatingRange;
    constexpr int length = 256;
    std::vector<double> i, x, v;
    for (int n = 0; n < length; ++n) {  // three frequencies that do not belong together
        i.push_back(e.current * std::sin(0.61 * n));
        x.push_back(e.displacement * std::sin(0.17 * n));
        v.push_back(e.velocity * std::sin(0.37 * n));
    }
    return paceOf(law, {i, x, v}, 1, sampleRate);
}

}  // namespace excursion
