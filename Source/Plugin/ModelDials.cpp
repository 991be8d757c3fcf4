// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/ModelDials.h"

#include "Engine/Loudspeaker/Catalogue.h"

#include <algorithm>

namespace excursion::plugin {

ModelDials::ModelDials(Parameters& parameters, History* history)
    : parameters_(parameters), couplingOrder_(parameters.couplingOrder(), history)
{
    for (auto* number : parameters_.numbers()) {
        dials_.emplace_back(std::make_unique<juce::Label>(), std::make_unique<NumberDial>(*number, history));
        dials_.back().first->setText(number->getName(40), juce::dontSendNotification);
        dials_.back().first->setFont(juce::Font(14.0f));
        if (number->paramID == "coupling")
            dials_.back().second->slider().setTooltip(
                "Where the high-pass of sound card and amplifier begins: with it the correction reckons, and so does "
                "the limit of the excursion");
    }
    for (auto* effect : parameters_.effects())
        switches_.push_back(std::make_unique<OnOffButton>(*effect, history));
}

std::vector<juce::Component*> ModelDials::parts()
{
    std::vector<juce::Component*> parts;
    const auto numbers = parameters_.numbers();
    for (std::size_t k = 0; k < dials_.size(); ++k) {
        parts.insert(parts.end(), {dials_[k].first.get(), &dials_[k].second->slider()});
        if (numbers[k]->paramID == "coupling")
            parts.push_back(&couplingOrder_.box());
    }
    for (auto& one : switches_)
        parts.push_back(&one->button());
    return parts;
}

void ModelDials::showModel(const AnyModel& model)
{
    const auto* driver = std::get_if<Model>(&model);
    const bool coil = hasCoil(model), moves = givesExcursion(model);
    const auto numbers = parameters_.numbers();
    for (std::size_t k = 0; k < dials_.size(); ++k) {
        const auto& id = numbers[k]->paramID;
        const bool shown = id == "displacementLimit" ? limitsExcursion(model)
                           : id == "margin"          ? moves
                           : id == "powerLimit"      ? coil
                           : id == "coilResistance"  ? !driver && coil
                                                     : true;
        dials_[k].first->setVisible(shown);
        dials_[k].second->slider().setVisible(shown);
    }
    // A switch of an effect that the model has not would do nothing.
    for (std::size_t k = 0; k < switches_.size(); ++k)
        switches_[k]->button().setVisible(driver && driver->has(catalogue()[k]->id()));
}

/// Whether there is a high-pass, which has an order.
bool ModelDials::statesAmplifier() const { return !couplingOf(parameters_.settings()).passesConstant(); }

bool ModelDials::follow()
{
    couplingOrder_.follow();
    for (auto& dial : dials_)
        dial.second->follow();
    for (auto& one : switches_)
        one->follow();
    return couplingOrder_.box().isVisible() != statesAmplifier();
}

/// The switches that are shown, two beside each other where both titles have room.
std::vector<std::pair<juce::ToggleButton*, juce::ToggleButton*>> ModelDials::rows(int width) const
{
    const auto halves = [width](const juce::ToggleButton& one) {
        return juce::Font(14.0f).getStringWidth(one.getButtonText()) + 28 <= width / 2;
    };
    std::vector<std::pair<juce::ToggleButton*, juce::ToggleButton*>> rows;
    for (const auto& one : switches_) {
        auto& button = one->button();
        if (!button.isVisible())
            continue;
        if (!rows.empty() && !rows.back().second && halves(*rows.back().first) && halves(button))
            rows.back().second = &button;
        else
            rows.emplace_back(&button, nullptr);
    }
    return rows;
}

int ModelDials::lines(int width) const
{
    return static_cast<int>(
        std::count_if(dials_.begin(), dials_.end(), [](const auto& dial) { return dial.first->isVisible(); })
        + std::ssize(rows(width)));
}

void ModelDials::place(juce::Rectangle<int>& area, int row)
{
    couplingOrder_.box().setVisible(statesAmplifier());
    const auto numbers = parameters_.numbers();
    for (std::size_t k = 0; k < dials_.size(); ++k) {
        auto& [title, dial] = dials_[k];
        if (!title->isVisible())
            continue;
        auto line = area.removeFromTop(row);
        title->setBounds(line.removeFromLeft(130));
        if (numbers[k]->paramID == "coupling" && couplingOrder_.box().isVisible())
            couplingOrder_.box().setBounds(line.removeFromRight(100).reduced(0, 1));
        dial->slider().setBounds(line);
    }
    area.removeFromTop(8);
    for (const auto& [first, second] : rows(area.getWidth())) {
        auto line = area.removeFromTop(juce::jmin(row, 26));
        first->setBounds(second ? line.removeFromLeft(line.getWidth() / 2) : line);
        if (second)
            second->setBounds(line);
    }
}

}  // namespace excursion::plugin
