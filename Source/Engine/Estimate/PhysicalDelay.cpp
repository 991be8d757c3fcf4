// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Estimate/PhysicalDelay.h"

#include "Engine/Estimate/DelayFit.h"
#include "Engine/Numerics/Median.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>

namespace excursion {
namespace {

using Complex = std::complex<double>;
using Basis = std::vector<std::function<Complex(Complex)>>;

/// The longest delay looked for: half a second of sound in air is not a latency.
constexpr double longestDelay = 5e-3;
constexpr std::size_t mostLines = 300;

struct Line {
    double omega;
    Complex response;
    double variance;
};

/// The reciprocal of the FRF times `power` of s, on the lines whose noise is small enough to judge a phase.
std::vector<Line> reciprocalLines(const Frf& frf, int power)
{
    std::vector<Line> lines;
    const auto& variance = frf.totalVariance.empty() ? frf.noiseVariance : frf.totalVariance;
    for (std::size_t i = 0; i < frf.value.size(); ++i) {
        // Few realizations scatter little by chance now and then: take a neighbour's variance if it is larger.
        double v = 0.0;
        for (std::size_t j = i > 2 ? i - 2 : 0; j < std::min(variance.size(), i + 3); ++j)
            v = std::max(v, variance[j]);
        if (!frf.noiseVariance.empty())
            v = std::max(v, frf.noiseVariance[i]);
        const double magnitude = std::norm(frf.value[i]);
        if (!(magnitude > 0.0) || v > 0.04 * magnitude)
            continue;
        const Complex s(0.0, 2.0 * std::numbers::pi * frf.frequency[i]);
        const Complex Q = std::pow(s, power) / frf.value[i];
        lines.push_back({s.imag(), Q, std::norm(Q) * v / magnitude});
    }
    return lines;
}

std::vector<Line> band(const std::vector<Line>& lines, double low, double high)
{
    std::vector<Line> inside;
    for (const auto& line : lines)
        if (line.omega >= low && line.omega <= high)
            inside.push_back(line);
    if (inside.size() <= mostLines)
        return inside;
    std::vector<Line> fewer;
    for (std::size_t i = 0; i < mostLines; ++i)
        fewer.push_back(inside[i * inside.size() / mostLines]);
    return fewer;
}

DelayFit fitLines(const std::vector<Line>& lines, const Basis& basis)
{
    DelayFitProblem problem;
    const auto F = static_cast<Eigen::Index>(lines.size());
    problem.omega.resize(F);
    problem.response.resize(F);
    problem.variance.resize(F);
    problem.basis.resize(F, static_cast<Eigen::Index>(basis.size()));
    for (Eigen::Index i = 0; i < F; ++i) {
        const auto& line = lines[static_cast<std::size_t>(i)];
        problem.omega[i] = line.omega;
        problem.response[i] = line.response;
        problem.variance[i] = line.variance;
        for (std::size_t j = 0; j < basis.size(); ++j)
            problem.basis(i, static_cast<Eigen::Index>(j)) = basis[j](Complex(0.0, line.omega));
    }
    return fitDelay(problem, longestDelay);
}

std::function<Complex(Complex)> power(double exponent)
{
    return [exponent](Complex s) { return std::pow(s, exponent); };
}

double decibels(double ratio) { return 20.0 * std::log10(ratio); }

/// A delay that turns phases all round leaves nothing in place without it, and next to nothing out of place with it; a
/// mode of the cone or a part that swings on it is only bent to look like one.
constexpr double roundFrom = 2.0, roundFall = 10.0;  // rad, dB

struct Thresholds {
    double radians;  ///< phase that the delay turns at the top of the band
    double fall;     ///< dB that the relative error falls
};

/// The verdict over several models of the same lines: all that fit well must agree.
PhysicalDelay judge(const std::vector<DelayFit>& fits, double highestOmega, const Thresholds& thresholds)
{
    const auto best = *std::min_element(fits.begin(), fits.end(),
                                        [](const auto& a, const auto& b) { return a.relativeError < b.relativeError; });
    double without = 1.0;
    bool agree = true;
    for (const auto& fit : fits) {
        without = std::min(without, fit.relativeErrorWithout);
        if (fit.relativeError < 2.0 * best.relativeError)
            agree = agree
                    && std::abs(fit.seconds - best.seconds) < 0.15 * std::abs(best.seconds) + 5.0 * fit.standardError;
    }
    PhysicalDelay verdict;
    verdict.seconds = best.seconds;
    verdict.standardError = best.standardError;
    const double turned = std::abs(best.seconds) * highestOmega,
                 fall = std::max(thresholds.fall, turned > roundFrom ? roundFall : 0.0);
    verdict.conclusive = best.relativeError < 0.3;
    verdict.clear = verdict.conclusive && agree && turned > thresholds.radians
                    && std::abs(best.seconds) > 5.0 * best.standardError
                    && decibels(without / std::max(best.relativeError, 1e-300)) > fall;
    return verdict;
}

/// Lines whose response, less a clear delay, points against the physics.
bool mostlyNegative(const std::vector<Line>& lines, const PhysicalDelay& delay,
                    const std::function<double(Complex s, Complex Q)>& mustBePositive)
{
    std::size_t negative = 0;
    for (const auto& line : lines) {
        const Complex s(0.0, line.omega);
        const Complex Q = delay.clear ? line.response * std::exp(-s * delay.seconds) : line.response;
        negative += mustBePositive(s, Q) < 0.0;
    }
    return static_cast<double>(negative) > 0.9 * static_cast<double>(lines.size());
}

/// Above the peak of |Z|: the line after which |Z| falls the most. The first line when there is no peak.
double impedancePeak(const std::vector<Line>& lines)
{
    double lowestLater = std::abs(lines.back().response), deepest = 1.05, peak = 0.0;
    for (auto line = lines.rbegin(); line != lines.rend(); ++line) {
        const double magnitude = std::abs(line->response);
        lowestLater = std::min(lowestLater, magnitude);
        if (magnitude / lowestLater > deepest) {
            deepest = magnitude / lowestLater;
            peak = line->omega;
        }
    }
    return peak;
}

/// Where breakup starts, or the lines end: |Q| / (w^2 - w0^2) leaves its plateau by 2 dB.
double plateauEnd(const std::vector<Line>& lines, double resonance)
{
    std::vector<double> mass, reference;
    for (const auto& line : lines) {
        mass.push_back(std::abs(line.response) / (line.omega * line.omega - resonance * resonance));
        if (line.omega > 2.0 * resonance && line.omega < 4.0 * resonance)
            reference.push_back(mass.back());
    }
    if (reference.size() < 3)
        return lines.back().omega;
    const double plateau = medianOf(reference);
    for (std::size_t i = 0; i + 2 < lines.size(); ++i) {
        if (lines[i].omega < 2.0 * resonance)
            continue;
        // A median of three, because one noisy line is not breakup.
        std::array three {mass[i], mass[i + 1], mass[i + 2]};
        std::sort(three.begin(), three.end());
        if (std::abs(decibels(three[1] / plateau)) > 2.0)
            return lines[i].omega;
    }
    return lines.back().omega;
}

/// The delay beside the corner of a sensor, if it has one: over all lines the polynomial of the motion times
/// 1 + q T s + T^2 s^2, which is two more powers of s, leaves little, and far less than it does with a delay alone.
/// Phases by themselves would not tell: a corner of q = sqrt(2) turns them as a delay of q T does, but it takes off the
/// top as well.
std::optional<DelayFit> besideCorner(const std::vector<Line>& lines, Basis basis)
{
    constexpr double far = 0.5, little = 0.05;
    const double late = fitLines(lines, basis).relativeError;
    basis.push_back(power(3));
    basis.push_back(power(4));
    const auto fit = fitLines(lines, basis);
    return fit.relativeError < std::min(far * late, little) ? std::optional(fit) : std::nullopt;
}

}  // namespace

PhysicalDelay currentDelay(const Frf& admittance)
{
    const auto all = reciprocalLines(admittance, 0);
    if (all.size() < 20)
        return {};
    const auto realPart = [](Complex, Complex Z) { return Z.real(); };
    PhysicalDelay undecided;
    undecided.inverted = mostlyNegative(all, undecided, realPart);

    const double peak = impedancePeak(all);
    Basis tail {power(0), power(-1), power(-2), power(-3)};
    Thresholds thresholds {.radians = 0.3, .fall = 3.0};
    auto lines = band(all, 2.5 * peak, all.back().omega);
    if (lines.size() < 16 || lines.back().omega < 3.0 * lines.front().omega) {
        // Little is left above a high resonance: go nearer to it, with one more term and more doubt.
        lines = band(all, 1.7 * peak, all.back().omega);
        tail.push_back(power(-4));
        thresholds.fall = 6.0;
        if (lines.size() < 16 || lines.back().omega < 2.0 * lines.front().omega)
            return undecided;
    }
    std::vector<DelayFit> fits;
    const auto tryModel = [&](std::initializer_list<std::function<Complex(Complex)>> inductive) {
        Basis basis(tail);
        basis.insert(basis.end(), inductive);
        return fitLines(lines, basis);
    };
    const auto better = [](const DelayFit& a, const DelayFit& b) { return a.relativeError < b.relativeError; };
    // A family is represented by its best member with the delay, and without it by its best one too.
    const auto keepBest = [&](std::vector<DelayFit> members) {
        auto best = *std::min_element(members.begin(), members.end(), better);
        for (const auto& member : members)
            best.relativeErrorWithout = std::min(best.relativeErrorWithout, member.relativeErrorWithout);
        fits.push_back(best);
    };

    fits.push_back(tryModel({power(1)}));
    std::vector<DelayFit> semi, mixed, shunted;
    for (double a = 0.4; a < 0.96; a += 0.05) {
        semi.push_back(tryModel({power(a)}));
        mixed.push_back(tryModel({power(1), power(a)}));
    }
    for (double ratio = 0.05; ratio < 1.5; ratio *= 1.6) {
        const double p = ratio * lines.back().omega;
        shunted.push_back(tryModel({power(1), [p](Complex s) { return s / (s + p); }}));
    }
    keepBest(std::move(semi));
    keepBest(std::move(mixed));
    keepBest(std::move(shunted));

    auto verdict = judge(fits, lines.back().omega, thresholds);
    verdict.inverted = mostlyNegative(all, verdict, realPart);
    return verdict;
}

PhysicalDelay motionDelay(const Frf& motion, Quantity quantity, MotionReference drive)
{
    const int derivatives = quantity == Quantity::acceleration ? 2 : quantity == Quantity::velocity ? 1 : 0;
    const auto all = reciprocalLines(motion, derivatives);
    if (all.size() < 8)
        return {};
    // The mechanical impedance |Q|/w is smallest at the resonance, however damped.
    const double resonance = std::min_element(all.begin(), all.end(), [](const Line& a, const Line& b) {
                                 return std::abs(a.response) / a.omega < std::abs(b.response) / b.omega;
                             })->omega;
    const double end = drive == MotionReference::force ? plateauEnd(all, resonance) : all.back().omega;

    auto lines = band(all, 2.0 * resonance, end);
    Basis basis {power(2), power(1), power(0), power(-1), power(-2)};
    if (lines.size() < 12 || lines.back().omega < 2.0 * lines.front().omega) {
        lines = band(all, 0.0, end);
        basis = {power(2), power(1), power(0), [](Complex s) { return std::log(s); }};
        if (lines.size() < 12 || lines.back().omega < 1.3 * resonance)
            return {};
    }
    std::vector<DelayFit> fits;
    if (drive == MotionReference::voltage) {
        basis.push_back(power(3));
        fits.push_back(fitLines(lines, basis));
        basis.push_back(power(2.6));
    }
    fits.push_back(fitLines(lines, basis));
    const auto thresholds = drive == MotionReference::force ? Thresholds {.radians = 0.2, .fall = 4.5}
                                                            : Thresholds {.radians = 1.0, .fall = 6.0};
    auto verdict = judge(fits, lines.back().omega, thresholds);
    // A mode of the cone turns the phase at its own frequency, a delay everywhere.
    bool confirmed = false;
    for (const double share : {0.5, 0.7}) {
        const auto lower = band(lines, 0.0, share * lines.back().omega);
        if (lower.size() < 2 * basis.size())
            continue;
        const auto fit = fitLines(lower, basis);
        verdict.clear = verdict.clear
                        && std::abs(fit.seconds - verdict.seconds)
                               < 0.25 * std::abs(verdict.seconds) + 3.0 * fit.standardError;
        confirmed = confirmed || 3.0 * fit.standardError < 0.5 * std::abs(verdict.seconds);
    }
    verdict.doubtful = verdict.clear && !confirmed
                       && !judge(fits, lines.back().omega, {thresholds.radians, roundFall}).clear;
    verdict.clear = verdict.clear && !verdict.doubtful;
    if (verdict.clear && drive == MotionReference::force) {
        const auto wide = band(all, lines.front().omega, all.back().omega);
        if (const auto beside = besideCorner(wide, basis)) {
            const auto precise = judge({*beside}, wide.back().omega, thresholds);
            verdict.clear = precise.clear;
            verdict.seconds = precise.seconds;
            verdict.standardError = precise.standardError;
        }
    }
    const auto above = band(lines, 1.5 * resonance, end);
    verdict.inverted = verdict.conclusive && above.size() >= 4
                       && mostlyNegative(above, verdict, [](Complex s, Complex Q) { return (Q / (s * s)).real(); });
    return verdict;
}

bool pressureIsInverted(const Frf& pressure, Quantity motion)
{
    const int derivatives = motion == Quantity::acceleration ? 0 : motion == Quantity::velocity ? 1 : 2;
    auto lines = reciprocalLines(pressure, derivatives);  // acceleration / pressure
    if (lines.size() < 8)
        return false;
    lines = band(lines, 0.0, 30.0 * lines.front().omega);  // the cone is rigid, if anywhere, down there
    const auto fit = fitLines(lines, {power(0)});
    PhysicalDelay flight;
    flight.seconds = fit.seconds;
    flight.clear = true;
    return fit.relativeError < 0.3 && mostlyNegative(lines, flight, [](Complex, Complex Q) { return Q.real(); });
}

}  // namespace excursion
