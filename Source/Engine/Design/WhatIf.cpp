// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Design/WhatIf.h"

#include "Engine/Document/Figures.h"
#include "Engine/Loudspeaker/Catalogue.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace excursion {
namespace {

const ChannelDistortion* find(const std::vector<ChannelDistortion>& channels, Quantity quantity)
{
    const auto place = std::find_if(channels.begin(), channels.end(),
                                    [&](const auto& c) { return c.quantity == quantity; });
    return place == channels.end() ? nullptr : &*place;
}

std::string millimetres(double metres) { return figure(1e3 * metres, "%.2g") + " mm"; }

/// What makes the distortion of the sound.
std::string causes(const WhatIf& whatIf)
{
    constexpr double audible = -100.0, all = 30.0, most = 3.0, some = 1.0;  // dB
    const auto* sound = find(whatIf.distortion.whole, Quantity::pressure);
    if (!sound || distortionDb(*sound) < audible)
        return "The model adds no distortion to the sound. ";
    std::string text = "At this level the distortion of the sound is " + figure(distortionDb(*sound)) + " dB ("
                       + figure(100.0 * std::pow(10.0, distortionDb(*sound) / 20.0), "%.2g") + " %), "
                       + (std::abs(sound->evenDb - sound->oddDb) < most ? "even and odd alike"
                          : sound->evenDb > sound->oddDb                ? "mostly even"
                                                                        : "mostly odd")
                       + ". ";
    struct Cause {
        std::string effect;
        double fall;
    };
    std::vector<Cause> found;
    for (const auto& effect : whatIf.distortion.effects)
        if (!effectNamed(effect.effect).linear())
            if (const double fall = fallWithout(whatIf.distortion, effect, Quantity::pressure); std::isfinite(fall))
                found.push_back({effect.effect, fall});
    std::stable_sort(found.begin(), found.end(), [](const Cause& a, const Cause& b) { return a.fall > b.fall; });
    if (found.empty())
        return text;
    const auto& first = found.front();
    if (first.fall >= all)
        text += "All of it is made by: " + effectNamed(first.effect).title() + ". " + effectNamed(first.effect).remedy()
                + " ";
    else if (first.fall >= some)
        text += (first.fall >= most ? "Most of it is made by: " : "The largest share is made by: ")
                + effectNamed(first.effect).title() + ", without which it would be " + figure(first.fall)
                + " dB lower. " + effectNamed(first.effect).remedy() + " ";
    else
        text += "No effect makes most of it: without any one of them it would fall by less than 1 dB. ";
    if (found.size() > 1 && found[1].fall >= some)
        text += "Next: " + effectNamed(found[1].effect).title() + ", " + figure(found[1].fall) + " dB. "
                + effectNamed(found[1].effect).remedy() + " ";
    if (found.back().fall <= -some)
        text += effectNamed(found.back().effect).title()
                + " works against the others: without it the distortion would rise by " + figure(-found.back().fall)
                + " dB. ";
    return text;
}

std::string compression(const WhatIf& whatIf)
{
    constexpr double some = 0.5;  // dB
    const auto* motion = find(whatIf.distortion.whole, Quantity::displacement);
    if (!motion || std::abs(motion->gainDb) < some)
        return "";
    return std::string("The cone moves ") + figure(std::abs(motion->gainDb))
           + (motion->gainDb < 0.0 ? " dB less" : " dB more") + " than its linear part would. ";
}

std::string limits(const StrokeLimits& stroke)
{
    const auto* first = stroke.tightest();
    if (!first || *first->stroke() > stroke.range)
        return "No limit of the stroke is met within the " + millimetres(stroke.range) + " that were measured. ";
    const auto side = !first->inward || !first->outward    ? first->inward ? "inward" : "outward"
                      : *first->inward == *first->outward  ? "either way"
                      : *first->inward == *first->stroke() ? "inward"
                                                           : "outward";
    return "The first limit of the stroke is met at " + millimetres(*first->stroke()) + " " + side + ", where the "
           + first->name + " " + first->criterion + ". ";
}

/// A figure that is worth a word: beyond its error, and large enough.
bool matters(const std::optional<Estimate>& estimate, double least)
{
    return estimate && std::abs(estimate->value) > least
           && !(std::abs(estimate->value) < 2.0 * estimate->standardError);
}

std::string symmetry(const StrokeLimits& stroke)
{
    constexpr double shareOfRange = 0.03, percent = 10.0;
    std::string text;
    if (matters(stroke.gapCentre, shareOfRange * stroke.range)) {
        const double offset = stroke.gapCentre->value;  // of the curve's middle from the coil's rest
        text += "Bl(x) is symmetric about " + placeText(offset, "m") + ": a coil that rests "
                + millimetres(std::abs(offset)) + " further " + (offset > 0.0 ? "outward" : "inward")
                + " would sit in the middle of the gap. ";
    }
    if (matters(stroke.stiffnessAsymmetry, percent))
        text += "At " + millimetres(stroke.range) + " the suspension is "
                + figure(std::abs(stroke.stiffnessAsymmetry->value), "%.0f") + " % stiffer "
                + (stroke.stiffnessAsymmetry->value > 0.0 ? "inward than outward. " : "outward than inward. ");
    return text;
}

}  // namespace

WhatIf whatIf(const Model& model, const Record& record, const Progress& progress)
{
    return {distortionByEffect(model, record, loudestSections(record), progress), strokeLimits(model)};
}

double addedDb(double evenDb, double oddDb)
{
    return 10.0 * std::log10(std::pow(10.0, evenDb / 10.0) + std::pow(10.0, oddDb / 10.0));
}

double distortionDb(const ChannelDistortion& channel) { return addedDb(channel.evenDb, channel.oddDb); }

double fallWithout(const DistortionByEffect& distortion, const EffectDistortion& effect, Quantity quantity)
{
    const auto *whole = find(distortion.whole, quantity), *without = find(effect.without, quantity);
    return whole && without ? distortionDb(*whole) - distortionDb(*without) : std::numeric_limits<double>::quiet_NaN();
}

std::string advice(const WhatIf& whatIf)
{
    auto text = causes(whatIf) + compression(whatIf) + limits(whatIf.stroke) + symmetry(whatIf.stroke);
    if (!text.empty())
        text.pop_back();
    return text;
}

}  // namespace excursion
