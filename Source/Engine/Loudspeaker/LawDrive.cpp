// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/LawDrive.h"

#include "Engine/Numerics/RungeKutta.h"
#include "Engine/Signal/Fft.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

// a law is asked once a sample, and its memory in between; a record's rate leaves room for products
constexpr std::size_t fine = ShownMotion::fine;

/// What a law answers along a motion: one value a sample.
template <class T>
struct Answers {
    std::vector<T> voltage, force, lateness;
    std::vector<T> memory;  ///< where the window begins
};

/// A law that is asked along a motion.
template <class T>
class Along {
public:
    Along(const Component& law, const std::vector<T>& parameters, const ShownMotion& motion)
        : law_(law), coefficients_(coefficientsOf(law, parameters)), motion_(motion)
    {
    }

    /// @param place  between two fine values of the motion as well
    Balance<T> ask(double place, const T* memory, T* rate) const
    {
        Balance<T> sum;
        law_.effect->contribute(law_.operatingRange, coefficients_.data(), at(place), memory, rate, sum);
        return sum;
    }

    /// Adds what was asked there to the answers.
    void answer(std::size_t n, const Balance<T>& sum, const T* memory, const T* rate, Answers<T>& answers) const
    {
        answers.voltage.push_back(sum.drop + sum.fluxSlope * motion_.v[n] + sum.inductance * motion_.slope[n]);
        answers.force.push_back(sum.force - sum.mass * motion_.a[n]);
        if (!law_.effect->emits())
            return;
        Emission<T> emission;
        law_.effect->emit(law_.operatingRange, coefficients_.data(), at(static_cast<double>(n)), T(motion_.a[n]),
                          memory, rate, emission);
        answers.lateness.push_back(emission.lateness);
    }

private:
    Motion<T> at(double place) const
    {
        const auto whole = static_cast<std::size_t>(place);
        const double share = place - static_cast<double>(whole);
        const std::size_t length = motion_.i.size(), here = whole % length, next = (here + 1) % length;
        const auto between = [&](const std::vector<double>& q) { return T(q[here] + share * (q[next] - q[here])); };
        return {between(motion_.i), between(motion_.x), between(motion_.v)};
    }

    const Component& law_;
    std::vector<T> coefficients_;
    const ShownMotion& motion_;
};

/// How a law's memory goes along the motion.
struct Pace {
    int steps = 1;  ///< a sample, in which the memory can be followed: its fastest rate times one stays below one
    bool quarterForgets = true;  ///< nothing of what was is left of its slowest part after a quarter of the period
    bool steady = true;          ///< each state forgets at a rate of its own that nothing changes, dm/dt = a - r m
};

Pace paceOf(const Component& law, const ShownMotion& motion, double sampleRate)
{
    const auto size = static_cast<std::size_t>(law.effect->memorySize(law.operatingRange));
    if (size == 0)
        return {};
    const auto coefficients = coefficientsOf(law, valuesOf(law));
    std::vector<double> memory(size, 0.0), rest(size), moved(size), sum(size, 0.0), first;
    double fastest = 0.0, asked = 0.0;
    bool steady = true;
    constexpr std::size_t apart = 8 * fine;
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
    const double quarter = static_cast<double>(motion.i.size()) / (fine * 4.0 * sampleRate);
    return {static_cast<int>(std::clamp(std::ceil(fastest / sampleRate), 1.0, most)),
            *std::min_element(sum.begin(), sum.end()) / asked * quarter > forgotten, steady};
}

/// A state that forgets at a steady rate r, dm/dt = a - r m, over one step: a goes along the parabola through its
/// values at the step's begin, middle and end, and the state exactly with it.
template <class T>
class Relaxation {
public:
    Relaxation(const T& rate, double step)
    {
        using std::exp;
        const T z = rate * step;
        decay_ = exp(-z);
        // integrals of exp(-z (1 - s)) s^j over the step
        T I0, I1, I2;
        if (z < T(0.1)) {
            const auto series = [&](double factor, int j) {
                T term = T(factor), total = term;
                for (int k = 1; k < 8; ++k) {
                    term *= -z / static_cast<double>(j + k + 1);
                    total += term;
                }
                return total;
            };
            I0 = series(1.0, 0);
            I1 = series(1.0 / 2.0, 1);
            I2 = series(1.0 / 3.0, 2);
        } else {
            I0 = (1.0 - decay_) / z;
            I1 = (1.0 - I0) / z;
            I2 = (1.0 - 2.0 * I1) / z;
        }
        begin_ = step * (I0 - 3.0 * I1 + 2.0 * I2);
        middle_ = step * 4.0 * (I1 - I2);
        end_ = step * (2.0 * I2 - I1);
    }

    T after(const T& m, const T& begin, const T& middle, const T& end) const
    {
        return decay_ * m + begin_ * begin + middle_ * middle + end_ * end;
    }

private:
    T decay_, begin_, middle_, end_;
};

/// follow() of a memory that is steady.
template <class T, class See>
void followSteady(const Along<T>& law, std::vector<T> memory, std::size_t length, std::size_t leadIn, double sampleRate,
                  const See& see)
{
    const std::size_t size = memory.size();
    const std::vector<T> none(size, T(0.0));
    std::vector<T> begin(size), middle(size), end(size), rate(size);
    std::vector<Relaxation<T>> states;
    law.ask(0.0, none.data(), begin.data());
    for (std::size_t k = 0; k < size; ++k) {
        auto one = none;
        one[k] = T(1.0);
        law.ask(0.0, one.data(), rate.data());
        states.emplace_back(begin[k] - rate[k], 1.0 / sampleRate);
    }
    law.ask(static_cast<double>(length - leadIn), none.data(), begin.data());
    for (std::size_t step = 0; step < leadIn + length; step += fine) {
        const std::size_t n = (length - leadIn + step) % length;
        const auto place = static_cast<double>(n);
        if (step >= leadIn) {
            const auto sum = law.ask(place, memory.data(), rate.data());
            see(n, sum, memory, rate);
        }
        law.ask(place + 0.5 * fine, none.data(), middle.data());
        law.ask(place + fine, none.data(), end.data());
        for (std::size_t k = 0; k < size; ++k)
            memory[k] = states[k].after(memory[k], begin[k], middle[k], end[k]);
        std::swap(begin, end);
    }
}

/// Follows a law's memory from the lead-in before the window to its end, and shows what it meets there once a sample:
/// see(fine value, sum, memory, its rate).
/// @param leadIn  fine values, up to a period
template <class T, class See>
void follow(const Along<T>& law, std::vector<T> memory, std::size_t length, std::size_t leadIn, int steps,
            double sampleRate, const See& see)
{
    RungeKutta<T> method(memory.size());
    std::vector<T> rate(memory.size());
    const double h = 1.0 / (steps * sampleRate), across = static_cast<double>(fine) / steps;
    for (std::size_t step = 0; step < leadIn + length; step += fine) {
        const std::size_t n = (length - leadIn + step) % length;
        const auto sum = law.ask(static_cast<double>(n), memory.data(), rate.data());
        if (step >= leadIn)
            see(n, sum, memory, rate);
        for (int part = 0; part < steps; ++part) {
            const double begin = static_cast<double>(n) + across * part;
            if (part > 0)
                law.ask(begin, memory.data(), rate.data());
            method.step(memory, rate, h, [&](double share, const std::vector<T>& held, std::vector<T>& out) {
                law.ask(begin + share * across, held.data(), out.data());
            });
        }
    }
}

template <class T>
Answers<T> ask(const Component& law, const std::vector<T>& parameters, const ShownMotion& motion,
               const std::vector<T>& start, std::size_t leadIn, const Pace& pace, double sampleRate)
{
    const Along<T> along(law, parameters, motion);
    const std::size_t length = motion.i.size();
    Answers<T> answers;
    answers.voltage.reserve(length / fine);
    answers.force.reserve(length / fine);
    if (!start.empty()) {
        const auto see = [&](std::size_t n, const Balance<T>& sum, const std::vector<T>& memory,
                             const std::vector<T>& rate) {
            if (answers.memory.empty())
                answers.memory = memory;
            along.answer(n, sum, memory.data(), rate.data(), answers);
        };
        if (pace.steady)
            followSteady(along, start, length, leadIn, sampleRate, see);
        else
            follow(along, start, length, leadIn, pace.steps, sampleRate, see);
        return answers;
    }
    for (std::size_t n = 0; n < length; n += fine)
        along.answer(n, along.ask(static_cast<double>(n), nullptr, nullptr), nullptr, nullptr, answers);
    return answers;
}

template <class T, class Read>
std::vector<double> series(const std::vector<T>& samples, const Read& read)
{
    std::vector<double> result(samples.size());
    std::transform(samples.begin(), samples.end(), result.begin(), read);
    return result;
}

/// The first lines of a spectrum; none of what is zero.
Spectrum firstLines(const std::vector<double>& samples, std::size_t lines)
{
    if (std::all_of(samples.begin(), samples.end(), [](double sample) { return sample == 0.0; }))
        return {};
    auto spectrum = fft(samples);
    spectrum.resize(std::min(lines, spectrum.size()));
    spectrum.shrink_to_fit();
    return spectrum;
}

/// The derivatives of what a law without memory adds to the two equations, by its parameters, somewhere in its range.
std::vector<double> slopesAt(const Component& law, const std::vector<Jet>& parameters, double i, double x, double v)
{
    const auto& e = law.operatingRange;
    const Motion<Jet> at {Jet(i * e.current), Jet(x * e.displacement), Jet(v * e.velocity)};
    std::vector<double> slopes;
    for (std::size_t first = 0; first < parameters.size(); first += jetWidth) {
        const auto width = std::min<std::size_t>(jetWidth, parameters.size() - first);
        auto seeded = parameters;
        for (std::size_t k = 0; k < width; ++k)
            seeded[first + k].v[static_cast<Eigen::Index>(k)] = 1.0;
        Balance<Jet> sum;
        law.effect->contribute(e, coefficientsOf(law, seeded).data(), at, nullptr, nullptr, sum);
        for (const auto* part : {&sum.inductance, &sum.fluxSlope, &sum.drop, &sum.force, &sum.mass})
            for (std::size_t k = 0; k < width; ++k)
                slopes.push_back(part->v[static_cast<Eigen::Index>(k)]);
    }
    return slopes;
}

}  // namespace

bool forgetsInAQuarter(const Component& law, const ShownMotion& motion, double sampleRate)
{
    return paceOf(law, motion, sampleRate).quarterForgets;
}

bool hasConstantSlopes(const Component& law)
{
    if (law.effect->memorySize(law.operatingRange) > 0 || law.effect->emits())
        return false;
    const auto here = valuesOf<Jet>(law);
    auto there = here;
    for (std::size_t k = 0; k < there.size(); ++k) {
        const auto& p = law.parameters[k];
        there[k] += 0.01 * (1.0 + static_cast<double>(k % 3))
                    * (std::isfinite(p.prior) ? p.prior : law.operatingRange.scale);
    }
    constexpr double places[][3] = {{0.3, -0.6, 0.5}, {-0.8, 0.7, -0.2}, {0.9, 0.2, -0.9}};
    constexpr double same = 1e-10;
    return std::all_of(std::begin(places), std::end(places), [&](const auto& at) {
        const auto a = slopesAt(law, here, at[0], at[1], at[2]), b = slopesAt(law, there, at[0], at[1], at[2]);
        return std::equal(a.begin(), a.end(), b.begin(),
                          [](double one, double other) { return std::abs(one - other) <= same * std::abs(one); });
    });
}

LawDrive driveOf(const Component& law, const ShownMotion& motion, const MemoryStart& start, double sampleRate,
                 const std::vector<bool>& wanted, std::size_t lines)
{
    const auto count = law.parameters.size();
    const auto size = static_cast<std::size_t>(start.value.size());
    const auto pace = paceOf(law, motion, sampleRate);
    const std::size_t length = motion.i.size(), quarter = length / fine / 4 * fine;
    LawDrive drive;
    const auto plain = ask<double>(law, valuesOf(law), motion, {start.value.begin(), start.value.end()}, quarter, pace,
                                   sampleRate);
    drive.voltage = fft(plain.voltage);
    drive.force = fft(plain.force);
    drive.lateness = plain.lateness;
    if (std::none_of(wanted.begin(), wanted.end(), [](bool w) { return w; }))
        return drive;
    auto slopes = std::make_shared<LawSlopes>();
    slopes->voltage.resize(count);
    slopes->force.resize(count);
    slopes->lateness.resize(count);
    // A start of a slow part knows nothing of the parameters: a whole period, which begins as the window does, forgets
    // more of that than a quarter.
    const bool whole = !pace.quarterForgets && !law.effect->slow();
    std::vector<std::size_t> own;  // of a chunk
    const auto differentiate = [&] {
        auto parameters = valuesOf<Jet>(law);
        std::vector<Jet> memory(size);
        for (std::size_t m = 0; m < size; ++m)
            memory[m] = Jet(whole ? plain.memory[m] : start.value[static_cast<Eigen::Index>(m)]);
        for (std::size_t j = 0; j < own.size(); ++j) {
            const auto slot = static_cast<Eigen::Index>(j);
            parameters[own[j]].v[slot] = 1.0;
            for (std::size_t m = 0; m < size && !whole; ++m)
                memory[m].v[slot] = start.gradient(static_cast<Eigen::Index>(m), static_cast<Eigen::Index>(own[j]));
        }
        const auto jets = ask<Jet>(law, parameters, motion, memory, whole ? length : quarter, pace, sampleRate);
        for (std::size_t j = 0; j < own.size(); ++j) {
            const auto slope = [slot = static_cast<Eigen::Index>(j)](const Jet& value) { return value.v[slot]; };
            slopes->voltage[own[j]] = firstLines(series(jets.voltage, slope), lines);
            slopes->force[own[j]] = firstLines(series(jets.force, slope), lines);
            slopes->lateness[own[j]] = series(jets.lateness, slope);
        }
        own.clear();
    };
    for (std::size_t k = 0; k < count; ++k) {
        if (wanted[k])
            own.push_back(k);
        if (own.size() == static_cast<std::size_t>(jetWidth) || (k + 1 == count && !own.empty()))
            differentiate();
    }
    drive.slopes = std::move(slopes);
    return drive;
}

}  // namespace excursion
