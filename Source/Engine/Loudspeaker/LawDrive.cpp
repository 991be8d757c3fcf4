// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/LawDrive.h"

#include "Engine/Loudspeaker/LawPace.h"
#include "Engine/Loudspeaker/SteadyMemory.h"
#include "Engine/Numerics/RungeKutta.h"
#include "Engine/Signal/Fft.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

// a law is asked once a sample, and its memory in between; a record's rate leaves room for products
constexpr std::size_t fine = ShownMotion::fine;

MotionView viewOf(const ShownMotion& motion) { return {motion.i, motion.x, motion.v}; }

/// What a law answers along a motion: one value a sample.
template <class T>
struct Answers {
    std::vector<T> voltage, force, flow, lateness;
    std::vector<T> memory;  ///< where the window begins
};

/// A law that is asked along a motion.
template <class T>
class Along {
public:
    Along(const Component& law, const std::vector<T>& parameters, const ShownMotion& motion)
        : law_(law), coefficients_(coefficientsOf(law, parameters)), motion_(motion), view_(viewOf(motion))
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
        answers.flow.push_back(emission.acceleration);
        answers.lateness.push_back(emission.lateness);
    }

private:
    Motion<T> at(double place) const { return view_.at<T>(place); }

    const Component& law_;
    std::vector<T> coefficients_;
    const ShownMotion& motion_;
    MotionView view_;
};

/// How a law is asked along a motion.
struct Grid {
    std::size_t apart = fine;  ///< values of the motion from answer to answer
    double rate = 0.0;         ///< Hz, of the answers
    std::size_t leadIn = 0;    ///< values of the motion before the window, up to a period
    Pace pace;                 ///< of the memory, at this rate
};

/// follow() of a memory that is steady.
template <class T, class See>
void followSteady(const Along<T>& law, std::vector<T> start, std::size_t length, const Grid& grid, const See& see)
{
    const auto [apart, stepRate, leadIn, pace] = grid;
    SteadyMemory on([&](double place, const T* memory, T* rate) { law.ask(place, memory, rate); }, std::move(start),
                    length - leadIn, apart, stepRate);
    std::vector<T> rate(on.memory.size());
    for (std::size_t step = 0; step < leadIn + length; step += apart) {
        const std::size_t n = (length - leadIn + step) % length;
        if (step >= leadIn) {
            const auto sum = law.ask(static_cast<double>(n), on.memory.data(), rate.data());
            see(n, sum, on.memory, rate);
        }
        on.advance(n);
    }
}

/// Follows a law's memory from the lead-in before the window to its end, and shows what it meets there at each answer:
/// see(value of the motion, sum, memory, its rate).
template <class T, class See>
void follow(const Along<T>& law, std::vector<T> memory, std::size_t length, const Grid& grid, const See& see)
{
    RungeKutta<T> method(memory.size());
    std::vector<T> rate(memory.size());
    const int steps = grid.pace.steps;
    const double h = 1.0 / (steps * grid.rate), across = static_cast<double>(grid.apart) / steps;
    for (std::size_t step = 0; step < grid.leadIn + length; step += grid.apart) {
        const std::size_t n = (length - grid.leadIn + step) % length;
        const auto sum = law.ask(static_cast<double>(n), memory.data(), rate.data());
        if (step >= grid.leadIn)
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
               const std::vector<T>& start, const Grid& grid)
{
    const Along<T> along(law, parameters, motion);
    const std::size_t length = motion.i.size();
    Answers<T> answers;
    answers.voltage.reserve(length / grid.apart);
    answers.force.reserve(length / grid.apart);
    if (!start.empty()) {
        const auto see = [&](std::size_t n, const Balance<T>& sum, const std::vector<T>& memory,
                             const std::vector<T>& rate) {
            if (answers.memory.empty())
                answers.memory = memory;
            along.answer(n, sum, memory.data(), rate.data(), answers);
        };
        if (grid.pace.steady)
            followSteady(along, start, length, grid, see);
        else
            follow(along, start, length, grid, see);
        return answers;
    }
    for (std::size_t n = 0; n < length; n += grid.apart)
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

bool isZero(const std::vector<double>& samples)
{
    return std::all_of(samples.begin(), samples.end(), [](double sample) { return sample == 0.0; });
}

template <class Series>
bool areEmpty(const std::vector<Series>& all)
{
    return std::all_of(all.begin(), all.end(), [](const Series& one) { return one.empty(); });
}

/// The first lines of a spectrum; none of what is zero.
/// @param thinned  of so many samples one is there
Spectrum firstLines(const std::vector<double>& samples, std::size_t lines, std::size_t thinned)
{
    if (isZero(samples))
        return {};
    auto spectrum = fft(samples);
    spectrum.resize(std::min(lines, spectrum.size()));
    for (auto& line : spectrum)
        line *= static_cast<double>(thinned);
    spectrum.shrink_to_fit();
    return spectrum;
}

/// Of how many samples one is enough for slopes. A step, or a vote, needs no more than their leading digits: what lies
/// above twice the compared lines may fold into them.
std::size_t thinnedFor(const Component& law, const Pace& pace, std::size_t samples, std::size_t lines)
{
    constexpr int factor = 2, mostSteps = 16;                             // a sample
    if (law.effect->emits() || (!pace.steady && pace.steps > mostSteps))  // lateness is asked for at every sample
        return 1;
    return samples % factor == 0 && samples / factor >= 3 * lines ? factor : 1;
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

bool LawDrive::isLate() const { return !isZero(lateness) || (slopes && !areEmpty(slopes->lateness)); }
bool LawDrive::radiates() const { return !flow.empty() || (slopes && !areEmpty(slopes->flow)); }

bool forgetsInAQuarter(const Component& law, const ShownMotion& motion, double sampleRate)
{
    return paceOf(law, viewOf(motion), fine, sampleRate).quarterForgets;
}

bool hasConstantSlopes(const Component& law)
{
    if (law.effect->memorySize(law.operatingRange) > 0 || law.effect->emits())
        return false;
    const auto here = valuesOf<Jet>(law);
    auto there = here;
    for (std::size_t k = 0; k < law.parameters.size(); ++k) {
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
    const auto count = valuesOf(law).size();
    const auto size = static_cast<std::size_t>(start.value.size());
    const std::size_t length = motion.i.size();
    const auto gridOf = [&](std::size_t thinned) {
        Grid grid {fine * thinned, sampleRate / static_cast<double>(thinned), 0, {}};
        grid.leadIn = length / grid.apart / 4 * grid.apart;
        grid.pace = paceOf(law, viewOf(motion), grid.apart, grid.rate);
        return grid;
    };
    LawDrive drive;
    const auto grid = gridOf(1);
    const auto plain = ask<double>(law, valuesOf(law), motion, {start.value.begin(), start.value.end()}, grid);
    drive.voltage = fft(plain.voltage);
    drive.force = fft(plain.force);
    if (!isZero(plain.flow))
        drive.flow = fft(plain.flow);
    drive.lateness = plain.lateness;
    if (std::none_of(wanted.begin(), wanted.end(), [](bool w) { return w; }))
        return drive;
    auto slopes = std::make_shared<LawSlopes>();
    slopes->at = valuesOf(law);
    slopes->wanted = wanted;
    slopes->voltage.resize(count);
    slopes->force.resize(count);
    slopes->flow.resize(count);
    slopes->lateness.resize(count);
    // A start of a slow part knows nothing of the parameters: a whole period, which begins as the window does, forgets
    // more of that than a quarter.
    const bool whole = !grid.pace.quarterForgets && !law.effect->slow();
    const auto thinned = thinnedFor(law, grid.pace, length / fine, lines);
    auto coarse = thinned > 1 ? gridOf(thinned) : grid;
    if (whole)
        coarse.leadIn = length;
    std::vector<std::size_t> own;  // of a chunk
    const auto differentiate = [&] {
        auto parameters = valuesOf<Jet>(law);
        std::vector<Jet> memory(size);
        for (std::size_t m = 0; m < size; ++m)
            memory[m] = Jet(whole ? plain.memory[m] : start.value[static_cast<Eigen::Index>(m)]);
        for (std::size_t j = 0; j < own.size(); ++j) {
            const auto slot = static_cast<Eigen::Index>(j);
            parameters[own[j]].v[slot] = 1.0;
            const bool starts = !whole && own[j] < law.parameters.size();
            for (std::size_t m = 0; m < size && starts; ++m)
                memory[m].v[slot] = start.gradient(static_cast<Eigen::Index>(m), static_cast<Eigen::Index>(own[j]));
        }
        const auto jets = ask<Jet>(law, parameters, motion, memory, coarse);
        for (std::size_t j = 0; j < own.size(); ++j) {
            const auto slope = [slot = static_cast<Eigen::Index>(j)](const Jet& value) { return value.v[slot]; };
            slopes->voltage[own[j]] = firstLines(series(jets.voltage, slope), lines, thinned);
            slopes->force[own[j]] = firstLines(series(jets.force, slope), lines, thinned);
            slopes->flow[own[j]] = firstLines(series(jets.flow, slope), lines, thinned);
            slopes->lateness[own[j]] = series(jets.lateness, slope);
            if (isZero(slopes->lateness[own[j]]))
                slopes->lateness[own[j]].clear();
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
