// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/ExpectedDistortion.h"

#include "Engine/Document/Engineering.h"
#include "Engine/Error.h"
#include "Plugin/Text.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace excursion::plugin {
namespace {

constexpr auto whenEmpty = "empty";  // what a view shows then
constexpr auto pending = "The distortion to be expected is being computed.";

}  // namespace

ExpectedDistortion::ExpectedDistortion()
{
    words_.setFont(juce::Font(14.0f));
    picture_.getProperties().set(whenEmpty, pending);
}

void ExpectedDistortion::showModel(const AnyModel& model)
{
    const auto* box = std::get_if<LoadedBoxPointer>(&model);
    if (!box) {
        picture_.getProperties().set(whenEmpty, pending);
        return;
    }
    asked_ = {};
    const auto& played = (*box)->played;
    if (!played.rehearsal) {
        picture_.getProperties().set(whenEmpty, plugin::words(played.refusal));
        picture_.show({});
        tell("It plays; linearizing it would not help.");
        return;
    }
    const auto& gain = *played.rehearsal;
    show(gain.frequency, gain.before, gain.after, "Rehearsed distortion, as loud as it was fitted");
    tell("Distortion " + plugin::words(decibels(gain.beforeDb)) + ", linearized "
         + plugin::words(decibels(gain.afterDb)) + ": a gain of " + plugin::words(decibels(gain.gainDb())));
}

void ExpectedDistortion::followDriver(Processor& processor)
{
    const auto recipe = processor.parameters().recipe();
    if (auto question = std::pair {processor.modelVersion(), toJson(recipe).dump()}; question != asked_) {
        asked_ = std::move(question);
        forecast_.collect();  // of the question before
        const auto loaded = processor.model();
        forecast_.ask([model = withoutOff(loaded, recipe), controls = controlsOf(recipe, loaded),
                       volts = recipe.fullScale,
                       realTime = RealTimeOptions {.coupling = couplingOf(recipe)}](const Progress& progress) {
            try {
                return std::optional(predictDistortion(model, controls, volts, realTime, progress));
            } catch (const Error& error) {
                if (error.kind() == Error::Kind::cancelled)
                    throw;
                return std::optional<PredictedDistortion>();  // a model that cannot be run has none to tell
            }
        });
    }
    const auto answer = forecast_.collect().value_or(std::nullopt);
    if (!answer)
        return;
    show(answer->frequency, answer->before, answer->after, "Predicted distortion at 0 dBFS");
    tell("Distortion " + plugin::words(decibels(answer->beforeDb)) + ", linearized "
         + plugin::words(decibels(answer->afterDb)) + ", at " + plugin::words(engineering(answer->displacement, "m", 2))
         + " peak excursion");
}

void ExpectedDistortion::show(const std::vector<double>& frequency, const std::vector<double>& before,
                              const std::vector<double>& after, const std::string& title)
{
    Plot plot;
    plot.title = title;
    plot.x = {"frequency", "Hz", true, 0.0, 0.0, {}};
    const double least = *std::min_element(after.begin(), after.end()),
                 most = std::max(*std::max_element(before.begin(), before.end()),
                                 *std::max_element(after.begin(), after.end()));
    plot.y = {"over the signal",
              "dB",
              false,
              std::max(-180.0, 20.0 * std::floor(least / 20.0)),
              std::max(0.0, 20.0 * std::ceil(most / 20.0)),
              {}};
    plot.series = {{"as it is", Role::before, frequency, before, {}, {}, Series::Shape::line, 0},
                   {"linearized", Role::after, frequency, after, {}, {}, Series::Shape::line, 0}};
    picture_.show(std::move(plot));
}

}  // namespace excursion::plugin
