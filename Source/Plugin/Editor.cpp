// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/Editor.h"

#include "Engine/Driver/Catalogue.h"
#include "Engine/Driver/ModelFile.h"
#include "Engine/Error.h"
#include "Plugin/Look.h"

#include <cmath>

namespace excursion::plugin {

Editor::Editor(Processor& processor) : AudioProcessorEditor(processor), processor_(processor)
{
    name_.setFont(juce::Font(20.0f));
    for (auto* label : {&name_, &status_})
        addAndMakeVisible(label);
    drivers_.setTextWhenNothingSelected("Factory drivers");
    for (std::size_t k = 0; k < factoryDrivers().size(); ++k)
        drivers_.addItem(factoryDrivers()[k].title, static_cast<int>(k) + 1);
    drivers_.onChange = [this] {
        if (const int k = drivers_.getSelectedItemIndex(); k >= 0) {
            const auto& factory = factoryDrivers()[static_cast<std::size_t>(k)];
            use(modelFromText(factory.text, factory.title), "the factory");
        }
    };
    recipes_.setTextWhenNothingSelected("Recipes");
    for (std::size_t k = 0; k < factoryRecipes().size(); ++k)
        recipes_.addItem(factoryRecipes()[k].title, static_cast<int>(k) + 1);
    recipes_.onChange = [this] {
        if (const int k = recipes_.getSelectedItemIndex(); k >= 0) {
            const auto& factory = factoryRecipes()[static_cast<std::size_t>(k)];
            const auto recipe = recipeFromText(factory.text, factory.title);
            processor_.parameters().set(recipe);
            tell(recipe.words, false);
        }
    };
    mode_.addItemList(processor.parameters().mode().choices, 1);
    modeAttachment_ = std::make_unique<juce::ComboBoxParameterAttachment>(processor.parameters().mode(), mode_);
    load_.onClick = [this] { choose(); };
    for (juce::Component* component : std::initializer_list<juce::Component*> {&drivers_, &recipes_, &mode_, &load_, &excursion_, &voltage_})
        addAndMakeVisible(component);
    for (auto* parameter : processor.parameters().numbers()) {
        Dial dial {std::make_unique<juce::Label>(), std::make_unique<juce::Slider>(juce::Slider::LinearHorizontal, juce::Slider::TextBoxRight), nullptr};
        dial.title->setText(parameter->getName(40), juce::dontSendNotification);
        dial.slider->setTextValueSuffix(" " + parameter->getLabel());
        dial.attachment = std::make_unique<juce::SliderParameterAttachment>(*parameter, *dial.slider);
        addAndMakeVisible(*dial.title);
        addAndMakeVisible(*dial.slider);
        dials_.push_back(std::move(dial));
    }
    for (auto* parameter : processor.parameters().effects()) {
        Switch one {std::make_unique<juce::ToggleButton>(parameter->getName(80)), nullptr};
        one.attachment = std::make_unique<juce::ButtonParameterAttachment>(*parameter, *one.button);
        addAndMakeVisible(*one.button);
        switches_.push_back(std::move(one));
    }
    show(processor.model());
    tell("Drop a model (model.json) here, or choose a factory driver.", false);
    setResizable(true, true);
    setResizeLimits(820, 560, 2400, 1800);
    setSize(960, 640);
    startTimerHz(20);
}

Editor::~Editor() { stopTimer(); }

void Editor::tell(const juce::String& words, bool trouble)
{
    status_.setColour(juce::Label::textColourId, trouble ? look::warning : look::dim);
    status_.setText(words, juce::dontSendNotification);
}

void Editor::show(const Model& model)
{
    shown_ = juce::String::fromUTF8(model.name.c_str());
    name_.setText(shown_.isEmpty() ? "A model without a name" : shown_, juce::dontSendNotification);
    plots_.clear();
    for (auto& law : laws(model)) {
        plots_.push_back(std::make_unique<LawPlot>());
        plots_.back()->show(std::move(law));
        addAndMakeVisible(*plots_.back());
    }
    for (std::size_t k = 0; k < switches_.size(); ++k)
        switches_[k].button->setEnabled(model.has(catalogue()[k]->id()));
    resized();
}

void Editor::use(const Model& model, const juce::String& from)
{
    try {
        processor_.setModel(model);
        show(model);
        tell("The model is from " + from + ".", false);
    } catch (const Error& error) {
        tell(juce::String::fromUTF8(error.what()), true);
    }
}

void Editor::load(const juce::File& file)
{
    try {
        use(readModel(file.getFullPathName().toStdString()), file.getFileName());
    } catch (const Error& error) {
        tell(juce::String::fromUTF8(error.what()), true);
    }
}

void Editor::choose()
{
    chooser_ = std::make_unique<juce::FileChooser>("Load a model", juce::File(), "*.json");
    chooser_->launchAsync(juce::FileBrowserComponent::openMode | juce::FileBrowserComponent::canSelectFiles, [this](const juce::FileChooser& chosen) {
        if (chosen.getResult() != juce::File())
            load(chosen.getResult());
    });
}

void Editor::filesDropped(const juce::StringArray& files, int, int) { load(juce::File(files[0])); }

void Editor::timerCallback()
{
    const auto model = processor_.model();
    if (juce::String::fromUTF8(model.name.c_str()) != shown_)
        show(model);   // a host has restored another state
    const auto meters = processor_.take();
    const double range = measuredDisplacement(model), reach = std::isfinite(range) ? meters.displacement / range : 0.0;
    excursion_.show(reach, juce::String(1e3 * meters.displacement, 2) + " mm, " + juce::String(100.0 * reach, 0) + " % of what was measured",
                    meters.displacementExcess > 1e-3);
    voltage_.show(meters.voltage / processor_.parameters().recipe().voltageLimit, juce::String(meters.voltage, 1) + " V", meters.voltageExcess > 1e-3);
    if (meters.faults > faults_)
        tell("Something was not finite: the engine has started anew.", true);
    faults_ = meters.faults;
}

void Editor::paint(juce::Graphics& g) { g.fillAll(look::background); }

void Editor::resized()
{
    auto area = getLocalBounds().reduced(14);
    auto head = area.removeFromTop(30);
    load_.setBounds(head.removeFromRight(140));
    head.removeFromRight(8);
    drivers_.setBounds(head.removeFromRight(220));
    head.removeFromRight(8);
    recipes_.setBounds(head.removeFromRight(210));
    name_.setBounds(head);
    area.removeFromTop(8);
    status_.setBounds(area.removeFromBottom(26));
    auto left = area.removeFromLeft(juce::jmax(380, area.getWidth() * 2 / 5));
    area.removeFromLeft(12);
    mode_.setBounds(left.removeFromTop(30));
    left.removeFromTop(8);
    for (auto& dial : dials_) {
        auto row = left.removeFromTop(28);
        dial.title->setBounds(row.removeFromLeft(130));
        dial.slider->setBounds(row);
    }
    left.removeFromTop(8);
    for (auto& one : switches_)
        one.button->setBounds(left.removeFromTop(24));
    left.removeFromTop(12);
    excursion_.setBounds(left.removeFromTop(32));
    left.removeFromTop(6);
    voltage_.setBounds(left.removeFromTop(32));
    const int rows = juce::jmax(1, (static_cast<int>(plots_.size()) + 1) / 2), height = area.getHeight() / rows;
    for (std::size_t k = 0; k < plots_.size(); ++k) {
        const bool first = k % 2 == 0;
        const juce::Rectangle<int> cell(area.getX() + (first ? 0 : area.getWidth() / 2), area.getY() + static_cast<int>(k / 2) * height,
                                        area.getWidth() / 2, height);
        plots_[k]->setBounds(cell.reduced(2));
    }
}

} // namespace excursion::plugin
