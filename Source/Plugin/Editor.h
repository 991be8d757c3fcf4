// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Plugin/ComparePage.h"
#include "Plugin/DiagnosePage.h"
#include "Plugin/FocusRing.h"
#include "Plugin/History.h"
#include "Plugin/IdentifyPage.h"
#include "Plugin/LinearizePage.h"
#include "Plugin/MeasurePage.h"
#include "Plugin/Preferences.h"
#include "Plugin/Question.h"

#include <array>
#include <functional>
#include <memory>

namespace excursion::plugin {

/// The window: five pages, from the measurement to the linearization, and a status line with the progress of what is
/// under way. A take or a model is taken wherever it is dropped. Everything is laid out on a body of at least 800 x 560
/// that is drawn at a scale: as a person chose, or growing with the window, and smaller where the window is. Keys:
/// Ctrl+1 to Ctrl+5 the pages, Ctrl+Page Up and Down one on, Ctrl+Z and Ctrl+Shift+Z take back and do again, Ctrl+O
/// opens, Ctrl with + - 0 scales.
class Editor : public juce::AudioProcessorEditor,
               public juce::FileDragAndDropTarget,
               public Window,
               private juce::DarkModeSettingListener,
               private juce::Timer {
public:
    static constexpr int leastWidth = 800, leastHeight = 560;  ///< of what is laid out

    /// @param devices  for measuring; null: those of the app, none within a host
    explicit Editor(Processor&, juce::AudioDeviceManager* devices = nullptr);
    ~Editor() override;

    /// As if the file had been dropped: a model is loaded, anything else is opened as a take, once a person agrees
    /// where that loses something. What cannot be used is told in the status line, and changes nothing.
    void load(const juce::File&);
    const juce::String status() const { return status_.getText(); }

    /// Within Preferences::leastScale and mostScale; 0: grows with the window. Kept for the next window.
    void setScale(double);
    double shownScale() const;          ///< at which it is drawn now
    void setTheme(look::Theme);         ///< kept as well
    juce::Rectangle<int> room() const;  ///< of the screen that the window may take, 90 % of it
    juce::Component& body() { return body_; }
    FocusRing& ring() { return ring_; }
    void undo();
    void redo();

    void update();  ///< what the timer does
    void show(const std::shared_ptr<const Findings>&);
    Page& page(PageName name) { return *pages_[static_cast<std::size_t>(name)]; }
    MeasurePage& measure() { return measure_; }
    DiagnosePage& diagnose() { return diagnose_; }
    IdentifyPage& identify() { return identify_; }

    Processor& processor() override { return owner_; }
    History& history() override { return history_; }
    void go(PageName) override;
    void use(const Model&, const juce::String& from) override;
    void linearizeWith(const Model&, const juce::String& from, double fullScale) override;
    void linearizeWith(const nlohmann::ordered_json&, const juce::String& from, double fullScale) override;
    void useFile(const juce::File&) override;
    void useBox(const nlohmann::ordered_json&, const juce::String& from) override;
    void saveModel(const Model&) override;
    void saveModel(const Model&, const juce::File&);  ///< tells what came of it
    void onceAgreed(bool withRecording, const juce::String& wish, std::function<void()>) override;
    void tell(const juce::String&, bool trouble) override;

    void paint(juce::Graphics&) override;
    void resized() override;
    bool keyPressed(const juce::KeyPress&) override;
    bool isInterestedInFileDrag(const juce::StringArray&) override { return true; }
    void filesDropped(const juce::StringArray&, int, int) override;

private:
    void timerCallback() override { update(); }
    void darkModeSettingChanged() override { recolour(); }
    void recolour();
    void keep();
    void layOut(juce::Rectangle<int>);
    void showView();
    void noteModel(const AnyModel& before, const AnyModel& now);
    void noteRehearsal();
    bool mayStep(const juce::String& wish);
    void noteLadder(const std::shared_ptr<const Findings>&);
    void hearAnswer();

    juce::SharedResourcePointer<look::Look> look_;
    Processor& owner_;
    Preferences preferences_ = readPreferences(preferencesFile());
    History history_;
    juce::Component body_;
    FocusRing ring_;
    juce::TooltipWindow tips_ {this};
    juce::Label status_;
    std::array<juce::TextButton, 5> tabs_ {juce::TextButton {"Measure"}, juce::TextButton {"Compare"},
                                           juce::TextButton {"Diagnose"}, juce::TextButton {"Identify"},
                                           juce::TextButton {"Linearize"}};
    double fraction_ = 0.0;
    juce::ProgressBar progress_ {fraction_};
    juce::TextButton cancel_ {"Cancel"}, undo_ {"Undo"}, redo_ {"Redo"}, view_ {"View"};
    MeasurePage measure_;
    ComparePage compare_ {*this};
    DiagnosePage diagnose_ {*this};
    IdentifyPage identify_ {*this};
    LinearizePage linearize_ {*this};
    const std::array<Page*, 5> pages_ {&measure_, &compare_, &diagnose_, &identify_, &linearize_};
    std::size_t page_ = 0;
    std::uint64_t seen_ = 0;                ///< version of the findings that the pages show
    static constexpr double toldFor = 6.0;  ///< s, that something was not saved or not opened
    double heldUntil_ = 0.0;
    std::uint64_t failures_ = 0;        ///< of the session, that were told
    std::string said_;                  ///< of the session's status
    std::string standstill_, refusal_;  ///< of the processor, as they were told
    std::uint64_t rehearsed_ = 0;       ///< version of the rehearsal that was told
    std::unique_ptr<juce::FileChooser> chooser_;
    std::optional<AnyModel> replaced_;  ///< what played when the model that is rehearsed was asked for
    /// V at full scale, or 0, where the signal is to be linearized with it afterwards
    std::optional<double> linearizes_;
    std::uint64_t shown_ = 0;                   ///< version of the model that the last page shows
    bool focused_ = false;                      ///< has asked for the keyboard
    int coloured_ = -1;                         ///< version of the look that the window has
    std::shared_ptr<const PreparedTake> take_;  ///< that the history is of
    std::vector<std::string> rungs_;            ///< effects of the ladder, as the history knows it
    bool laddering_ = false;                    ///< the history itself moves the ladder
    std::unique_ptr<Question> question_;        ///< that is asked; null: none
    std::function<void()> agreed_;              ///< what is done where a person agrees
};

}  // namespace excursion::plugin
