// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Check/SoundPath.h"

#include "Engine/Check/PeriodCheck.h"
#include "Engine/Document/Engineering.h"
#include "Engine/Document/Figures.h"
#include "Engine/Estimate/EstimateFrf.h"
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

/// What the acceleration of the cone is made of, over the sound, on the lines of the low band: the measured one, or
/// what voltage and current tell of it.
class MotionPerSound {
public:
    /// @param parts  the acceleration is a sum of these with real factors
    void add(double frequency, std::vector<Complex> parts, double relativeVariance)
    {
        s_.emplace_back(0.0, 2.0 * std::numbers::pi * frequency);
        parts_.push_back(std::move(parts));
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
        const std::size_t parts = parts_.front().size();
        Eigen::MatrixXd A(2 * K, static_cast<Eigen::Index>(parts * (port ? 3 : 1) + 1));
        Eigen::VectorXd one = Eigen::VectorXd::Zero(2 * K);
        const double w_c = 2.0 * std::numbers::pi * corner;
        for (Eigen::Index k = 0; k < K; ++k) {
            const auto place = static_cast<std::size_t>(k);
            const Complex s = s_[place], unit = s / std::abs(s_.back());
            const double root = std::sqrt(weight_[place] / sum_);
            const Complex path = root * s / (s + w_c) * std::exp(-s * delay);
            Eigen::Index column = 0;
            const auto put = [&](Complex value) {
                A(k, column) = value.real();
                A(K + k, column++) = value.imag();
            };
            put(path * parts_[place].front() * unit * unit);  // modes of the cone
            for (const auto& part : parts_[place]) {
                put(path * part);
                if (!port)
                    continue;
                const double w_b = 2.0 * std::numbers::pi * port->frequency;
                const Complex flow = path * part * w_b * w_b / (s * s + s * w_b / port->quality + w_b * w_b);
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
    std::vector<Complex> s_;
    std::vector<std::vector<Complex>> parts_;
    std::vector<double> weight_;
    double sum_ = 0.0, noise_ = 0.0;
};

/// The least value of a function of one valley between two places, by golden section.
template <typename Function>
double leastBetween(double from, double to, int steps, const Function& f)
{
    constexpr double golden = 0.6180339887498949;
    double a = to - golden * (to - from), b = from + golden * (to - from);
    double fa = f(a), fb = f(b);
    for (int n = 0; n < steps; ++n)
        if (fa < fb) {
            to = std::exchange(b, a);
            fb = fa;
            fa = f(a = to - golden * (to - from));
        } else {
            from = std::exchange(a, b);
            fa = fb;
            fb = f(b = from + golden * (to - from));
        }
    return fa < fb ? a : b;
}

struct Heard {
    double left = 0.0, corner = 0.0;
};

/// The best delay for this corner and port.
double leftAt(const MotionPerSound& sound, double around, double corner, const std::optional<Port>& port)
{
    const double reach = 0.25 / sound.highest();
    const auto left = [&](double delay) { return sound.left(delay, corner, port); };
    return left(leastBetween(around - reach, around + reach, 14, left));
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
        const double at = leastBetween(place - step, place + step, 20, left);
        best = {left(at), std::exp(at)};
    }
    return best;
}

/// The port whose sound leaves least with the corner at 0.
Port bestPort(const MotionPerSound& sound, double around)
{
    Port best;
    double least = std::numeric_limits<double>::infinity();
    constexpr double ratio = 1.07;
    for (double f = 0.7 * sound.lowest(); f < sound.highest(); f *= ratio)
        for (const double quality : {2.0, 4.0, 8.0, 16.0, 32.0})
            if (const double left = leftAt(sound, around, 0.0, Port {f, quality}); left < least) {
                least = left;
                best = {f, quality};
            }
    return best;
}

SoundPath pathOf(const MotionPerSound& sound)
{
    const double around = sound.roughDelay();
    SoundPath path;
    path.noise = sound.noise();
    path.left = leftAt(sound, around, 0.0, std::nullopt);
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
        path.left = left;
        path.rollOff = 0.0;
    }
    if (explained())
        return path;
    if (const auto heard = bestCorner(sound, around, port); heard.left < explains * path.left) {
        path.left = heard.left;
        path.rollOff = heard.corner;
    }
    return path;
}

/// The quietest level at which voltage, current and pressure are clear of their noise.
int quietestClear(const AveragedPeriods& averages)
{
    constexpr double clear = 40.0;  // dB
    const auto& take = averages.take();
    const int loudest = take.excitation->loudest();
    for (int level = 0; level < loudest; ++level) {
        const auto isClear = [&](Quantity q) { return signalToNoise(averages, *take.find(q), level) > clear; };
        if (isClear(Quantity::voltage) && isClear(Quantity::current) && isClear(Quantity::pressure))
            return level;
    }
    return loudest;
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
    if (!take.hasPeriods() || !lives(input) || !lives(Quantity::pressure))
        return std::nullopt;
    const auto motion = std::find_if(take.channels.begin(), take.channels.end(),
                                     [&](const Channel& c) { return isMotion(c.quantity) && lives(c.quantity); });
    const bool seen = motion != take.channels.end();
    if (!seen && (input != Quantity::voltage || !lives(Quantity::current)))
        return std::nullopt;
    // Sound follows a motion whatever the motor does, but only a linear motor tells the motion.
    const int level = seen ? take.excitation->loudest() : quietestClear(averages);
    const auto heard = estimateFrf(take, Quantity::pressure, input, level),
               told = estimateFrf(take, seen ? motion->quantity : Quantity::current, input, level);
    const auto s = [&](std::size_t k) { return Complex(0.0, 2.0 * std::numbers::pi * told.frequency[k]); };
    const auto accelerationFrom = [&](std::size_t k) -> std::vector<Complex> {
        const auto value = told.value[k];
        if (seen)
            return {value * std::pow(s(k), 2 - *integrationsToDisplacement(motion->quantity))};
        return {s(k), s(k) * value, s(k) * s(k) * value, std::pow(s(k), 1.7) * value};
    };
    // The cone is the fastest at its resonance, where the coil's impedance is the largest.
    const auto speedAt = [&](std::size_t k) {
        return seen ? std::abs(accelerationFrom(k).front()) / told.frequency[k] : 1.0 / std::abs(told.value[k]);
    };
    const double lowEnd = 0.25 * told.frequency.back();
    std::size_t fastest = 0;
    for (std::size_t k = 1; k < told.value.size() && told.frequency[k] < lowEnd; ++k)
        if (speedAt(k) > speedAt(fastest))
            fastest = k;
    const double edge = std::min(4.0 * told.frequency[fastest], lowEnd);
    constexpr double clear = 0.01;  // of the power
    MotionPerSound sound;
    for (std::size_t k = 0; k < told.value.size() && told.frequency[k] < edge; ++k) {
        const auto relativeVariance = [&](const Frf& frf) {
            return frf.noiseVariance.empty() ? 0.0 : frf.noiseVariance[k] / std::norm(frf.value[k]);
        };
        const double variance = relativeVariance(heard) + relativeVariance(told);
        auto parts = accelerationFrom(k);
        for (auto& part : parts)
            part /= heard.value[k];
        if (variance < clear)
            sound.add(told.frequency[k], std::move(parts), variance);
    }
    constexpr std::size_t fewest = 12;
    if (sound.lines() < (seen ? 1 : 2) * fewest)
        return std::nullopt;
    return pathOf(sound);
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
             "The pressure channel does not follow the motion of the cone: " + figure(100.0 * path->left)
                 + " % of it come from elsewhere (a room, another source). It is set aside; to use it, move the "
                   "microphone to a few centimetres before the cone, or measure in the open."});
        return;
    }
    if (path->rollOff > 0.0)
        problems.push_back({"roll-off", Quantity::pressure, path->rollOff, "Hz", false,
                            "The microphone, or its input, rolls off below " + engineering(path->rollOff, "Hz", 3)
                                + " (first order, seen against the motion of the cone); the pressure is corrected by "
                                  "that."});
}

}  // namespace excursion
