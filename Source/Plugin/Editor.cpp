// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/Editor.h"

#include "Engine/Error.h"
#include "Engine/Loudspeaker/ModelFile.h"
#include "Plugin/Look.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

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

/// A field keeps the colour that its text was put in with, which may have been before the window had a look.
void recolourTexts(juce::Component& part)
{
    if (auto* field = dynamic_cast<juce::TextEditor*>(&part))
        field->applyColourToAllText(look::palette().text);
    for (auto* child : part.getChildren())
        recolourTexts(*child);
}

}  // namespace

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
    cancel_.onClick = [this] {
        owner_.session().cancel();
        if (owner_.rehearsing().status().busy) {
            owner_.rehearsing().cancel();
            tell("Cancelled.", false);
        }
        if (auto* measuring = measure_.measuring())
            measuring->cancel();
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

/// In the file of preferences, unless it says the same.
void Editor::keep()
{
    const auto kept = readPreferences(preferencesFile());
    preferences_.width = getWidth();
    preferences_.height = getHeight();
    if (kept.scale != preferences_.scale || kept.theme != preferences_.theme || kept.width != preferences_.width
        || kept.height != preferences_.height)
        writePreferences(preferences_, preferencesFile());
}

juce::Rectangle<int> Editor::room() const
{
    const auto& displays = juce::Desktop::getInstance().getDisplays();
    const auto* display = isShowing() ? displays.getDisplayForRect(getScreenBounds()) : displays.getPrimaryDisplay();
    if (display == nullptr || display->userArea.isEmpty())
        return {0, 0, 1280, 800};
    constexpr int frame = 60;  // px: the title of a window, and a note above the editor that the app may show
    auto area = display->userArea;
    return {0, 0, std::max(leastWidth, area.getWidth() * 9 / 10),
            std::max(leastHeight, area.getHeight() * 9 / 10 - frame)};
}

double Editor::shownScale() const
{
    const double across = getWidth() / static_cast<double>(leastWidth),
                 down = getHeight() / static_cast<double>(leastHeight), most = std::min(across, down);
    if (preferences_.scale > 0.0)
        return std::min(preferences_.scale, most);
    // Half of what the window is larger than a small screen goes into size, half into room.
    const double larger = std::min(getWidth() / 1280.0, getHeight() / 800.0);
    return std::min(most, std::clamp(0.5 + 0.5 * larger, 1.0, Preferences::mostScale));
}

void Editor::setScale(double scale)
{
    const bool open = getWidth() > 0;
    preferences_.scale = scale > 0.0 ? std::clamp(scale, Preferences::leastScale, Preferences::mostScale) : 0.0;
    const double least = preferences_.scale > 0.0 ? std::min(1.0, preferences_.scale) : 1.0;
    setResizeLimits(static_cast<int>(leastWidth * least), static_cast<int>(leastHeight * least), 16384, 16384);
    if (!open)
        return;
    // A window that is too small for it grows as far as the screen lets it.
    const auto screen = room();
    const auto wanted = [&](int now, int needed, int most) {
        return std::max(now, std::min(most, static_cast<int>(std::ceil(needed * preferences_.scale))));
    };
    setSize(wanted(getWidth(), leastWidth, screen.getWidth()), wanted(getHeight(), leastHeight, screen.getHeight()));
    resized();
    if (preferences_.scale > shownScale() + 0.005)
        tell("The window is drawn at " + whole(100.0 * shownScale()) + " %: more does not fit on the screen.", false);
    keep();
}

void Editor::setTheme(look::Theme theme)
{
    preferences_.theme = theme;
    recolour();
    keep();
}

void Editor::recolour()
{
    look_->use(preferences_.theme);
    coloured_ = look_->version();
    sendLookAndFeelChange();
    recolourTexts(body_);
    for (auto* page : pages_)
        page->recolour();
    if (auto* window = findParentComponentOfClass<juce::ResizableWindow>())
        window->setBackgroundColour(look::palette().background);
    repaint();
}

void Editor::showView()
{
    juce::PopupMenu scales, themes, keys, menu;
    const auto safe = juce::Component::SafePointer<Editor>(this);
    const auto scale = [&](const juce::String& text, double value) {
        scales.addItem(text, true, preferences_.scale == value, [safe, value] {
            if (safe != nullptr)
                safe->setScale(value);
        });
    };
    scale("Grows with the window", 0.0);
    for (const double value : {0.75, 1.0, 1.25, 1.5, 1.75, 2.0, 2.5, 3.0})
        scale(whole(100.0 * value) + " %", value);
    const auto theme = [&](const juce::String& text, look::Theme value) {
        themes.addItem(text, true, preferences_.theme == value, [safe, value] {
            if (safe != nullptr)
                safe->setTheme(value);
        });
    };
    theme("As the system", look::Theme::system);
    theme("Light", look::Theme::light);
    theme("Dark", look::Theme::dark);
    for (const auto* text :
         {"Ctrl+1 to Ctrl+5: pages", "Ctrl+Page Up, Ctrl+Page Down: one page on", "Ctrl+Z, Ctrl+Shift+Z: undo, redo",
          "Ctrl+O: open a take", "Ctrl with +, - and 0: scale", "Tab, Shift+Tab: from control to control",
          "Arrows, Page Up, Page Down, Home: move a slider",
          "On a plot: arrows read, + and - zoom, Home shows all, Return saves",
          "Mouse on a plot: draw a frame, turn the wheel (Shift: up and down), double click"})
        keys.addItem(juce::PopupMenu::Item(text).setEnabled(true).setAction([] {}));
    menu.addSubMenu("Scale", scales);
    menu.addSubMenu("Theme", themes);
    menu.addSubMenu("Keys and mouse", keys);
    menu.setLookAndFeel(&*look_);
    menu.showMenuAsync(juce::PopupMenu::Options().withTargetComponent(view_));
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

void Editor::undo()
{
    if (owner_.session().status().busy) {
        tell("Wait until the work is done, or cancel it, before you take something back.", false);
        return;
    }
    history_.undo();
    update();
}

void Editor::redo()
{
    if (owner_.session().status().busy) {
        tell("Wait until the work is done, or cancel it, before you do something again.", false);
        return;
    }
    history_.redo();
    update();
}

/// A rung that was added or taken back is a step of the history; another take has none.
void Editor::noteLadder(const std::shared_ptr<const Findings>& findings)
{
    std::vector<std::string> rungs;
    for (const auto& rung : findings->file.ladder.rungs)
        rungs.push_back(rung.added);
    const auto before = std::exchange(rungs_, rungs);
    if (std::exchange(take_, findings->take) != findings->take) {
        history_.clear();
        laddering_ = false;
        return;
    }
    if (std::exchange(laddering_, false) || before.empty())
        return;
    const auto back = [this] {
        laddering_ = true;
        owner_.session().undo();
    };
    const auto again = [this](const std::string& effect) {
        return [this, effect] {
            laddering_ = true;
            owner_.session().add(effect);
        };
    };
    if (rungs.size() == before.size() + 1)
        history_.did("Add " + words(rungs.back()), back, again(rungs.back()));
    else if (rungs.size() + 1 == before.size())
        history_.did("Take back " + words(before.back()), again(before.back()), back);
}

/// That another model plays is a step of the history.
void Editor::noteModel(const AnyModel& before, const AnyModel& now)
{
    const auto put = [this](const AnyModel& which) {
        return [this, which] {
            try {
                owner_.setModel(which);
            } catch (const Error& error) {
                tell(words(error.what()), true);
            }
        };
    };
    history_.did("Load a model", put(before), put(now));
}

void Editor::use(const Model& model, const juce::String& from)
{
    try {
        const auto before = owner_.anyModel();
        owner_.setModel(model);
        replaced_.reset();
        noteModel(before, model);
        tell("The model is from " + from + ".", false);
    } catch (const Error& error) {
        tell(words(error.what()), true);
    }
}

void Editor::useFile(const juce::File& file)
{
    const auto path = file.getFullPathName().toStdString();
    try {
        const auto text = file.loadFileAsString().toStdString();
        if (!holdsBox(text)) {
            use(readModel(path), file.getFileName());
            return;
        }
        useBox(nlohmann::ordered_json::parse(text), file.getFileName());
    } catch (const Error& error) {
        tell(words(error.what()), true);
    }
}

void Editor::useBox(const nlohmann::ordered_json& document, const juce::String& from)
{
    replaced_ = owner_.anyModel();
    owner_.rehearsing().load(document, from.toStdString());
    tell("Rehearsing what it is worth to turn the model of " + from + " around.", false);
}

/// What came of a model without physics that was loaded.
void Editor::noteRehearsal()
{
    const auto status = owner_.rehearsing().status();
    if (status.version == rehearsed_)
        return;
    rehearsed_ = status.version;
    if (!status.trouble && replaced_)
        noteModel(*replaced_, owner_.anyModel());
    replaced_.reset();
    tell(words(status.words), status.trouble);
}

void Editor::load(const juce::File& file)
{
    if (!holdsModel(file)) {
        owner_.session().open(file.getFullPathName().toStdString());
        go(PageName::measure);
        return;
    }
    useFile(file);
    go(PageName::linearize);
}

void Editor::filesDropped(const juce::StringArray& files, int, int) { load(juce::File(files[0])); }

void Editor::show(const std::shared_ptr<const Findings>& findings)
{
    noteLadder(findings);
    for (auto* page : pages_)
        page->show(findings);
}

void Editor::update()
{
    const auto status = owner_.session().status();
    const auto rehearsal = owner_.rehearsing().status();
    fraction_ = status.busy ? status.fraction : rehearsal.fraction;
    progress_.setVisible(status.busy || rehearsal.busy);
    cancel_.setVisible(status.busy || rehearsal.busy);
    if (status.words != said_) {
        said_ = status.words;
        tell(words(said_), status.trouble);
    }
    if (status.version != seen_) {
        seen_ = status.version;
        if (const auto findings = owner_.session().findings())
            show(findings);
    }
    if (!status.busy)
        laddering_ = false;  // what the history asked for has been done, or has failed
    if (auto standstill = owner_.standstill(); standstill != standstill_) {
        standstill_ = std::move(standstill);
        tell(standstill_.empty() ? juce::String("The engine runs again.") : words(standstill_), !standstill_.empty());
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

void Editor::paint(juce::Graphics& g) { g.fillAll(look::palette().background); }

void Editor::resized()
{
    if (getWidth() == 0 || getHeight() == 0)
        return;
    const double scale = shownScale();
    const juce::Rectangle<int> area(0, 0, static_cast<int>(std::round(getWidth() / scale)),
                                    static_cast<int>(std::round(getHeight() / scale)));
    body_.setTransform(juce::AffineTransform::scale(static_cast<float>(scale)));
    body_.setBounds(area);
    layOut(area);
    ring_.follow();
}

void Editor::layOut(juce::Rectangle<int> area)
{
    area.reduce(12, 10);
    auto head = area.removeFromTop(30);
    view_.setBounds(head.removeFromRight(64));
    head.removeFromRight(8);
    redo_.setBounds(head.removeFromRight(60));
    head.removeFromRight(4);
    undo_.setBounds(head.removeFromRight(60));
    head.removeFromRight(8);
    const int each = std::min(120, head.getWidth() / static_cast<int>(tabs_.size()));
    for (auto& tab : tabs_)
        tab.setBounds(head.removeFromLeft(each));
    area.removeFromTop(8);
    auto foot = area.removeFromBottom(34);
    cancel_.setBounds(foot.removeFromRight(80).reduced(0, 3));
    foot.removeFromRight(8);
    progress_.setBounds(foot.removeFromRight(150).reduced(0, 6));
    foot.removeFromRight(8);
    status_.setBounds(foot);
    area.removeFromBottom(4);
    for (auto* page : pages_)
        page->setBounds(area);
}

}  // namespace excursion::plugin
