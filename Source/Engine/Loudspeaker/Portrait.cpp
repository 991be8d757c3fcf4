// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/Portrait.h"

#include "Engine/Loudspeaker/LawMemory.h"
#include "Engine/Loudspeaker/LawPace.h"
#include "Engine/Loudspeaker/Propagate.h"
#include "Engine/Numerics/RungeKutta.h"

#include <cmath>
#include <numbers>

namespace excursion {
namespace {

constexpr int points = 81;

/// A component of a model with its coefficients.
class Alone {
public:
    Alone(const Model& model, std::size_t component)
        : model_(model),
          component_(model.components[component]),
          coefficients_(coefficientsOf(component_, valuesOf(component_)))
    {
    }

    const Component& component() const { return component_; }
    const OperatingRange& range() const { return component_.operatingRange; }
    std::size_t memorySize() const { return static_cast<std::size_t>(component_.effect->memorySize(range())); }
    /// The base parameter that sizes the effect.
    double atRest() const { return model_.baseParameter(component_.effect->sizedBy()).value; }

    Balance<double> balance(const Motion<double>& motion, const std::vector<double>& memory,
                            std::vector<double>& rate) const
    {
        Balance<double> sum;
        component_.effect->contribute(range(), coefficients_.data(), motion, memory.data(), rate.data(), sum);
        return sum;
    }

    double lateness(double x) const
    {
        Emission<double> sum;
        const std::vector<double> none(memorySize(), 0.0);
        component_.effect->emit(range(), coefficients_.data(), {0.0, x, 0.0}, 0.0, none.data(), none.data(), sum);
        return sum.lateness;
    }

private:
    const Model& model_;
    const Component& component_;
    std::vector<double> coefficients_;
};

/// A memory along a motion: it goes a step further from where its rate is told.
class Walk {
public:
    Walk(const Alone& effect, std::vector<double> memory)
        : effect_(effect), memory_(std::move(memory)), rate_(memory_.size()), method_(memory_.size())
    {
    }

    Balance<double> at(const Motion<double>& motion) { return effect_.balance(motion, memory_, rate_); }

    /// @param motionAt  (share): the motion at that share of the step, from 0 to 1
    template <class MotionAt>
    void step(double time, const MotionAt& motionAt)
    {
        at(motionAt(0.0));
        method_.step(memory_, rate_, time, [&](double share, const std::vector<double>& m, std::vector<double>& out) {
            effect_.balance(motionAt(share), m, out);
        });
    }

private:
    const Alone& effect_;
    std::vector<double> memory_, rate_;
    RungeKutta<double> method_;
};

/// One period of x = A sin(w t).
struct Swing {
    double amplitude, w;  ///< m, rad/s
    std::size_t samples;

    double sampleRate() const { return w * static_cast<double>(samples) / (2.0 * std::numbers::pi); }
    Motion<double> at(double place) const
    {
        const double phase = 2.0 * std::numbers::pi * place / static_cast<double>(samples);
        return {0.0, amplitude * std::sin(phase), amplitude * w * std::cos(phase)};
    }
    PeriodicMotion motion() const
    {
        PeriodicMotion all;
        for (std::size_t n = 0; n < samples; ++n) {
            const auto now = at(static_cast<double>(n));
            all.i.push_back(now.i);
            all.x.push_back(now.x);
            all.v.push_back(now.v);
        }
        return all;
    }
};

Portrait::Line loopOf(const Alone& effect, double amplitude)
{
    constexpr std::size_t drawn = 128, finest = 32768;
    Swing swing {amplitude, effect.range().velocity / effect.range().displacement, 4 * drawn};
    auto motion = swing.motion();
    const auto steps = [&] {
        return paceOf(effect.component(), {motion.i, motion.x, motion.v}, 1, swing.sampleRate()).steps;
    };
    while (steps() > 1 && swing.samples < finest) {  // what slips at once is followed in small steps
        swing.samples *= 2;
        motion = swing.motion();
    }
    const auto start = settledMemory(effect.component(), motion, 0, swing.sampleRate());
    Walk walk(effect, {start.value.begin(), start.value.end()});
    Portrait::Line line {amplitude, {}, {}, {}};
    for (std::size_t n = 0; n <= swing.samples; ++n) {
        if (n % (swing.samples / drawn) == 0) {
            const auto now = swing.at(static_cast<double>(n));
            line.argument.push_back(now.x);
            line.value.push_back(-walk.at(now).force);
        }
        walk.step(1.0 / swing.sampleRate(), [&](double share) { return swing.at(static_cast<double>(n) + share); });
    }
    return line;
}

Portrait::Line driftOf(const Alone& effect)
{
    constexpr int parts = 16;  // the fastest that is sought has a time constant of some steps
    const double duration = effect.range().duration, current = 0.25 * effect.range().current;
    const Motion<double> held {current, 0.0, 0.0};
    Walk walk(effect, std::vector<double>(effect.memorySize(), 0.0));
    Portrait::Line line {current, {}, {}, {}};
    for (int n = 0; n < points; ++n) {
        line.argument.push_back(duration * n / (points - 1));
        line.value.push_back(effect.atRest() + walk.at(held).drop / current);
        for (int part = 0; part < parts; ++part)
            walk.step(duration / ((points - 1) * parts), [&](double) { return held; });
    }
    return line;
}

Portrait::Line latenessOf(const Alone& effect)
{
    Portrait::Line line;
    for (int n = 0; n < points; ++n) {
        line.argument.push_back(effect.range().displacement * (2.0 * n / (points - 1) - 1.0));
        line.value.push_back(effect.lateness(line.argument.back()));
    }
    return line;
}

std::vector<Portrait::Line> linesOf(const Model& model, std::size_t component)
{
    const Alone effect(model, component);
    switch (effect.component().effect->evidence()) {
    case Evidence::loop: {
        const double X = effect.range().displacement;
        return {loopOf(effect, X), loopOf(effect, 0.5 * X), loopOf(effect, 0.25 * X)};
    }
    case Evidence::drift: return {driftOf(effect)};
    case Evidence::lateness: return {latenessOf(effect)};
    case Evidence::law:
    case Evidence::response: break;
    }
    return {};
}

/// A portrait without lines.
Portrait frameOf(const Effect& effect)
{
    switch (effect.evidence()) {
    case Evidence::loop: return {effect.id(), Evidence::loop, "force", "N", "x", "m", {}};
    case Evidence::drift: return {effect.id(), Evidence::drift, effect.sizedBy(), "ohm", "t", "s", {}};
    case Evidence::lateness: return {effect.id(), Evidence::lateness, "lateness", "s", "x", "m", {}};
    case Evidence::law:
    case Evidence::response: break;
    }
    return {};
}

/// The model with this component as its last and only effect beside its host, as its portrait depends on no other.
Model alone(const Model& model, std::size_t component)
{
    const auto& all = model.components;
    std::vector<std::size_t> stays {0};
    for (std::size_t k = 1; k < all.size(); ++k)
        if (all[k].effect == all[component].effect->host())
            stays.push_back(k);
    stays.push_back(component);
    Model only = model;
    only.components.clear();
    for (const auto k : stays)
        only.components.push_back(all[k]);
    if (model.covariance.size() == 0)
        return only;
    stays.push_back(all.size());  // the path
    std::vector<Eigen::Index> kept;
    for (const auto k : stays) {
        const auto count = k < all.size() ? all[k].parameters.size() : model.path.parameters.size();
        for (std::size_t p = 0; p < count; ++p)
            kept.push_back(firstParameterOf(model, k) + static_cast<Eigen::Index>(p));
    }
    only.covariance = model.covariance(kept, kept);
    return only;
}

}  // namespace

std::vector<Portrait> portraits(const Model& model)
{
    std::vector<Portrait> all;
    for (std::size_t k = 1; k < model.components.size(); ++k) {
        auto portrait = frameOf(*model.components[k].effect);
        if (portrait.effectId.empty())
            continue;
        portrait.lines = linesOf(model, k);
        const auto errors = standardErrorsOf(alone(model, k), [](const Model& only) {
            std::vector<double> values;
            for (const auto& line : linesOf(only, only.components.size() - 1))
                values.insert(values.end(), line.value.begin(), line.value.end());
            return Eigen::VectorXd(
                Eigen::Map<Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())));
        });
        Eigen::Index n = 0;
        for (auto& line : portrait.lines)
            for (std::size_t m = 0; m < line.value.size(); ++m, ++n)
                line.halfWidth.push_back(1.96 * errors[n]);
        all.push_back(std::move(portrait));
    }
    return all;
}

}  // namespace excursion
