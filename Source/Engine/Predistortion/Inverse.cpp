// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Predistortion/Inverse.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

Tangent carrying(double value, double byTime, double byCurrent)
{
    Tangent t(value);
    t.v[0] = byTime;
    t.v[1] = byCurrent;
    return t;
}

/// sum_k weights_k values_k
double sumOf(const std::vector<double>& weights, const double* values)
{
    const auto size = static_cast<Eigen::Index>(weights.size());
    return Eigen::Map<const Eigen::VectorXd>(weights.data(), size).dot(Eigen::Map<const Eigen::VectorXd>(values, size));
}

/// Down to what share of its value at rest the force per current is believed.
constexpr double weakestShare = 0.1;
/// A miss of the extrapolated current that is worth a second step, of the largest current.
constexpr double unexpected = 1e-3;

double byTime(const Tangent& t) { return t.v[0]; }
double byCurrent(const Tangent& t) { return t.v[1]; }

}  // namespace

Inverse::Inverse(const Model& model, double sampleRate) : electrical_(model.electrical()), period_(1.0 / sampleRate)
{
    Balance<Tangent> atRest;
    double visited = 0.0;
    std::vector<LinearMemory::Block> blocks;
    for (const auto& component : model.components) {
        const auto& effect = *component.effect;
        const auto coefficients = coefficientsOf(component, valuesOf(component));
        if (&component != &model.base())
            visited = std::max(visited, component.operatingRange.current);

        std::vector<Tangent> constants(coefficients.begin(), coefficients.end());
        std::vector<Tangent> silent(static_cast<std::size_t>(effect.memorySize(component.operatingRange)),
                                    Tangent(0.0)),
            unused = silent;
        const Motion<Tangent> rest {carrying(0.0, 0.0, 1.0), Tangent(0.0), Tangent(0.0)};
        effect.contribute(component.operatingRange, constants.data(), rest, silent.data(), unused.data(), atRest);
        const auto form = linearForm(effect, component.operatingRange, coefficients.data());
        if (form) {
            linear_.inductance += form->inductance;
            linear_.mass += form->mass;
            for (std::size_t q = 0; q < 3; ++q) {
                linear_.drop[q] += form->drop[q];
                linear_.force[q] += form->force[q];
            }
            dropByCurrent_ += form->drop[0];
            forceByCurrent_ += form->force[0];
        } else {
            curved_.push_back(
                {&effect, component.operatingRange, std::move(constants), std::nullopt, std::nullopt, silent, unused});
        }
        if (silent.empty())
            continue;
        const auto rates = linearRates(effect, component.operatingRange, coefficients.data());
        auto block = !rates ? std::nullopt
                     : form ? LinearMemory::summed(*rates, form->dropByMemory, form->forceByMemory, sampleRate)
                            : LinearMemory::readable(*rates, sampleRate);
        if (block) {
            if (!form)
                curved_.back().block = blocks.size();
            blocks.push_back(std::move(*block));
            continue;
        }
        Memory memory(effect, component.operatingRange, coefficients, sampleRate);
        if (form) {
            dropByCurrent_ += sumOf(form->dropByMemory, memory.byCurrent());
            forceByCurrent_ += sumOf(form->forceByMemory, memory.byCurrent());
            lagging_.push_back({std::move(memory), form->dropByMemory, form->forceByMemory});
        } else {
            curved_.back().memory = std::move(memory);
        }
    }
    together_ = LinearMemory(std::move(blocks));
    dropByCurrent_ += together_.sumsByCurrent().drop;
    forceByCurrent_ += together_.sumsByCurrent().force;
    if (visited > 0.0)
        largestCurrent_ = 10.0 * visited;
    forcePerCurrent_ = byCurrent(atRest.force);
}

template <class Act>
void Inverse::forEachMemory(const Act& act)
{
    act(together_);
    for (auto& part : lagging_)
        act(part.memory);
    for (auto& part : curved_)
        if (part.memory)
            act(*part.memory);
}

/// What is slow is never linear: its rate is a power.
template <class Self, class Act>
void Inverse::forEachSlow(Self& self, const Act& act)
{
    for (auto& part : self.curved_)
        if (part.memory && part.effect->slow())
            act(*part.effect, *part.memory);
}

void Inverse::reset()
{
    forEachMemory([](auto& memory) { memory.reset(); });
    now_ = past_ = {};
    ease_ = 1.0;
}

void Inverse::keep(Warmth& warmth) const
{
    std::size_t place = 0;
    warmth.slow = {};
    forEachSlow(*this, [&](const Effect& effect, const Memory& memory) {
        if (place == warmth.slow.size() || memory.size() > warmth.slow[place].value.size())
            return;
        warmth.slow[place].effect = &effect;
        std::copy_n(memory.value(), memory.size(), warmth.slow[place++].value.begin());
    });
}

void Inverse::warm(const Warmth& warmth)
{
    forEachSlow(*this, [&](const Effect& effect, Memory& memory) {
        if (const auto* known = warmth.of(effect); known && memory.size() <= known->value.size())
            memory.set(known->value.data());
    });
}

void Inverse::drift(const MotionPoint& at, double seconds)
{
    forEachSlow(*this, [&](const Effect&, Memory& memory) { memory.drift(at.i, at.x, at.v, seconds); });
}

void Inverse::join(const Inverse& other, double share)
{
    together_.approach(other.together_, share);
    for (std::size_t k = 0; k < lagging_.size(); ++k)
        lagging_[k].memory.approach(other.lagging_[k].memory, share);
    for (std::size_t k = 0; k < curved_.size(); ++k)
        if (auto& part = curved_[k]; part.memory)
            part.memory->approach(*other.curved_[k].memory, part.effect->slow() ? 1.0 : share);
}

double Inverse::rise()
{
    double ohms = 0.0;
    forEachSlow(*this, [&](const Effect&, Memory& memory) { ohms += memory.dropPerCurrent(); });
    return ohms;
}

double Inverse::step(const MotionPoint& to)
{
    past_ = now_;
    const auto& ahead = now_.ahead;
    const double extrapolated = to.i + 3.0 * (ahead[0] - ahead[1]) + ahead[2];
    const double guess = electrical_ ? std::clamp(extrapolated, -largestCurrent_, largestCurrent_) : 0.0;
    const double made = solve(to, guess);
    if (std::abs(now_.current - guess) <= unexpected * largestCurrent_)
        return made;
    // An edge of the signal: what the extrapolation missed is too large for its square to be left.
    const double found = now_.current;
    takeBack();
    return solve(to, found);
}

double Inverse::again(const MotionPoint& to)
{
    takeBack();
    return step(to);
}

void Inverse::takeBack()
{
    forEachMemory([](auto& memory) { memory.stepBack(); });
    now_ = past_;
}

double Inverse::solve(const MotionPoint& to, double guess)
{
    auto& [last, current, before, slope, ahead] = now_;
    const MotionCubic motion {Cubic::past(before, current, slope * period_, guess),
                              Cubic::between(last.x, last.v * period_, to.x, to.v * period_),
                              Cubic::between(last.v, last.a * period_, to.v, to.a * period_)};
    last = to;

    const auto& [di, dx, dv] = linear_.drop;
    const auto& [fi, fx, fv] = linear_.force;
    double drop = di * guess + dx * to.x + dv * to.v, force = fi * guess + fx * to.x + fv * to.v,
           forceByTime = fx * to.v + fv * to.a;
    const auto lag = together_.step(motion);
    drop += lag.drop;
    force += lag.force;
    forceByTime += lag.forceByTime;
    for (auto& part : lagging_) {
        part.memory.step(motion);
        drop += sumOf(part.drop, part.memory.value());
        force += sumOf(part.force, part.memory.value());
        forceByTime += sumOf(part.force, part.memory.findRate());
    }
    Balance<Tangent> sum;
    sum.inductance = Tangent(linear_.inductance);
    sum.mass = Tangent(linear_.mass);
    sum.drop = carrying(drop, 0.0, dropByCurrent_);  // nobody asks how it goes on in time
    sum.force = carrying(force, forceByTime, forceByCurrent_);
    const Motion<Tangent> at {carrying(guess, 0.0, 1.0), carrying(to.x, to.v, 0.0), carrying(to.v, to.a, 0.0)};
    for (auto& part : curved_) {
        if (part.block) {
            for (std::size_t k = 0; k < part.state.size(); ++k)
                part.state[k] = carrying(together_.value(*part.block, k), together_.rate(*part.block, k),
                                         together_.byCurrent(*part.block, k));
        } else if (part.memory) {
            auto& memory = *part.memory;
            memory.step(motion);
            const double* const rate = memory.findRate();
            for (std::size_t k = 0; k < memory.size(); ++k)
                part.state[k] = carrying(memory.value()[k], rate[k], memory.byCurrent()[k]);
        }
        part.effect->contribute(part.operatingRange, part.coefficients.data(), at, part.state.data(), part.rate.data(),
                                sum);
    }
    const double missing = sum.mass.a * to.a - sum.force.a;  // N
    if (!electrical_)
        return missing;

    const double weakest = weakestShare * forcePerCurrent_;
    const bool weak = byCurrent(sum.force) < weakest;
    const double perCurrent = weak ? weakest : byCurrent(sum.force);
    before = current;
    current = std::clamp(guess + missing / perCurrent, -largestCurrent_, largestCurrent_);
    const double off = current - guess;
    slope = (sum.mass.a * to.j + byTime(sum.mass) * to.a - byTime(sum.force)) / perCurrent;
    together_.correct(off);
    for (auto& part : lagging_)
        part.memory.correct(off);
    for (auto& part : curved_)
        if (part.memory)
            part.memory->correct(off);
    const double difference = current - to.i;
    // Where force and current have come apart there is no trend to follow.
    ahead = weak ? std::array {difference, difference, difference} : std::array {difference, ahead[0], ahead[1]};
    ease_ = forcePerCurrent_ / perCurrent;
    const auto corrected = [off](const Tangent& t) { return t.a + byCurrent(t) * off; };
    const double L = keptInductance(corrected(sum.inductance), linear_.inductance);
    return corrected(sum.drop) + L * slope + corrected(sum.fluxSlope) * to.v;
}

}  // namespace excursion
