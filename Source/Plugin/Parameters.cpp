// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/Parameters.h"

#include "Engine/Loudspeaker/Catalogue.h"
#include "Plugin/Text.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace excursion::plugin {

ChainControls chainControls(const Settings& settings, double measuredDisplacement)
{
    return {settings.mode, settings.fullScale, std::pow(10.0, 0.05 * settings.trimDb),
            controlsOf(settings, measuredDisplacement)};
}

Parameters::Parameters(juce::AudioProcessor& processor)
{
    const Settings first;
    const auto added = [&](auto* parameter) {
        processor.addParameter(parameter);
        return parameter;
    };
    const auto number = [&added](const char* id, const char* title, const Number::Scale& scale, double value) {
        return added(new Number(id, title, scale, value));
    };
    juce::StringArray titles;
    for (const auto which : modes)
        titles.add(words(title(which)));
    mode_ = added(new Choice("mode", "Mode", titles));
    fullScale_ = number("fullScale", "Volts at 0 dBFS", {Settings::fullScales, 100, 10.0, 1.0, "V"}, first.fullScale);
    amount_ = number("amount", "Amount", {Settings::amounts, 1000, 0.5, 100.0, "%"}, first.amount);
    displacementLimit_ = number("displacementLimit", "Excursion limit",
                                {Settings::displacements, 1000, 1.0, 100.0, "%"}, first.displacementLimit);
    voltageLimit_ = number("voltageLimit", "Voltage limit", {Settings::voltages, 100, 30.0, 1.0, "V"},
                           first.voltageLimit);
    trim_ = number("trim", "Output trim", {Settings::trims, 10, 0.0, 1.0, "dB"}, first.trimDb);
    // Later ones stand behind, so that the earlier ones keep their places.
    constexpr std::size_t firstEffects = 6, secondEffects = 13;
    const auto switchOf = [&](std::size_t k) {
        const auto& effect = *catalogue()[k];
        effects_.push_back(added(new OnOff("effect-" + words(effect.id()), words(effect.title()))));
    };
    for (std::size_t k = 0; k < firstEffects; ++k)
        switchOf(k);
    powerLimit_ = number("powerLimit", "Power limit", {Settings::powers, 100, 30.0, 1.0, "W", "", "no limit"},
                         first.powerLimit);
    margin_ = number("margin", "Model margin", {Settings::margins, 1000, 0.15, 100.0, "%"}, first.margin);
    for (std::size_t k = firstEffects; k < secondEffects; ++k)
        switchOf(k);
    target_ = added(new Choice(
        "target", "Target",
        {"Own linear part", "New resonance", "Closed box", "Flat band", "Gains of a file", "Response of a file"}));
    targetF0_ = number("targetF0", "Target f0", {Settings::targetFrequencies, 10, 100.0, 1.0, "Hz"},
                       first.target.frequency);
    targetQ_ = number("targetQ", "Target Q", {Settings::targetQualities, 100, 0.8, 1.0, ""}, first.target.quality);
    targetVolume_ = number("targetVolume", "Target box", {Settings::targetVolumes, 10000, 0.03, 1000.0, "l"},
                           first.target.volume);
    coilResistance_ = number("coilResistance", "Coil resistance",
                             {Settings::resistances, 100, 8.0, 1.0, "ohm", "not known"}, first.coilResistance);
    targetLow_ = number("targetLow", "Target from", {Settings::targetEnds, 10, 300.0, 1.0, "Hz"}, first.target.low);
    targetHigh_ = number("targetHigh", "Target to", {Settings::targetEnds, 10, 1000.0, 1.0, "Hz"}, first.target.high);
    coupling_ = number("coupling", "Amplifier high-pass", {Settings::couplings, 10, 3.0, 1.0, "Hz", "no high-pass"},
                       first.coupling);
    couplingOrder_ = added(new Choice("couplingOrder", "Amplifier order", {"1st order", "2nd order"}));
    for (std::size_t k = secondEffects; k < catalogue().size(); ++k)
        switchOf(k);
}

Settings Parameters::settings() const
{
    Settings settings;
    settings.mode = modes[static_cast<std::size_t>(mode_->getIndex())];
    settings.fullScale = fullScale_->get();
    settings.amount = amount_->get();
    settings.displacementLimit = displacementLimit_->get();
    settings.voltageLimit = voltageLimit_->get();
    settings.powerLimit = powerLimit_->get();
    settings.margin = margin_->get();
    settings.coilResistance = coilResistance_->get();
    settings.trimDb = trim_->get();
    settings.coupling = coupling_->get();
    settings.couplingOrder = 1 + couplingOrder_->getIndex();
    settings.target = {static_cast<Target::Kind>(target_->getIndex()), targetF0_->get(), targetQ_->get(),
                       targetVolume_->get()};
    settings.target.low = targetLow_->get();
    settings.target.high = targetHigh_->get();
    for (std::size_t k = 0; k < curve_.size(); ++k)
        settings.target.curve[k] = curve_[k].load(std::memory_order_relaxed);
    return settings;
}

bool Parameters::read(Settings& into) const
{
    const auto before = beginsAndEnds_.load(std::memory_order_acquire);
    const auto now = settings();
    std::atomic_thread_fence(std::memory_order_acquire);
    const bool whole = before % 2 == 0 && beginsAndEnds_.load(std::memory_order_relaxed) == before;
    if (whole)
        into = now;
    return whole;
}

ChainControls Parameters::controls(double measuredDisplacement) const
{
    return chainControls(settings(), measuredDisplacement);
}

std::uint64_t Parameters::switches() const
{
    std::uint64_t bits = 0;
    for (std::size_t k = 0; k < effects_.size(); ++k)
        bits |= std::uint64_t {effects_[k]->get()} << k;
    return bits;
}

Recipe Parameters::recipe() const
{
    const std::lock_guard lock(mutex_);  // a whole one, not part of one that is being set
    Recipe recipe {settings(), {}, {}, {}};
    for (std::size_t k = 0; k < effects_.size(); ++k)
        if (!effects_[k]->get())
            recipe.off.push_back(catalogue()[k]->id());
    recipe.title = title_;
    recipe.words = words_;
    return recipe;
}

Between Parameters::between() const
{
    Between found;
    const auto look = [&found](const Stepped& parameter) {
        if (const float sent = parameter.getValue(); sent != parameter.step(sent))
            found[parameter.paramID.toStdString()] = static_cast<double>(sent);
    };
    look(*mode_);
    look(*target_);
    look(*couplingOrder_);
    for (const auto* effect : effects_)
        look(*effect);
    return found;
}

/// While it lives a recipe is being set. Nobody is called meanwhile: who is called may ask for the recipe, or set
/// another.
class Parameters::Setting {
public:
    explicit Setting(Parameters& parameters) : alone_(parameters.mutex_), parameters_(parameters)
    {
        parameters_.beginsAndEnds_.fetch_add(1, std::memory_order_relaxed);
        std::atomic_thread_fence(std::memory_order_release);
    }
    Setting(const Setting&) = delete;
    Setting& operator=(const Setting&) = delete;
    ~Setting() { parameters_.beginsAndEnds_.fetch_add(1, std::memory_order_release); }

private:
    std::lock_guard<std::mutex> alone_;
    Parameters& parameters_;
};

void Parameters::storeCurve(const ThirdOctaves& curve)
{
    for (std::size_t k = 0; k < curve_.size(); ++k)
        curve_[k].store(curve[k], std::memory_order_relaxed);
}

void Parameters::setCurve(const ThirdOctaves& curve)
{
    const Setting setting(*this);
    storeCurve(curve);
}

void Parameters::store(const Recipe& recipe, const Between& between)
{
    const Setting setting(*this);
    // The recipe has the word: a number that stands for anything else is none.
    const auto put = [&between](Stepped& parameter, float step) {
        const auto found = between.find(parameter.paramID.toStdString());
        const float sent = found != between.end() ? static_cast<float>(found->second) : step;
        parameter.setValue(parameter.step(sent) == step ? sent : step);
    };
    put(*mode_, mode_->proportionOf(static_cast<int>(recipe.mode)));
    fullScale_->store(recipe.fullScale);
    amount_->store(recipe.amount);
    displacementLimit_->store(recipe.displacementLimit);
    voltageLimit_->store(recipe.voltageLimit);
    powerLimit_->store(recipe.powerLimit);
    margin_->store(recipe.margin);
    coilResistance_->store(recipe.coilResistance);
    trim_->store(recipe.trimDb);
    coupling_->store(recipe.coupling);
    put(*couplingOrder_, couplingOrder_->proportionOf(recipe.couplingOrder - 1));
    put(*target_, target_->proportionOf(static_cast<int>(recipe.target.kind)));
    targetF0_->store(recipe.target.frequency);
    targetQ_->store(recipe.target.quality);
    targetVolume_->store(recipe.target.volume);
    targetLow_->store(recipe.target.low);
    targetHigh_->store(recipe.target.high);
    storeCurve(recipe.target.curve);
    for (std::size_t k = 0; k < effects_.size(); ++k)
        put(*effects_[k],
            std::find(recipe.off.begin(), recipe.off.end(), catalogue()[k]->id()) == recipe.off.end() ? 1.0f : 0.0f);
    title_ = recipe.title;
    words_ = recipe.words;
}

/// Calls with each parameter.
template <class Visit>
void Parameters::visit(const Visit& each) const
{
    each(*mode_);
    for (auto* number : numbers())
        each(*number);
    each(*target_);
    for (auto* number : targetNumbers())
        each(*number);
    each(*couplingOrder_);
    for (auto* effect : effects_)
        each(*effect);
}

void Parameters::set(const Recipe& recipe, const Between& between)
{
    store(recipe, between);
    visit([](auto& parameter) { parameter.tell(); });
}

void Parameters::choose(const Recipe& recipe, const Between& between)
{
    std::vector<float> before;
    visit([&](auto& parameter) { before.push_back(parameter.getValue()); });
    store(recipe, between);
    auto value = before.begin();
    visit([&](auto& parameter) {
        if (parameter.getValue() == *value++)
            return;
        parameter.beginChangeGesture();
        parameter.tell();
        parameter.endChangeGesture();
    });
}

}  // namespace excursion::plugin
