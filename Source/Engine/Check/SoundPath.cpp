// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Check/SoundPath.h"

#include "Engine/Document/Engineering.h"
#include "Engine/Document/Figures.h"
#include "Engine/Estimate/EstimateFrf.h"
#include "Engine/Numerics/GoldenSection.h"
#include "Engine/Numerics/QrFactors.h"
#include "Engine/Signal/Level.h"
#include "Engine/Take/Motion.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <utility>

namespace excursion {
namespace {

using Complex = std::complex<double>;

constexpr double accurate = 3e-3;  // of a line, beside its noise

struct Port {
    double frequency = 0.0, quality = 0.0;  ///< Hz
};

/// The acceleration of the cone over the sound, on the lines of the low band.
class MotionPerSound {
public:
    void add(double frequency, Complex ratio, double relativeVariance)
    {
        s_.emplace_back(0.0, 2.0 * std::numbers::pi * frequency);
        ratio_.push_back(ratio);
        weight_.push_back(1.0 / (relativeVariance + accurate * accurate));
        sum_ += weight_.back();
        noise_ += weight_.back() * relativeVariance;
    }
    std::size_t lines() const { return s_.size(); }
    double noise() const { return std::sqrt(noise_ / sum_); }
    double lowest() const { return s_.front().imag() / (2.0 * std::numbers::pi); }
    double highest() const { return s_.back().imag() / (2.0 * std::numbers::pi); }

    /// What a cone leaves that is heard so late behind this high-pass, with a port or without.
    double left(double delay, double corner, const std::optional<Port>& port) const
    {
        const auto K = static_cast<Eigen::Index>(s_.size());
        Eigen::MatrixXd A(2 * K, port ? 4 : 2);
        Eigen::VectorXd one = Eigen::VectorXd::Zero(2 * K);
        const double w_c = 2.0 * std::numbers::pi * corner;
        for (Eigen::Index k = 0; k < K; ++k) {
            const auto place = static_cast<std::size_t>(k);
            const Complex s = s_[place], unit = s / std::abs(s_.back());
            const double root = std::sqrt(weight_[place] / sum_);
            const Complex heard = root * s / (s + w_c) * std::exp(-s * delay) * ratio_[place];
            Eigen::Index column = 0;
            const auto put = [&](Complex value) {
                A(k, column) = value.real();
                A(K + k, column++) = value.imag();
            };
            put(heard);
            put(heard * unit * unit);  // modes of the cone
            if (port) {
                const double w_b = 2.0 * std::numbers::pi * port->frequency;
                const Complex flow = heard * w_b * w_b / (s * s + s * w_b / port->quality + w_b * w_b);
                put(flow);
                put(flow * s / w_b);
            }
            one[k] = root;
        }
        return (one - A * pivotedSolveVector(A, one)).norm();
    }

    /// The delay (s) that leaves the least of a cone alone.
    double roughDelay() const
    {
        constexpr double longest = 0.03, perTurn = 12.0;  // 10 m
        double best = 0.0, least = std::numeric_limits<double>::infinity();
        for (double delay = -1.0 / highest(); delay < longest; delay += 1.0 / (perTurn * highest()))
            if (const double l = left(delay, 0.0, std::nullopt); l < least) {
                least = l;
                best = delay;
            }
        return best;
    }

private:
    std::vector<Complex> s_, ratio_;
    std::vector<double> weight_;
    double sum_ = 0.0, noise_ = 0.0;
};

struct Heard {
    double left = 0.0, corner = 0.0;
};

/// The best delay for this corner and port.
double leftAt(const MotionPerSound& sound, double around, double corner, const std::optional<Port>& port)
{
    const double reach = 0.25 / sound.highest();
    const auto left = [&](double delay) { return sound.left(delay, corner, port); };
    return left(goldenSection(around - reach, around + reach, 14, left).least);
}

/// The best corner, too.
Heard bestCorner(const MotionPerSound& sound, double around, const std::optional<Port>& port)
{
    Heard best {leftAt(sound, around, 0.0, port), 0.0};
    const auto left = [&](double logCorner) { return leftAt(sound, around, std::exp(logCorner), port); };
    constexpr double step = 0.5;
    double place = 0.0;
    bool found = false;
    for (double at = std::log(0.003 * sound.lowest()); at < std::log(3.0 * sound.lowest()); at += step)
        if (const double l = left(at); l < best.left) {
            best = {l, std::exp(at)};
            place = at;
            found = true;
        }
    if (found) {
        const double at = goldenSection(place - step, place + step, 20, left).least;
        best = {left(at), std::exp(at)};
    }
    return best;
}

constexpr double leastQuality = 2.0;  // of a port

/// The port near this one whose sound leaves least behind this high-pass.
/// @param reach  of the logarithm of its frequency
Port tuned(const MotionPerSound& sound, double around, double corner, Port port, double reach)
{
    double reach_Q = std::log(2.0);
    constexpr int rounds = 3, steps = 10;
    for (int n = 0; n < rounds; ++n) {
        const auto tuning = [&](double logF) {
            return leftAt(sound, around, corner, Port {std::exp(logF), port.quality});
        };
        const double f = std::log(port.frequency);
        port.frequency = std::exp(goldenSection(f - reach, f + reach, steps, tuning).least);
        const auto damping = [&](double logQ) {
            return leftAt(sound, around, corner, Port {port.frequency, std::exp(logQ)});
        };
        const double Q = std::log(port.quality);
        port.quality = std::exp(
            goldenSection(std::max(Q - reach_Q, std::log(leastQuality)), Q + reach_Q, steps, damping).least);
        reach *= 0.4;
        reach_Q *= 0.4;
    }
    return port;
}

/// A high-pass and a port, each sought with the other: a port that was sought without one takes on what it does.
Heard bestTogether(const MotionPerSound& sound, double around, const Port& alone)
{
    constexpr double reach = 0.1, octave = 2.0;
    constexpr int turns = 4;
    Heard best {leftAt(sound, around, 0.0, alone), 0.0};
    Port port = alone;
    for (double corner = 0.06 * sound.lowest(); corner < 3.0 * sound.lowest(); corner *= octave) {
        const auto beside = tuned(sound, around, corner, alone, reach);
        if (const double left = leftAt(sound, around, corner, beside); left < best.left) {
            best = {left, corner};
            port = beside;
        }
    }
    for (int n = 0; n < turns; ++n) {
        if (n > 0)
            port = tuned(sound, around, best.corner, port, reach);
        if (const auto heard = bestCorner(sound, around, port); heard.left < best.left)
            best = heard;
    }
    return best;
}

/// The port whose sound leaves least without a high-pass.
/// @param around  s, the delay of a cone without a port; then that of one with it
Port bestPort(const MotionPerSound& sound, double& around)
{
    Port best;
    double least = std::numeric_limits<double>::infinity();
    constexpr double step = 1.07, turns = 1.5, turn = 0.15;
    const double rough = around;
    for (double shift = -turns; shift <= turns; shift += turn)
        for (double f = 0.7 * sound.lowest(); f < sound.highest(); f *= step)
            for (const double quality : {leastQuality, 4.0, 8.0, 16.0, 32.0}) {
                const double delay = rough + shift / sound.highest();
                if (const double left = sound.left(delay, 0.0, Port {f, quality}); left < least) {
                    least = left;
                    best = {f, quality};
                    around = delay;
                }
            }
    return tuned(sound, around, 0.0, best, std::log(step));
}

SoundPath pathOf(const MotionPerSound& sound)
{
    double around = sound.roughDelay();
    SoundPath path;
    double straight = 0.0;  // left without a high-pass
    path.noise = sound.noise();
    path.left = straight = leftAt(sound, around, 0.0, std::nullopt);
    // Fewer unknowns come first: what a cone alone explains is neither a microphone's nor a port's.
    constexpr double explains = 0.5;
    const auto explained = [&] { return path.left < std::max(1.5 * path.noise, accurate); };
    if (explained())
        return path;
    if (const auto heard = bestCorner(sound, around, std::nullopt); heard.left < explains * path.left) {
        path.left = heard.left;
        path.rollOff = heard.corner;
    }
    if (explained())
        return path;
    const auto port = bestPort(sound, around);
    if (const double left = leftAt(sound, around, 0.0, port); left < explains * path.left) {
        path.left = straight = left;
        path.rollOff = 0.0;
    }
    // What a port explains nearly may be more than it: it bends where a microphone rolls off.
    constexpr double nearNoise = 1.5, nearly = 2.0, clearlyLess = 0.7;
    if (path.left < nearNoise * path.noise)
        return path;
    const double most = path.left < nearly * accurate ? clearlyLess : explains;
    if (const auto heard = bestTogether(sound, around, port); heard.corner > 0.0 && heard.left < most * path.left) {
        path.left = heard.left;
        path.rollOff = heard.corner;
    }
    // A corner that leaves much is none: it only bends what a room does.
    constexpr double clearly = 0.2;
    if (path.rollOff > 0.0 && !explained() && path.left > clearly * straight) {
        path.rollOff = 0.0;
        path.left = straight;
    }
    return path;
}

}  // namespace

bool SoundPath::isOpen() const
{
    constexpr double much = 0.01;
    return left > std::max(much, 4.0 * noise);
}

std::optional<SoundPath> findSoundPath(const AveragedPeriods& averages, const std::vector<bool>& alive)
{
    const auto& take = averages.take();
    const auto lives = [&](Quantity q) {
        const auto* channel = take.find(q);
        return channel && alive[static_cast<std::size_t>(channel - take.channels.data())];
    };
    const auto input = take.input().quantity;
    if (!take.hasPeriods() || take.excitation->settlePeriods < 1 || !lives(input) || !lives(Quantity::pressure))
        return std::nullopt;
    const auto motion = std::find_if(take.channels.begin(), take.channels.end(),
                                     [&](const Channel& c) { return isMotion(c.quantity) && lives(c.quantity); });
    if (motion == take.channels.end())
        return std::nullopt;
    const int level = take.excitation->loudest();
    const auto heard = estimateFrf(take, Quantity::pressure, input, level),
               seen = estimateFrf(take, motion->quantity, input, level);
    if (heard.noiseVariance.empty() || seen.noiseVariance.empty())
        return std::nullopt;
    const int derivatives = 2 - *integrationsToDisplacement(motion->quantity);
    const auto accelerationAt = [&](std::size_t k) {
        return seen.value[k] * std::pow(Complex(0.0, 2.0 * std::numbers::pi * seen.frequency[k]), derivatives);
    };
    // The cone is the fastest at its resonance.
    const auto speedAt = [&](std::size_t k) { return std::abs(accelerationAt(k)) / seen.frequency[k]; };
    const double lowEnd = 0.25 * seen.frequency.back();
    std::size_t fastest = 0;
    for (std::size_t k = 1; k < seen.value.size() && seen.frequency[k] < lowEnd; ++k)
        if (speedAt(k) > speedAt(fastest))
            fastest = k;
    const double edge = std::min(4.0 * seen.frequency[fastest], lowEnd);
    constexpr double clear = 0.01;  // of the power
    // Long periods have ten thousand lines there; so many tell no less, evenly over the octaves.
    constexpr double most = 400.0;
    const double apart = std::pow(edge / seen.frequency.front(), 1.0 / most);
    double last = 0.0;
    MotionPerSound sound;
    for (std::size_t k = 0; k < seen.value.size() && seen.frequency[k] < edge; ++k) {
        if (seen.frequency[k] < apart * last)
            continue;
        const auto relativeVariance = [&](const Frf& frf) { return frf.noiseVariance[k] / std::norm(frf.value[k]); };
        const double variance = relativeVariance(heard) + relativeVariance(seen);
        if (variance < clear)
            sound.add(last = seen.frequency[k], accelerationAt(k) / heard.value[k], variance);
    }
    constexpr std::size_t fewest = 12;
    if (sound.lines() < fewest)
        return std::nullopt;
    auto path = pathOf(sound);
    path.motion = motion->quantity;
    return path;
}

void checkSoundPath(const AveragedPeriods& averages, const std::vector<bool>& alive, CheckReport& report)
{
    report.sound = findSoundPath(averages, alive);
    const auto& path = report.sound;
    if (!path)
        return;
    auto& problems = report.problems;
    if (path->isOpen()) {
        problems.push_back(
            {"sound-path", Quantity::pressure, decibelsOf(path->left * path->left), "dB", false,
             "The pressure does not follow the cone: beside the " + std::string(name(path->motion)) + ", "
                 + figure(100.0 * path->left)
                 + " % of it come from elsewhere (a room, another source, or a sensor of the motion that rolls off). "
                   "It "
                   "is set aside; to use it, move the microphone to a few centimetres before the cone, or measure in "
                   "the open."});
        return;
    }
    if (path->rollOff > 0.0)
        problems.push_back({"roll-off", Quantity::pressure, path->rollOff, "Hz", false,
                            "The microphone, or its input, rolls off below " + engineering(path->rollOff, "Hz", 3)
                                + " (first order, seen against the motion of the cone); the pressure is corrected by "
                                  "that."});
}

}  // namespace excursion
