// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/IdentifyPage.h"

#include "Engine/Document/Engineering.h"
#include "Engine/Document/JsonText.h"
#include "Engine/Error.h"
#include "Plots/IdentifiedPlots.h"
#include "Plots/Words.h"
#include "Plugin/FillList.h"
#include "Plugin/Look.h"

#include <algorithm>

namespace excursion::plugin {
namespace {

constexpr int mostOrder = 20;

/// What the list of stabilizations offers behind "as it is".
constexpr StabilizingMethod methods[] {StabilizingMethod::mirror, StabilizingMethod::project, StabilizingMethod::delay,
                                       StabilizingMethod::decompose};

struct Outputs {
    std::vector<std::string> quantities;
    juce::StringArray titles, levels;
};

/// What a take has beside its input.
Outputs outputsOf(const Findings& findings)
{
    Outputs found;
    const auto add = [&found](Quantity quantity) {
        found.quantities.emplace_back(name(quantity));
        found.titles.add(words(capitalized(name(quantity))));
    };
    if (const auto* spectra = findings.take->asResponses()) {
        const auto* input = spectra->input();
        for (const auto& channel : spectra->channels)
            if (input != nullptr && channel.quantity != input->quantity)
                add(channel.quantity);
    } else if (const auto* take = findings.take->inTime()) {
        for (const auto& channel : take->channels)
            if (channel.quantity != take->input().quantity)
                add(channel.quantity);
        if (take->hasPeriods())
            for (const double level : take->excitation->levels)
                found.levels.add(words(nominal(level, "V")) + " rms");
    }
    if (found.levels.isEmpty())
        found.levels.add("the take");
    return found;
}

}  // namespace

IdentifyPage::IdentifyPage(Window& window) : Page(window)
{
    juce::StringArray orders {"Best of 1 to 8"};
    for (int order = 1; order <= mostOrder; ++order)
        orders.add("Order " + juce::String(order));
    fillList(order_, orders, 0);
    fillList(time_,
             {"Continuous time", "Discrete time", words("Fractional, \u03b1 free"), words("Fractional, \u03b1 =")}, 0);
    fillList(stabilizing_, {"As it is", "Mirrored poles", "Projected", "With a delay", "Stable part alone"}, 0);
    fillList(reducing_, {"As it is", "Pruned, refitted", "Balanced, truncated", "Poles and zeros"}, 0);
    fillList(degree_, {"Degree 2", "Degree 3", "Degree 4", "Degree 5"}, 1);
    output_.setTitle("Channel");
    level_.setTitle("Level");
    order_.setTitle("Order");
    time_.setTitle("Kind of model");
    stabilizing_.setTitle("Stabilize");
    reducing_.setTitle("Reduce");
    degree_.setTitle("Degree of the PNLSS");
    alpha_.setTitle(words("Order \u03b1 of differentiation"));
    reduced_.setTitle("Reduced to order");
    unstable_.setTitle("The model may be unstable");
    plane_.setTitle("Poles and zeros in the complex plane");
    time_.setTooltip(words("In s, in z, or in s^\u03b1"));
    unstable_.setTooltip("Poles may lie beyond the border of stability; stabilize it afterwards");
    stabilizing_.setTooltip("A stable model in place of an unstable one");
    reducing_.setTooltip("A smaller model in place of a large one");
    fit_.setTooltip("A polynomial state-space model that begins at the linear one shown here");
    linearize_.setTooltip("Rehearses the PNLSS, and plays it on the last page");
    alpha_.setRange(0.2, 1.2, 0.01);
    alpha_.setValue(0.9, juce::dontSendNotification);
    alpha_.setDoubleClickReturnValue(true, 0.9);
    reduced_.setRange(1.0, mostOrder, 1.0);
    for (auto* dial : {&alpha_, &reduced_})
        dial->setTextBoxStyle(juce::Slider::TextBoxRight, false, 44, 24);
    const auto title = [](juce::Label& label, const juce::String& text) {
        label.setText(text, juce::dontSendNotification);
        label.setFont(juce::Font(14.0f));
        label.setBorderSize({1, 0, 1, 0});
    };
    title(stabilizingTitle_, "Stabilize");
    title(reducingTitle_, "Reduce");
    title(degreeTitle_, "PNLSS");
    title(facts_, "Open or measure a take first.");
    title(pnlssFacts_, {});
    facts_.setTitle("The linear model");
    pnlssFacts_.setTitle("The polynomial model");
    gain_.getProperties().set("empty", "The measured response and that of the model are drawn here.");
    phase_.getProperties().set("empty", "Their phases.");
    roots_.getProperties().set("empty", "Poles and zeros, and the border of stability.");
    steps_.getProperties().set("empty", "The error of each order, and of each step of a PNLSS.");
    for (auto* plot : {&gain_, &phase_, &roots_, &steps_})
        plot->told = [this](const juce::String& text, bool trouble) { window_.tell(text, trouble); };
    time_.onChange = [this] { resized(); };
    identify_.onClick = [this] { identify(); };
    stabilizing_.onChange = reducing_.onChange = [this] { shape(); };
    reduced_.onValueChange = [this] { shape(); };
    plane_.onClick = [this] { draw(); };
    fit_.onClick = [this] { fit(); };
    linearize_.onClick = [this] {
        if (const auto pnlss = session().identification().pnlss) {
            const auto findings = session().findings();
            window_.linearizeWith(pnlss->document, "the page Identify", findings ? findings->fullScale : 0.0);
        }
    };
    save_.onClick = [this] { save(); };
    add({&output_,      &level_,         &order_,    &time_,    &alpha_,    &identify_,    &stabilizingTitle_,
         &stabilizing_, &reducingTitle_, &reducing_, &reduced_, &unstable_, &degreeTitle_, &degree_,
         &fit_,         &linearize_,     &save_,     &plane_,   &facts_,    &pnlssFacts_,  &gain_,
         &roots_,       &phase_,         &steps_});
    tick();
}

IdentifyWish IdentifyPage::wish() const
{
    IdentifyWish wish;
    if (const auto k = static_cast<std::size_t>(output_.getSelectedItemIndex()); k < outputs_.size())
        wish.ports.output = outputs_[k];
    wish.ports.level = level_.getNumItems() > 1 ? level_.getSelectedItemIndex() : -1;
    wish.order = order_.getSelectedItemIndex();
    wish.time = static_cast<ModelTime>(time_.getSelectedItemIndex());
    wish.alpha = alpha_.getValue();
    wish.unstable = unstable_.getToggleState();
    return wish;
}

ShapeWish IdentifyPage::shapeWish() const
{
    ShapeWish wish;
    if (const int k = stabilizing_.getSelectedItemIndex(); k > 0)
        wish.stabilizing = methods[k - 1];
    wish.reducing = static_cast<Reducing>(reducing_.getSelectedItemIndex());
    wish.order = static_cast<int>(reduced_.getValue());
    return wish;
}

void IdentifyPage::choose(const IdentifyWish& wish)
{
    if (const auto place = std::find(outputs_.begin(), outputs_.end(), wish.ports.output); place != outputs_.end())
        output_.setSelectedItemIndex(static_cast<int>(place - outputs_.begin()), juce::dontSendNotification);
    if (wish.ports.level >= 0)
        level_.setSelectedItemIndex(wish.ports.level, juce::dontSendNotification);
    order_.setSelectedItemIndex(wish.order, juce::dontSendNotification);
    time_.setSelectedItemIndex(static_cast<int>(wish.time), juce::dontSendNotification);
    alpha_.setValue(wish.alpha, juce::dontSendNotification);
    unstable_.setToggleState(wish.unstable, juce::dontSendNotification);
    resized();
}

void IdentifyPage::choose(const ShapeWish& wish)
{
    const auto place = wish.stabilizing ? std::find(std::begin(methods), std::end(methods), *wish.stabilizing)
                                              - std::begin(methods) + 1
                                        : 0;
    stabilizing_.setSelectedItemIndex(static_cast<int>(place), juce::dontSendNotification);
    reducing_.setSelectedItemIndex(static_cast<int>(wish.reducing), juce::dontSendNotification);
    if (wish.order > 0)
        reduced_.setValue(wish.order, juce::dontSendNotification);
}

void IdentifyPage::shape()
{
    if (!session().identification().linear)
        return;
    shaping_ = true;
    session().shape(shapeWish());
}

void IdentifyPage::fit() { session().fitPnlss({degree_.getSelectedItemIndex() + 2, 50}); }

void IdentifyPage::save()
{
    const auto models = session().identification();
    if (!models.linear)
        return;
    const auto document = models.pnlss ? models.pnlss->document : documentOf(*models.linear);
    chooser_ = std::make_unique<juce::FileChooser>(
        "Save the model", juce::File::getSpecialLocation(juce::File::userHomeDirectory).getChildFile("model.json"),
        "*.json");
    chooser_->launchAsync(juce::FileBrowserComponent::saveMode | juce::FileBrowserComponent::warnAboutOverwriting,
                          [this, document, pnlss = models.pnlss](const juce::FileChooser& chosen) {
                              const auto file = chosen.getResult();
                              if (file == juce::File())
                                  return;
                              try {
                                  writeJson(document, file.getFullPathName().toStdString());
                                  if (pnlss)
                                      session().noteSaved(pnlss);
                                  window_.tell("Wrote " + file.getFullPathName() + ".", false);
                              } catch (const Error& error) {
                                  window_.tell(words(error.what()), true);
                              }
                          });
}

void IdentifyPage::show(const std::shared_ptr<const Findings>& fresh)
{
    if (std::exchange(take_, fresh->take) == fresh->take)
        return;
    const auto found = outputsOf(*fresh);
    outputs_ = found.quantities;
    fillList(output_, found.titles, 0);
    fillList(level_, found.levels, found.levels.size() - 1);
    level_.setSelectedItemIndex(found.levels.size() - 1, juce::dontSendNotification);
    seen_ = noted_ = session().identification();
    follow();
}

/// That there is another model is a step of the history; while a dial is held, only where it is let go.
void IdentifyPage::note(const Identification& now)
{
    if (now == noted_ || reduced_.isMouseButtonDown(true))
        return;
    const auto sameBase = [](const StateSpace& one, const StateSpace& other) {
        return one.order() == other.order() && one.A == other.A;
    };
    const auto* what = "Identify";
    if (now.pnlss)
        what = "Fit a PNLSS";
    else if (now.linear && noted_.linear && sameBase(now.linear->base, noted_.linear->base))
        what = "Shape the model";
    window_.history().did(
        what, [this, before = noted_] { put(before); }, [this, now] { put(now); });
    noted_ = now;
}

void IdentifyPage::put(const Identification& models)
{
    session().put(models);
    seen_ = noted_ = models;
    follow();
}

/// The controls as the model that is shown was asked for.
void IdentifyPage::follow()
{
    if (const auto& linear = seen_.linear) {
        reduced_.setRange(1.0, std::max<double>(2.0, static_cast<double>(linear->base.order())), 1.0);
        choose(linear->asked);
        choose(linear->shape);
    }
    draw();
}

void IdentifyPage::tick()
{
    const bool idle = !session().status().busy;
    const auto now = session().identification();
    if (now != seen_) {
        const bool fresh = now.linear && (!seen_.linear || now.linear->shape.order == 0);
        seen_ = now;
        if (fresh && now.linear->shape.order == 0) {
            const double order = static_cast<double>(now.linear->base.order());
            reduced_.setRange(1.0, std::max(2.0, order), 1.0);
            reduced_.setValue(order, juce::dontSendNotification);
            choose(now.linear->shape);
        }
        draw();
    }
    if (idle) {
        note(now);
        // Where no shape came of what was asked for, the lists go back to that of the model which is shown.
        if (shaping_ && now.linear && !reduced_.isMouseButtonDown(true)) {
            choose(now.linear->shape);
            shaping_ = false;
        }
    }
    const bool linear = now.linear != nullptr, shapes = linear && (idle || shaping_);
    identify_.setEnabled(idle && take_ != nullptr && !outputs_.empty());
    stabilizing_.setEnabled(shapes);
    reducing_.setEnabled(shapes);
    reduced_.setEnabled(shapes && reducing_.getSelectedItemIndex() > 0);
    fit_.setEnabled(idle && linear);
    linearize_.setEnabled(idle && now.pnlss != nullptr);
    save_.setEnabled(idle && linear);
}

}  // namespace excursion::plugin
