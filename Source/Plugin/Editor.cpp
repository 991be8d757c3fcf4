// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/Editor.h"

#include "Engine/Driver/ModelFile.h"
#include "Engine/Error.h"
#include "Plugin/Look.h"

#include <nlohmann/json.hpp>

namespace excursion::plugin {
namespace {

/// Whether a file says that it is a model.
bool holdsModel(const juce::File& file)
{
    if (!file.hasFileExtension("json") || file.getSize() > (1 << 26))
        return false;
    const auto document = nlohmann::json::parse(file.loadFileAsString().toStdString(), nullptr, false);
    return !document.is_object()
           || (document.value("format", "") != "excursion-measurement"
               && document.value("format", "") != "excursion-plan");
}

}  // namespace

Editor::Editor(Processor& processor, juce::AudioDeviceManager* devices)
    : AudioProcessorEditor(processor),
      owner_(processor),
      measure_(*this, devices != nullptr ? devices : standaloneDevices())
{
    for (std::size_t k = 0; k < tabs_.size(); ++k) {
        tabs_[k].setClickingTogglesState(false);
        tabs_[k].setConnectedEdges((k > 0 ? juce::Button::ConnectedOnLeft : 0)
                                   | (k + 1 < tabs_.size() ? juce::Button::ConnectedOnRight : 0));
        tabs_[k].setColour(juce::TextButton::buttonOnColourId, look::accent.darker(0.6f));
        tabs_[k].onClick = [this, k] { go(static_cast<PageName>(k)); };
        addAndMakeVisible(tabs_[k]);
        addChildComponent(pages_[k]);
    }
    cancel_.onClick = [this] {
        owner_.session().cancel();
        if (auto* measuring = measure_.measuring())
            measuring->cancel();
    };
    addAndMakeVisible(status_);
    addChildComponent(progress_);
    addChildComponent(cancel_);
    tell("Open, draw or measure a loudspeaker; or load a model on the last page.", false);
    go(owner_.session().findings() ? PageName::diagnose : PageName::measure);
    setResizable(true, true);
    setResizeLimits(1000, 680, 2600, 1900);
    setSize(1180, 760);
    update();
    startTimerHz(20);
}

Editor::~Editor() { stopTimer(); }

void Editor::go(PageName name)
{
    page_ = static_cast<std::size_t>(name);
    for (std::size_t k = 0; k < pages_.size(); ++k) {
        pages_[k]->setVisible(k == page_);
        tabs_[k].setToggleState(k == page_, juce::dontSendNotification);
    }
    resized();
}

void Editor::tell(const juce::String& text, bool trouble)
{
    status_.setColour(juce::Label::textColourId, trouble ? look::warning : look::dim);
    status_.setText(text, juce::dontSendNotification);
}

void Editor::use(const Model& model, const juce::String& from)
{
    try {
        owner_.setModel(model);
        tell("The model is from " + from + ".", false);
    } catch (const Error& error) {
        tell(words(error.what()), true);
    }
}

void Editor::load(const juce::File& file)
{
    if (!holdsModel(file)) {
        owner_.session().open(file.getFullPathName().toStdString());
        go(PageName::measure);
        return;
    }
    try {
        use(readModel(file.getFullPathName().toStdString()), file.getFileName());
        go(PageName::linearize);
    } catch (const Error& error) {
        tell(words(error.what()), true);
    }
}

void Editor::filesDropped(const juce::StringArray& files, int, int) { load(juce::File(files[0])); }

void Editor::update()
{
    const auto status = owner_.session().status();
    fraction_ = status.fraction;
    progress_.setVisible(status.busy);
    cancel_.setVisible(status.busy);
    if (status.words != said_) {
        said_ = status.words;
        tell(words(said_), status.trouble);
    }
    if (status.version != seen_) {
        seen_ = status.version;
        if (const auto findings = owner_.session().findings())
            for (auto* page : pages_)
                page->show(findings);
    }
    if (auto standstill = owner_.standstill(); standstill != standstill_) {
        standstill_ = std::move(standstill);
        tell(standstill_.empty() ? juce::String("The engine runs again.") : words(standstill_), !standstill_.empty());
    }
    // A host may have restored another state.
    if (const auto version = owner_.modelVersion(); version != shown_) {
        shown_ = version;
        linearize_.showModel(owner_.model());
    }
    pages_[page_]->tick();
}

void Editor::paint(juce::Graphics& g) { g.fillAll(look::background); }

void Editor::resized()
{
    auto area = getLocalBounds().reduced(14);
    auto head = area.removeFromTop(32);
    for (auto& tab : tabs_)
        tab.setBounds(head.removeFromLeft(130));
    area.removeFromTop(12);
    auto foot = area.removeFromBottom(26);
    cancel_.setBounds(foot.removeFromRight(80));
    foot.removeFromRight(8);
    progress_.setBounds(foot.removeFromRight(180).reduced(0, 3));
    foot.removeFromRight(8);
    status_.setBounds(foot);
    area.removeFromBottom(8);
    for (auto* page : pages_)
        page->setBounds(area);
}

}  // namespace excursion::plugin
