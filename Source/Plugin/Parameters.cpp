// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/Parameters.h"

#include "Engine/Driver/Catalogue.h"
#include "Plugin/Text.h"

#include <cmath>

namespace excursion::plugin {
namespace {

constexpr int versionHint = 1;

juce::AudioParameterFloat* number(juce::AudioProcessor& processor, const char* id, const char* title, const char* unit, float least, float most,
                                  float step, float centre, float value)
{
    juce::NormalisableRange<float> range(least, most, step);
    range.setSkewForCentre(centre);
    auto* parameter = new juce::AudioParameterFloat({id, versionHint}, title, range, value, juce::AudioParameterFloatAttributes().withLabel(unit));
    processor.addParameter(parameter);
    return parameter;
}

/// The parameter's number without what the way through a float has added: a whole number of steps.
double exactly(const juce::AudioParameterFloat& parameter)
{
    const double perUnit = std::round(1.0 / static_cast<double>(parameter.range.interval));
    return std::round(static_cast<double>(parameter.get()) * perUnit) / perUnit;
}

} // namespace

Parameters::Parameters(juce::AudioProcessor& processor)
{
    juce::StringArray titles;
    for (const auto which : modes)
        titles.add(words(title(which)));
    mode_ = new juce::AudioParameterChoice({"mode", versionHint}, "Mode", titles, 0);
    processor.addParameter(mode_);
    fullScale_ = number(processor, "fullScale", "Volts at 0 dBFS", "V", 0.01f, 200.0f, 0.01f, 10.0f, 10.0f);
    amount_ = number(processor, "amount", "Amount", "%", 0.0f, 100.0f, 0.1f, 50.0f, 100.0f);
    displacementLimit_ = number(processor, "displacementLimit", "Excursion limit", "%", 5.0f, 400.0f, 0.1f, 100.0f, 100.0f);
    voltageLimit_ = number(processor, "voltageLimit", "Voltage limit", "V", 0.01f, 1000.0f, 0.01f, 30.0f, 100.0f);
    trim_ = number(processor, "trim", "Output trim", "dB", -60.0f, 24.0f, 0.1f, 0.0f, 0.0f);
    for (const auto* effect : catalogue()) {
        auto* on = new juce::AudioParameterBool({"effect-" + words(effect->id()), versionHint}, words(effect->title()), true);
        processor.addParameter(on);
        on->addListener(this);
        effects_.push_back(on);
    }
}

Parameters::~Parameters()
{
    for (auto* on : effects_)
        on->removeListener(this);
}

Recipe Parameters::recipe() const
{
    Recipe recipe;
    recipe.mode = modes[static_cast<std::size_t>(mode_->getIndex())];
    recipe.fullScale = exactly(*fullScale_);
    recipe.amount = exactly(*amount_) / 100.0;
    recipe.displacementLimit = exactly(*displacementLimit_) / 100.0;
    recipe.voltageLimit = exactly(*voltageLimit_);
    recipe.trimDb = exactly(*trim_);
    for (std::size_t k = 0; k < effects_.size(); ++k)
        if (!effects_[k]->get())
            recipe.off.push_back(catalogue()[k]->id());
    return recipe;
}

void Parameters::set(const Recipe& recipe)
{
    *mode_ = static_cast<int>(recipe.mode);
    *fullScale_ = static_cast<float>(recipe.fullScale);
    *amount_ = static_cast<float>(100.0 * recipe.amount);
    *displacementLimit_ = static_cast<float>(100.0 * recipe.displacementLimit);
    *voltageLimit_ = static_cast<float>(recipe.voltageLimit);
    *trim_ = static_cast<float>(recipe.trimDb);
    for (std::size_t k = 0; k < effects_.size(); ++k)
        *effects_[k] = std::find(recipe.off.begin(), recipe.off.end(), catalogue()[k]->id()) == recipe.off.end();
}

ChainControls Parameters::controls(double measuredDisplacement) const
{
    ChainControls controls;
    controls.mode = modes[static_cast<std::size_t>(mode_->getIndex())];
    controls.fullScale = fullScale_->get();
    controls.trim = std::pow(10.0, 0.05 * static_cast<double>(trim_->get()));
    controls.linearization.amount = 0.01 * static_cast<double>(amount_->get());
    controls.linearization.displacementLimit = 0.01 * static_cast<double>(displacementLimit_->get()) * measuredDisplacement;
    controls.linearization.voltageLimit = voltageLimit_->get();
    return controls;
}

} // namespace excursion::plugin
