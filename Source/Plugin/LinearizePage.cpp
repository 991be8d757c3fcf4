// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/LinearizePage.h"

#include "Engine/Document/Engineering.h"
#include "Engine/Error.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Linear/Response.h"
#include "Plots/Plots.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace excursion::plugin {

LinearizePage::LinearizePage(Window& window)
    : Page(window),
      processor_(window.processor()),
      mode_(processor_.parameters().mode(), &window.history()),
      couplingOrder_(processor_.parameters().couplingOrder(), &window.history()),
      target_(window),
      meters_(window)
{
    name_.setFont(juce::Font(19.0f));
    forecastWords_.setFont(juce::Font(14.0f));
    facts_.setFont(juce::Font(14.0f));
    facts_.setBorderSize({1, 0, 1, 0});
    facts_.setJustificationType(juce::Justification::topLeft);
    facts_.setTitle("What the model is");
    name_.setBorderSize({1, 0, 1, 0});
    distortion_.getProperties().set("empty", "The distortion to be expected is being computed.");
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
    distortion_.told = tell;
    target_.told = tell;
    target_.reshaped = [this] { resized(); };
    meters_.reshaped = [this] { resized(); };
    meters_.told = tell;
    add({&name_, &recipes_, &drivers_, &load_, &mode_.box(), &save_, &adapt_});
    for (auto* number : processor_.parameters().numbers()) {
        dials_.emplace_back(std::make_unique<juce::Label>(), std::make_unique<NumberDial>(*number, &window.history()));
        dials_.back().first->setText(number->getName(40), juce::dontSendNotification);
        dials_.back().first->setFont(juce::Font(14.0f));
        add({dials_.back().first.get(), &dials_.back().second->slider()});
        if (number->paramID == "coupling") {
            dials_.back().second->slider().setTooltip(
                "Where the high-pass of sound card and amplifier begins: with it the correction reckons, and so does "
                "the limit of the excursion");
            add({&couplingOrder_.box()});
        }
    }
    for (auto* effect : processor_.parameters().effects()) {
        switches_.push_back(std::make_unique<OnOffButton>(*effect, &window.history()));
        add({&switches_.back()->button()});
    }
    add({&meters_, &facts_, &target_, &laws_, &distortion_, &forecastWords_});
    showModel(processor_.anyModel());
}

void LinearizePage::showModel(const AnyModel& model)
{
    const auto* box = std::get_if<LoadedBoxPointer>(&model);
    box_ = box != nullptr ? *box : nullptr;
    showFactory(0);
    const bool coil = hasCoil(model), moves = givesExcursion(model);
    const auto numbers = processor_.parameters().numbers();
    for (std::size_t k = 0; k < dials_.size(); ++k) {
        const auto& id = numbers[k]->paramID;
        const bool shown = id == "displacementLimit" ? limitsExcursion(model)
                           : id == "margin"          ? moves
                           : id == "powerLimit"      ? coil
                           : id == "coilResistance"  ? box_ && coil
                                                     : true;
        dials_[k].first->setVisible(shown);
        dials_[k].second->slider().setVisible(shown);
    }
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
        dials_.front().second->enter(fullScale);
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
    distortion_.getProperties().set("empty", "The distortion to be expected is being computed.");
    // A switch of an effect that the model has not would do nothing.
    for (std::size_t k = 0; k < switches_.size(); ++k)
        switches_[k]->button().setVisible(model.has(catalogue()[k]->id()));
}

void LinearizePage::showBox(const PlayedBox& played)
{
    const auto& box = played.box;
    name_.setText(box.name.empty() ? juce::String("A model without a name") : words(box.name),
                  juce::dontSendNotification);
    for (auto& one : switches_)
        one->button().setVisible(false);
    asked_ = {};
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
    if (!played.rehearsal) {
        distortion_.getProperties().set("empty", words(played.refusal));
        distortion_.show({});
        forecastWords_.setText("It plays; linearizing it would not help.", juce::dontSendNotification);
        return;
    }
    const auto& gain = *played.rehearsal;
    showDistortion(gain.frequency, gain.before, gain.after, "Rehearsed distortion, as loud as it was fitted");
    forecastWords_.setText("Distortion " + words(decibels(gain.beforeDb)) + ", linearized "
                               + words(decibels(gain.afterDb)) + ": a gain of " + words(decibels(gain.gainDb())),
                           juce::dontSendNotification);
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

void LinearizePage::showDistortion(const std::vector<double>& frequency, const std::vector<double>& before,
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
    distortion_.show(std::move(plot));
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

/// What is to be expected at 0 dBFS, with the effects that are switched on.
void LinearizePage::showForecast()
{
    const auto recipe = processor_.parameters().recipe();
    if (box_) {
        forecast_.collect();  // of a driver before
        return;
    }
    if (targetPictured())
        return;
    if (auto question = std::pair {processor_.modelVersion(), toJson(recipe).dump()}; question != asked_) {
        asked_ = std::move(question);
        const auto loaded = processor_.model();
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
    showDistortion(answer->frequency, answer->before, answer->after, "Predicted distortion at 0 dBFS");
    forecastWords_.setText("Distortion " + words(decibels(answer->beforeDb)) + ", linearized "
                               + words(decibels(answer->afterDb)) + ", at "
                               + words(engineering(answer->displacement, "m", 2)) + " peak excursion",
                           juce::dontSendNotification);
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

/// Whether there is a high-pass, which has an order.
bool LinearizePage::statesAmplifier() const { return !couplingOf(processor_.parameters().settings()).passesConstant(); }

/// What a host has moved.
void LinearizePage::follow()
{
    mode_.follow();
    couplingOrder_.follow();
    if (couplingOrder_.box().isVisible() != statesAmplifier())
        resized();
    for (auto& dial : dials_)
        dial.second->follow();
    for (auto& one : switches_)
        one->follow();
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
    showForecast();
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
    std::vector<juce::ToggleButton*> shown;
    for (auto& one : switches_)
        if (one->button().isVisible())
            shown.push_back(&one->button());
    // Where the room is short, lines stand closer.
    const auto titled = [width = left.getWidth() / 2](const juce::ToggleButton& one) {
        return juce::Font(14.0f).getStringWidth(one.getButtonText()) + 28 <= width;
    };
    int lines = static_cast<int>(
        std::count_if(dials_.begin(), dials_.end(), [](const auto& dial) { return dial.first->isVisible(); }));
    for (std::size_t k = 0; k < shown.size(); ++lines)
        k += k + 1 < shown.size() && titled(*shown[k]) && titled(*shown[k + 1]) ? 2 : 1;
    const int told = facts_.isVisible() ? 116 : 0, rest = 28 + 4 * 8 + meters_.wantedHeight() + told,
              row = juce::jlimit(18, 28, (left.getHeight() - rest) / juce::jmax(1, lines));
    couplingOrder_.box().setVisible(statesAmplifier());
    auto modes = left.removeFromTop(28);
    if (!box_) {
        for (auto* button : {&adapt_, &save_}) {
            button->setBounds(modes.removeFromRight(72));
            modes.removeFromRight(8);
        }
    }
    mode_.box().setBounds(modes);
    left.removeFromTop(8);
    const auto numbers = processor_.parameters().numbers();
    for (std::size_t k = 0; k < dials_.size(); ++k) {
        auto& dial = dials_[k];
        if (!dial.first->isVisible())
            continue;
        auto line = left.removeFromTop(row);
        dial.first->setBounds(line.removeFromLeft(130));
        if (numbers[k]->paramID == "coupling" && couplingOrder_.box().isVisible())
            couplingOrder_.box().setBounds(line.removeFromRight(100).reduced(0, 1));
        dial.second->slider().setBounds(line);
    }
    left.removeFromTop(8);
    for (std::size_t k = 0; k < shown.size();) {
        auto line = left.removeFromTop(juce::jmin(row, 26));
        // Two beside each other where both titles have room.
        const bool two = k + 1 < shown.size() && titled(*shown[k]) && titled(*shown[k + 1]);
        shown[k++]->setBounds(two ? line.removeFromLeft(line.getWidth() / 2) : line);
        if (two)
            shown[k++]->setBounds(line);
    }
    left.removeFromTop(8);
    meters_.setBounds(left.removeFromTop(meters_.wantedHeight()));
    left.removeFromTop(8);
    facts_.setBounds(left.removeFromTop(juce::jmin(140, left.getHeight())));
    for (auto* part : std::initializer_list<juce::Component*> {&laws_, &distortion_, &forecastWords_})
        part->setVisible(!targetPictured());
    if (targetPictured()) {
        target_.setBounds(area);
        target_.resized();
        return;
    }
    target_.setBounds(area.removeFromTop(target_.head()));
    target_.resized();
    forecastWords_.setBounds(area.removeFromBottom(24));
    distortion_.setBounds(area.removeFromBottom(area.getHeight() * 9 / 20));
    laws_.setBounds(area);
}

}  // namespace excursion::plugin
