// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/Editor.h"

#include "Plugin/Look.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace excursion::plugin {

Editor::Editor(Processor& processor, juce::AudioDeviceManager* devices)
    : AudioProcessorEditor(processor),
      owner_(processor),
      measure_(*this, devices != nullptr ? devices : standaloneDevices())
{
    look_->use(preferences_.theme);
    setLookAndFeel(&*look_);
    setTitle("Excursion");
    setWantsKeyboardFocus(true);
    addAndMakeVisible(body_);
    int order = 0;
    const auto add = [this, &order](juce::Component& part, const juce::String& tip) {
        part.setExplicitFocusOrder(++order);
        if (auto* client = dynamic_cast<juce::SettableTooltipClient*>(&part); client != nullptr && tip.isNotEmpty())
            client->setTooltip(tip);
        body_.addAndMakeVisible(part);
    };
    for (std::size_t k = 0; k < tabs_.size(); ++k) {
        tabs_[k].setClickingTogglesState(false);
        tabs_[k].setConnectedEdges((k > 0 ? juce::Button::ConnectedOnLeft : 0)
                                   | (k + 1 < tabs_.size() ? juce::Button::ConnectedOnRight : 0));
        tabs_[k].setTitle(tabs_[k].getButtonText() + " page");
        tabs_[k].onClick = [this, k] { go(static_cast<PageName>(k)); };
        add(tabs_[k], "Ctrl+" + juce::String(static_cast<int>(k) + 1));
        pages_[k]->setTitle(tabs_[k].getButtonText());
    }
    undo_.onClick = [this] { undo(); };
    redo_.onClick = [this] { redo(); };
    view_.onClick = [this] { showView(); };
    view_.setTitle("View: scale, theme, keys");
    cancel_.onClick = [this] {  // what is shown; what sounds comes first
        if (auto* measuring = measure_.measuring(); measuring != nullptr && measuring->running()) {
            measuring->cancel();
            return;
        }
        owner_.session().cancel();
        if (owner_.rehearsing().status().busy) {
            owner_.rehearsing().cancel();
            tell("Cancelled.", false);
        }
    };
    add(undo_, "Ctrl+Z");
    add(redo_, "Ctrl+Shift+Z");
    add(view_, "Scale, theme and keys");
    for (auto* page : pages_) {
        add(*page, {});
        page->setVisible(false);
    }
    add(status_, {});
    add(progress_, {});
    add(cancel_, "Stops what is under way");
    status_.setFont(juce::Font(13.5f));
    status_.setBorderSize({1, 0, 1, 0});  // in line with what stands above
    status_.setTitle("Status");
    progress_.setTitle("Progress");
    progress_.setVisible(false);
    cancel_.setVisible(false);
    addAndMakeVisible(ring_);
    failures_ = owner_.session().status().failures;  // another window has told them
    rehearsed_ = owner_.rehearsing().status().version;
    tell("Open, draw or measure a loudspeaker; or load a model on the last page.", false);
    go(owner_.session().findings() ? PageName::diagnose : PageName::measure);
    setResizable(true, true);
    setScale(preferences_.scale);
    const auto screen = room();
    constexpr int width = 1180, height = 760;
    const bool known = preferences_.width > 0 && preferences_.height > 0;
    // As it was closed, or with room to spare, but never larger than the screen lets it be.
    setSize(std::min(screen.getWidth(), known ? preferences_.width : std::max(width, screen.getWidth() * 2 / 3)),
            std::min(screen.getHeight(), known ? preferences_.height : std::max(height, screen.getHeight() * 3 / 4)));
    juce::Desktop::getInstance().addDarkModeSettingListener(this);
    update();
    startTimerHz(20);
}

Editor::~Editor()
{
    stopTimer();
    juce::Desktop::getInstance().removeDarkModeSettingListener(this);
    keep();
    setLookAndFeel(nullptr);
}

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
    look::setTone(status_, trouble ? look::Tone::warning : look::Tone::dim);
    status_.setText(text, juce::dontSendNotification);
    status_.setTooltip(text);
}

void Editor::show(const std::shared_ptr<const Findings>& findings)
{
    noteLadder(findings);
    for (auto* page : pages_)
        page->show(findings);
}

void Editor::update()
{
    hearAnswer();
    const auto status = owner_.session().status();
    const auto rehearsal = owner_.rehearsing().status();
    auto* measuring = measure_.measuring();
    const bool measures = measuring != nullptr && measuring->running(),
               busy = status.busy || rehearsal.busy || measures;
    fraction_ = measures ? measuring->fraction() : status.busy ? status.fraction : rehearsal.fraction;
    progress_.setVisible(busy);
    cancel_.setVisible(busy);
    const double now = 1e-3 * juce::Time::getMillisecondCounterHiRes();
    if (status.failures != failures_) {  // stays for some seconds; later words wait
        failures_ = status.failures;
        tell(words(status.failure), true);
        said_ = status.words;
        heldUntil_ = now + toldFor;
    } else if (status.words != said_ && now > heldUntil_) {
        said_ = status.words;
        tell(words(said_), status.trouble);
    }
    if (status.version != seen_) {
        seen_ = status.version;
        if (const auto findings = owner_.session().findings())
            show(findings);
    }
    if (!status.busy && std::exchange(laddering_, false))
        history_.failed();  // what it asked the ladder for was cancelled, or went wrong
    if (auto standstill = owner_.standstill(); standstill != standstill_) {
        standstill_ = std::move(standstill);
        tell(standstill_.empty() ? juce::String("The engine runs again.") : words(standstill_), !standstill_.empty());
    }
    if (auto refusal = owner_.refusal(); refusal != refusal_) {
        refusal_ = std::move(refusal);
        if (!refusal_.empty())
            tell(words(refusal_), true);
    }
    // A host may have restored another state.
    if (const auto version = owner_.modelVersion(); version != shown_) {
        shown_ = version;
        linearize_.showModel(owner_.anyModel());
    }
    noteRehearsal();
    // Keys go to the app's window from the start; within a host they are the host's until a person clicks or tabs here.
    if (!focused_ && juce::JUCEApplicationBase::isStandaloneApp() && isShowing()) {
        focused_ = true;
        grabKeyboardFocus();
    }
    if (look_->version() != coloured_)  // another window has changed it
        recolour();
    undo_.setEnabled(!status.busy && history_.canUndo());
    redo_.setEnabled(!status.busy && history_.canRedo());
    undo_.setTooltip(history_.canUndo() ? "Ctrl+Z: " + history_.nextBack() : juce::String("Ctrl+Z"));
    redo_.setTooltip(history_.canRedo() ? "Ctrl+Shift+Z: " + history_.nextAgain() : juce::String("Ctrl+Shift+Z"));
    pages_[page_]->tick();
    if (measuring != nullptr && pages_[page_] != &measure_)
        measuring->tick();  // it goes on, whatever page is seen
    ring_.follow();
}

bool Editor::keyPressed(const juce::KeyPress& key)
{
    const auto& mods = key.getModifiers();
    if (!mods.isCommandDown() || mods.isAltDown())
        return false;
    const int code = key.getKeyCode();
    if (code == 'Z' || code == 'z') {
        mods.isShiftDown() ? redo() : undo();
        return true;
    }
    if (code == 'Y' || code == 'y') {
        redo();
        return true;
    }
    if (code >= '1' && code < '1' + static_cast<int>(pages_.size())) {
        go(static_cast<PageName>(code - '1'));
        return true;
    }
    if (code == juce::KeyPress::pageDownKey || code == juce::KeyPress::pageUpKey) {
        const auto count = pages_.size();
        go(static_cast<PageName>((page_ + (code == juce::KeyPress::pageDownKey ? 1 : count - 1)) % count));
        return true;
    }
    if (code == 'O' || code == 'o') {
        go(PageName::measure);
        measure_.choose();
        return true;
    }
    if (code == '0') {
        setScale(0.0);
        return true;
    }
    if (code == '+' || code == '=' || code == '-') {
        constexpr double step = 0.25;
        const double now = shownScale();
        setScale(std::max(Preferences::leastScale,
                          code == '-' ? step * std::ceil(now / step - 1.01) : step * std::floor(now / step + 1.01)));
        return true;
    }
    return false;
}

}  // namespace excursion::plugin
