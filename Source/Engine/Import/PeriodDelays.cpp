// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Import/PeriodDelays.h"

#include "Engine/Numerics/QrFactors.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace excursion {
namespace {

using Complex = std::complex<double>;
using LineSpectra = std::vector<std::vector<Complex>>;

std::vector<double> angularFrequencies(const PlanPeriods& plan)
{
    std::vector<double> omega;
    for (const int line : plan.lines)
        omega.push_back(2.0 * std::numbers::pi * line / static_cast<double>(plan.length));
    return omega;
}

/// Noise of one line of one period: what the responses of the groups leave, at least 1e-16 of the line's power and the
/// mean of its neighbours, as a few periods tell little about one line.
std::vector<double> smoothed(const std::vector<double>& noise)
{
    constexpr std::ptrdiff_t beside = 8;
    std::vector<double> result(noise.size());
    const auto size = static_cast<std::ptrdiff_t>(noise.size());
    for (std::ptrdiff_t k = 0; k < size; ++k) {
        const auto first = std::max<std::ptrdiff_t>(0, k - beside), end = std::min(size, k + beside + 1);
        double sum = 0.0;
        for (auto j = first; j < end; ++j)
            sum += noise[static_cast<std::size_t>(j)];
        result[static_cast<std::size_t>(k)] = sum / static_cast<double>(end - first);
    }
    return result;
}

/// Slope of the phase of `turned`, weighted; the sign of its sum is taken off first.
struct Slope {
    double delay = 0.0, error = 0.0;
};
Slope phaseSlope(const std::vector<Complex>& turned, const std::vector<double>& weight,
                 const std::vector<double>& omega)
{
    double numerator = 0.0, denominator = 0.0;
    for (std::size_t k = 0; k < turned.size(); ++k)
        if (weight[k] > 0) {
            numerator -= weight[k] * omega[k] * std::arg(turned[k]);
            denominator += weight[k] * omega[k] * omega[k];
        }
    return denominator > 0 ? Slope {numerator / denominator, 1.0 / std::sqrt(denominator)} : Slope {};
}

/// The delay of a response that is a gain and a delay or nearly so, and how much it is one.
void judgeResponse(PeriodDelays& result, const std::vector<double>& power, const std::vector<double>& omega,
                   std::size_t period)
{
    const auto& H = result.response;
    // The highest peak of the impulse response on a grid finer than a sample, then the slope of the phase that is left.
    constexpr int finer = 4, reach = 16;
    double best = 0.0, energy = 0.0, flat = 0.0;
    int at = 0;
    const auto sumAt = [&](double delay) {
        Complex sum = 0.0;
        for (std::size_t k = 0; k < H.size(); ++k)
            sum += power[k] * H[k] * std::polar(1.0, omega[k] * delay);
        return sum.real();
    };
    for (std::size_t k = 0; k < H.size(); ++k) {
        energy += power[k] * std::norm(H[k]);
        flat += power[k];
    }
    for (int step = -finer * reach; step <= finer * reach; ++step)
        if (const double height = std::abs(sumAt(static_cast<double>(step) / finer)); height > best) {
            best = height;
            at = step;
        }
    result.delay = static_cast<double>(at) / finer;
    const double sign = sumAt(result.delay) < 0 ? -1.0 : 1.0;
    std::vector<double> weight(H.size());
    for (std::size_t k = 0; k < H.size(); ++k)
        weight[k] = result.variance[k] > 0 ? 2.0 * std::norm(H[k]) / result.variance[k] : 0.0;
    for (int pass = 0; pass < 3; ++pass) {
        std::vector<Complex> turned(H.size());
        for (std::size_t k = 0; k < H.size(); ++k)
            turned[k] = sign * H[k] * std::polar(1.0, omega[k] * result.delay);
        const auto slope = phaseSlope(turned, weight, omega);
        result.delay += std::clamp(slope.delay, -1.0, 1.0);
        result.delayError = slope.error;
    }
    result.likeness = energy > 0 && flat > 0 ? std::abs(sumAt(result.delay)) / std::sqrt(energy * flat) : 0.0;
    if (result.delay > static_cast<double>(period) / 2)
        result.delay -= static_cast<double>(period);
}

}  // namespace

PeriodDelays periodDelays(const PlanPeriods& plan, std::span<const double> channel,
                          const std::vector<std::size_t>& used, bool byLevel, std::size_t realizations)
{
    const auto omega = angularFrequencies(plan);
    const auto lines = plan.lines.size();
    PeriodDelays result;
    LineSpectra recorded;
    std::size_t groups = 1;
    for (const auto p : used) {
        const auto& period = plan.periods[p];
        recorded.push_back(plan.at(channel.subspan(period.start, plan.length)));
        const auto group = byLevel ? period.block / realizations : 0;
        groups = std::max(groups, group + 1);
        result.periods.push_back(
            {static_cast<double>(period.start) + static_cast<double>(plan.length) / 2, 0.0, 0.0, group});
    }

    LineSpectra response(groups, std::vector<Complex>(lines));
    std::vector<double> noise(lines);
    for (int pass = 0; pass < 4; ++pass) {
        std::vector<std::vector<double>> power(groups, std::vector<double>(lines, 0.0));
        for (auto& values : response)
            std::fill(values.begin(), values.end(), Complex());
        for (std::size_t i = 0; i < used.size(); ++i) {
            const auto& X = plan.played[plan.periods[used[i]].block];
            const auto& period = result.periods[i];
            for (std::size_t k = 0; k < lines; ++k) {
                response[period.group][k] += recorded[i][k] * std::conj(X[k])
                                             * std::polar(1.0, omega[k] * period.delay);
                power[period.group][k] += std::norm(X[k]);
            }
        }
        for (std::size_t g = 0; g < groups; ++g)
            for (std::size_t k = 0; k < lines; ++k)
                if (power[g][k] > 0)
                    response[g][k] /= power[g][k];
        std::fill(noise.begin(), noise.end(), 0.0);
        double strength = 0.0;
        for (std::size_t i = 0; i < used.size(); ++i) {
            const auto& X = plan.played[plan.periods[used[i]].block];
            const auto& period = result.periods[i];
            for (std::size_t k = 0; k < lines; ++k) {
                const auto expected = X[k] * response[period.group][k] * std::polar(1.0, -omega[k] * period.delay);
                noise[k] += std::norm(recorded[i][k] - expected)
                            / static_cast<double>(
                                std::max<std::size_t>(1, used.size() - std::min(groups, used.size() - 1)));
                strength = std::max(strength, std::norm(recorded[i][k]));
            }
        }
        noise = smoothed(noise);
        for (auto& value : noise)
            value = std::max(value, 1e-16 * strength);
        for (std::size_t i = 0; i < used.size(); ++i) {
            const auto& X = plan.played[plan.periods[used[i]].block];
            auto& period = result.periods[i];
            std::vector<Complex> turned(lines);
            std::vector<double> weight(lines);
            for (std::size_t k = 0; k < lines; ++k) {
                const auto expected = X[k] * response[period.group][k] * std::polar(1.0, -omega[k] * period.delay);
                turned[k] = recorded[i][k] * std::conj(expected);
                weight[k] = 2.0 * std::norm(expected) / noise[k];
            }
            const auto slope = phaseSlope(turned, weight, omega);
            period.delay += std::clamp(slope.delay, -2.0, 2.0);
            period.standardError = slope.error;
        }
        // What all periods of a group share belongs to the response.
        for (std::size_t g = 0; g < groups; ++g) {
            double sum = 0.0, weights = 0.0;
            for (const auto& period : result.periods)
                if (period.group == g && period.standardError > 0) {
                    sum += period.delay / (period.standardError * period.standardError);
                    weights += 1.0 / (period.standardError * period.standardError);
                }
            for (auto& period : result.periods)
                if (period.group == g && weights > 0)
                    period.delay -= sum / weights;
        }
    }

    // The response of all: of the last group, which is the loudest, or of the only one.
    const auto last = result.periods.empty() ? 0 : result.periods.back().group;
    result.response = response[last];
    result.variance.assign(lines, 0.0);
    std::vector<double> power(lines, 0.0);
    for (std::size_t i = 0; i < used.size(); ++i)
        if (result.periods[i].group == last)
            for (std::size_t k = 0; k < lines; ++k)
                power[k] += std::norm(plan.played[plan.periods[used[i]].block][k]);
    for (std::size_t k = 0; k < lines; ++k)
        result.variance[k] = power[k] > 0 ? noise[k] / power[k] : 0.0;
    judgeResponse(result, power, omega, plan.length);
    return result;
}

namespace {

struct LineFit {
    double drift = 0.0, driftVariance = 0.0, offset = 0.0, offsetVariance = 0.0, jump = 0.0, jumpVariance = 0.0,
           chiSquare = 0.0;
    int freedom = 0;
};

/// Offsets of the groups, a slope and, with `from` below the number of periods, a step before period `from`.
LineFit fitLine(const std::vector<PeriodDelays::Period>& periods, std::size_t from)
{
    const auto rows = static_cast<Eigen::Index>(periods.size());
    std::size_t groups = 1;
    for (const auto& p : periods)
        groups = std::max(groups, p.group + 1);
    const bool steps = from < periods.size();
    const auto columns = static_cast<Eigen::Index>(groups) + 1 + (steps ? 1 : 0);
    const double scale = std::max(1.0, periods.back().time);
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(rows, columns);
    Eigen::VectorXd b(rows);
    for (Eigen::Index i = 0; i < rows; ++i) {
        const auto& p = periods[static_cast<std::size_t>(i)];
        const double weight = p.standardError > 0 ? 1.0 / p.standardError : 0.0;
        A(i, static_cast<Eigen::Index>(p.group)) = weight;
        A(i, static_cast<Eigen::Index>(groups)) = weight * p.time / scale;
        if (steps && static_cast<std::size_t>(i) >= from)
            A(i, columns - 1) = weight;
        b(i) = weight * p.delay;
    }
    const MinimumNorm system(A);
    const Eigen::VectorXd x = system.solveVector(b);
    const Eigen::MatrixXd inverse = system.pseudoInverse();
    const Eigen::MatrixXd covariance = inverse * inverse.transpose();
    LineFit fit;
    const auto last = static_cast<Eigen::Index>(periods.back().group), slope = static_cast<Eigen::Index>(groups);
    fit.offset = x(last);
    fit.offsetVariance = covariance(last, last);
    fit.drift = x(slope) / scale;
    fit.driftVariance = covariance(slope, slope) / (scale * scale);
    if (steps) {
        fit.jump = x(columns - 1);
        fit.jumpVariance = covariance(columns - 1, columns - 1);
    }
    fit.chiSquare = (A * x - b).squaredNorm();
    fit.freedom = static_cast<int>(rows - system.rank());
    return fit;
}

}  // namespace

ClockFit fitClock(const std::vector<PeriodDelays::Period>& periods)
{
    ClockFit clock;
    if (periods.empty())
        return clock;
    const auto line = fitLine(periods, periods.size());
    const double inflation = line.freedom > 0 ? std::max(1.0, line.chiSquare / line.freedom) : 1.0;
    clock.offset = line.offset;
    clock.offsetError = std::sqrt(line.offsetVariance * inflation);
    clock.drift = line.drift;
    clock.driftError = std::sqrt(line.driftVariance * inflation);
    double weights = 0.0;
    for (const auto& p : periods)
        weights += p.standardError > 0 ? 1.0 / (p.standardError * p.standardError) : 0.0;
    clock.scatter = weights > 0 ? std::sqrt(line.chiSquare / weights) : 0.0;

    // Between two periods, or within one, which is then neither here nor there and left out.
    double least = 0.25;
    for (std::size_t from = 1; from < periods.size(); ++from)
        for (const bool within : {false, true}) {
            auto judged = periods;
            if (within)
                judged.erase(judged.begin() + static_cast<std::ptrdiff_t>(from));
            if (from >= judged.size())
                continue;
            const auto stepped = fitLine(judged, from);
            const auto straight = within ? fitLine(judged, judged.size()) : line;
            if (stepped.freedom < 1 || !(straight.chiSquare > 0))
                continue;
            const double variance = stepped.jumpVariance * std::max(1.0, stepped.chiSquare / stepped.freedom);
            const bool clear = std::abs(stepped.jump) >= 0.15 && stepped.jump * stepped.jump > 36.0 * variance;
            if (clear && stepped.chiSquare < least * straight.chiSquare) {
                least = stepped.chiSquare / straight.chiSquare;
                clock.jump = stepped.jump;
                clock.jumpTime = within ? periods[from].time : (periods[from - 1].time + periods[from].time) / 2;
            }
        }
    return clock;
}

}  // namespace excursion
