// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/LinearizePage.h"

#include "Engine/Document/Engineering.h"
#include "Engine/Linear/Response.h"
#include "Plots/Plots.h"

#include <algorithm>
#include <cmath>

namespace excursion::plugin {

LinearizePage::LinearizePage(Window& window)
    : Page(window),
      processor_(window.processor()),
      mode_(processor_.parameters().mode(), &window.history()),
      dials_(processor_.parameters(), &window.history()),
      target_(window),
      meters_(window)
{
    name_.setFont(juce::Font(19.0f));
    facts_.setFont(juce::Font(14.0f));
    facts_.setBorderSize({1, 0, 1, 0});
    facts_.setJustificationType(juce::Justification::topLeft);
    facts_.setTitle("What the model is");
    name_.setBorderSize({1, 0, 1, 0});
    drivers_.setTextWhenNothingSelected("Factory drivers");
    for (std::size_t k = 0; k < factoryDrivers().size(); ++k)
        drivers_.addItem(factoryDrivers()[k].title, static_cast<int>(k) + 1);
    drivers_.onChange = [this] {
        if (const int k = drivers_.getSelectedItemIndex(); k >= 0) {
            const auto& factory = factoryDrivers()[static_cast<std::size_t>(k)];
            window_.use(modelFromText(factory.text, factory.title), "the factory");
            if (processor_.anyModel().index() != 0 || processor_.model().name != factory.title)  // it was refused
                showFactory(shownDriver_);
        }
    };
    recipes_.setTextWhenNothingSelected("Recipes");
    for (std::size_t k = 0; k < factoryRecipes().size(); ++k)
        recipes_.addItem(factoryRecipes()[k].title, static_cast<int>(k) + 1);
    recipes_.onChange = [this] {
        if (const int k = recipes_.getSelectedItemIndex(); k >= 0) {
            const auto& factory = factoryRecipes()[static_cast<std::size_t>(k)];
            const auto recipe = recipeFromText(factory.text, factory.title);
            const auto put = [this](const Recipe& which, const Between& between) {
                processor_.parameters().choose(which, between);
                follow();
            };
            auto& parameters = processor_.parameters();
            window_.history().did(
                "Recipe", [put, before = parameters.recipe(), between = parameters.between()] { put(before, between); },
                [put, recipe] { put(recipe, {}); });
            put(recipe, {});
            window_.tell(words(recipe.words), false);
        }
    };
    load_.onClick = [this] { choose(); };
    adapt_.setTooltip("Refits what drifts with temperature and age, Re, Rms and K, to the take that is open: a short "
                      "recording will do");
    adapt_.onClick = [this] {
        window_.tell("The model is being adapted to the take.", false);
        const auto version = processor_.modelVersion();  // first: a model that comes in between is another one
        session().adapt(processor_.model(), version);
    };
    save_.setTooltip("Saves the model as a file, as after it was adapted");
    save_.setTitle("Save the model");
    save_.onClick = [this] { window_.saveModel(processor_.model()); };
    drivers_.setTitle("Factory drivers");
    recipes_.setTitle("Recipes");
    recipes_.setTooltip("Mode, limits and effects for a purpose");
    load_.setTooltip("Or drop the model's file anywhere on this window");
    const auto tell = [this](const juce::String& text, bool trouble) { window_.tell(text, trouble); };
    laws_.told = tell;
    distortion_.picture().told = tell;
    target_.told = tell;
    target_.reshaped = [this] { resized(); };
    meters_.reshaped = [this] { resized(); };
    meters_.told = tell;
    add({&name_, &recipes_, &drivers_, &load_, &mode_.box(), &save_, &adapt_});
    for (auto* part : dials_.parts())
        add({part});
    add({&meters_, &facts_, &target_, &laws_, &distortion_.picture(), &distortion_.words()});
    showModel(processor_.anyModel());
}

void LinearizePage::showModel(const AnyModel& model)
{
    const auto* box = std::get_if<LoadedBoxPointer>(&model);
    box_ = box != nullptr ? *box : nullptr;
    showFactory(0);
    dials_.showModel(model);
    distortion_.showModel(model);
    facts_.setVisible(box_ || followed_ == processor_.modelVersion());
    adapt_.setVisible(!box_);
    save_.setVisible(!box_);
    meters_.showModel(model);
    if (box_)
        showBox(box_->played);
    else
        showDriver(std::get<Model>(model));
    resized();
}

/// @param id  of a factory driver in its list; 0: none of them
void LinearizePage::showFactory(int id)
{
    shownDriver_ = id;
    drivers_.setSelectedId(id, juce::dontSendNotification);
}

void LinearizePage::turnOn(double fullScale)
{
    if (fullScale > 0.0)  // first, as the limits that come with the mode are told in volts
        dials_.enterFullScale(fullScale);
    mode_.follow();
    if (processor_.parameters().settings().mode == Mode::bypass)
        mode_.box().setSelectedItemIndex(static_cast<int>(Mode::linearize), juce::sendNotificationSync);
}

void LinearizePage::showDriver(const Model& model)
{
    name_.setText(model.name.empty() ? juce::String("A model without a name") : words(model.name),
                  juce::dontSendNotification);
    const auto& drivers = factoryDrivers();
    const auto named = std::find_if(drivers.begin(), drivers.end(),
                                    [&](const auto& factory) { return factory.title == model.name; });
    showFactory(named == drivers.end() ? 0 : static_cast<int>(named - drivers.begin()) + 1);
    auto plots = effectPlots(model);
    for (auto& plot : plots)
        plot.key = false;
    laws_.show(std::move(plots));
}

void LinearizePage::showBox(const PlayedBox& played)
{
    const auto& box = played.box;
    name_.setText(box.name.empty() ? juce::String("A model without a name") : words(box.name),
                  juce::dontSendNotification);
    showFacts();
    Plot response;
    response.title = "Linear part, where it was fitted";
    response.x = {"frequency", "Hz", true, 0.0, 0.0, {}};
    response.y = {box.output + " over " + box.input, "dB", false, 0.0, 0.0, {}};
    response.key = false;
    std::vector<double> frequency, level;
    const double to = std::min(box.stimulus.highest(), 0.49 * box.linear.sampleRate);
    for (double f = box.stimulus.lowest(); f <= to; f *= std::exp2(1.0 / 24.0))
        frequency.push_back(f);
    for (const auto& gain : respond(box.linear, frequency))
        level.push_back(20.0 * std::log10(std::abs(gain(0, 0))));
    response.series = {{"linear part", Role::model, frequency, level, {}, {}, Series::Shape::line, 0}};
    laws_.show({response});
}

/// What the model is, and what is protected, which depends on what a person knows of the coil.
void LinearizePage::showFacts()
{
    const auto& box = box_->played.box;
    const std::string unit = box.input == "voltage" ? "V" : box.input == "force" ? "N" : "";
    const auto kind = words(box.kind);
    facts_.setText(kind.substring(0, 1).toUpperCase() + kind.substring(1) + ": " + words(box.output) + " from "
                       + words(box.input) + " at " + words(nominal(box.linear.sampleRate, "Hz")) + ".\nFitted with "
                       + words(engineering(box.stimulus.rms, unit, 3)) + " rms, "
                       + words(engineering(box.stimulus.lowest(), "Hz", 2)) + " to "
                       + words(engineering(box.stimulus.highest(), "Hz", 2)) + "; as loud it is heard.\n"
                       + words(protectionOf(box_->played, processor_.parameters().settings().coilResistance)),
                   juce::dontSendNotification);
}

void LinearizePage::choose()
{
    chooser_ = std::make_unique<juce::FileChooser>("Load a model", juce::File(), "*.json");
    chooser_->launchAsync(juce::FileBrowserComponent::openMode | juce::FileBrowserComponent::canSelectFiles,
                          [this](const juce::FileChooser& chosen) {
                              if (chosen.getResult() == juce::File())
                                  return;
                              window_.useFile(chosen.getResult());
                          });
}

/// A model that has followed the take takes over, as a step that can be taken back.
void LinearizePage::useAdapted()
{
    const auto adapted = session().takeAdapted();
    if (!adapted)
        return;
    if (adapted->version != processor_.modelVersion()) {
        window_.tell("Another model was loaded meanwhile, and stays. The one before: " + words(adapted->words), false);
        return;
    }
    window_.use(adapted->model, "its last take");
    if (adapted->version == processor_.modelVersion())
        return;  // it cannot be run, which has been told
    followed_ = processor_.modelVersion();
    facts_.setText("Since it was fitted: " + words(adapted->words), juce::dontSendNotification);
    window_.tell(words(adapted->words), false);
}

/// What a host has moved.
void LinearizePage::follow()
{
    mode_.follow();
    if (dials_.follow())
        resized();
    // A list that has been opened is without a choice until one is made; its change may still be on the way.
    if (drivers_.isDismissed())
        drivers_.setSelectedId(shownDriver_, juce::dontSendNotification);
    const auto title = words(processor_.parameters().recipe().title);
    if (recipes_.isPopupActive() || (title == shownRecipe_ && !recipes_.isDismissed()))
        return;
    shownRecipe_ = title;
    if (title.isEmpty())
        recipes_.setSelectedId(0, juce::dontSendNotification);
    else if (title != recipes_.getText())
        recipes_.setText(title, juce::dontSendNotification);
}

void LinearizePage::tick()
{
    follow();
    useAdapted();
    adapt_.setEnabled(session().findings() != nullptr && !session().status().busy);
    meters_.tick();
    if (box_)
        showFacts();
    target_.tick();
    if (!box_ && !target_.pictured())
        distortion_.followDriver(processor_);
}

void LinearizePage::resized()
{
    auto area = getLocalBounds();
    auto head = area.removeFromTop(28);
    const bool wide = getWidth() >= 960;
    load_.setBounds(head.removeFromRight(130));
    head.removeFromRight(8);
    drivers_.setBounds(head.removeFromRight(wide ? 220 : 180));
    head.removeFromRight(8);
    recipes_.setBounds(head.removeFromRight(wide ? 220 : 190));
    head.removeFromRight(8);
    name_.setBounds(head);
    area.removeFromTop(8);
    auto left = area.removeFromLeft(juce::jmax(376, area.getWidth() * 2 / 5));
    area.removeFromLeft(12);
    // Where the room is short, lines stand closer.
    const int told = facts_.isVisible() ? 116 : 0, rest = 28 + 4 * 8 + meters_.wantedHeight() + told,
              row = juce::jlimit(18, 28, (left.getHeight() - rest) / juce::jmax(1, dials_.lines(left.getWidth())));
    auto modes = left.removeFromTop(28);
    if (!box_) {
        for (auto* button : {&adapt_, &save_}) {
            button->setBounds(modes.removeFromRight(72));
            modes.removeFromRight(8);
        }
    }
    mode_.box().setBounds(modes);
    left.removeFromTop(8);
    dials_.place(left, row);
    left.removeFromTop(8);
    meters_.setBounds(left.removeFromTop(meters_.wantedHeight()));
    left.removeFromTop(8);
    facts_.setBounds(left.removeFromTop(juce::jmin(140, left.getHeight())));
    for (auto* part : std::initializer_list<juce::Component*> {&laws_, &distortion_.picture(), &distortion_.words()})
        part->setVisible(!target_.pictured());
    if (target_.pictured()) {
        target_.setBounds(area);
        target_.resized();
        return;
    }
    target_.setBounds(area.removeFromTop(target_.head()));
    target_.resized();
    distortion_.words().setBounds(area.removeFromBottom(24));
    distortion_.picture().setBounds(area.removeFromBottom(area.getHeight() * 9 / 20));
    laws_.setBounds(area);
}

}  // namespace excursion::plugin
