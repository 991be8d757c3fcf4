// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/MeasurePage.h"

#include "Bench/Draw.h"
#include "Engine/Document/Engineering.h"
#include "Engine/Take/TakeFile.h"
#include "Plots/Words.h"
#include "Plugin/Look.h"

#include <algorithm>
#include <filesystem>

namespace excursion::plugin {
namespace {

/// Signal to noise by octave, a line a channel.
Plot signalPlot(const CheckReport& report)
{
    constexpr Role roles[] {Role::measured, Role::model, Role::error, Role::after, Role::noise};
    Plot plot;
    plot.title = "Signal to noise by octave, loudest level";
    plot.x = {"frequency", "Hz", true, 0.0, 0.0, {}};
    plot.y = {"signal to noise", "dB", false, 0.0, 0.0, {}};
    for (std::size_t k = 0; k < report.channels.size(); ++k) {
        const auto& channel = report.channels[k];
        Series series {std::string(name(channel.quantity)),
                       roles[k % std::size(roles)],
                       {},
                       {},
                       {},
                       {},
                       Series::Shape::pointsAndLine,
                       0};
        for (const auto& band : channel.bands) {
            series.x.push_back(std::sqrt(band.low * band.high));
            series.y.push_back(band.db);
        }
        if (!series.x.empty())
            plot.series.push_back(std::move(series));
    }
    return plot;
}

juce::String textOf(const Findings& findings)
{
    juce::StringArray lines {words(findings.source)};
    const auto& take = findings.file.take;
    if (take.sampleRate > 0.0)
        lines.add(juce::String(take.seconds, 1) + " s at " + words(nominal(take.sampleRate, "Hz"))
                  + (take.realizations > 0 ? ", " + juce::String(static_cast<int>(take.levels.size())) + " levels of "
                                                 + juce::String(take.realizations) + " realizations of "
                                                 + juce::String(take.periods) + " periods"
                                           : juce::String(", without periods")));
    lines.add("");
    for (const auto& channel : findings.report.channels) {
        auto line = words(capitalized(name(channel.quantity))) + ": " + words(engineering(channel.rms, channel.unit, 3))
                    + " rms, peak " + words(engineering(channel.peak, channel.unit, 3));
        if (channel.snrDb)
            line += ", signal to noise " + words(decibels(*channel.snrDb));
        if (channel.delay)
            line += ", delay " + words(engineering(channel.delay->seconds, "s", 2));
        lines.add(line);
    }
    if (!findings.report.problems.empty() || !findings.remarks.empty())
        lines.add("");
    for (const auto& remark : findings.remarks)
        lines.add("Remark: " + words(remark));
    for (const auto& problem : findings.report.problems)
        lines.add((problem.fatal ? "Fault: " : "Remark: ") + typeset(problem.sentence));
    return lines.joinIntoString("\n");
}

}  // namespace

MeasurePage::MeasurePage(Window& window, juce::AudioDeviceManager* devices) : Page(window)
{
    for (auto* title : {&openTitle_, &virtualTitle_, &measuringTitle_})
        title->setFont(juce::Font(16.0f));
    for (auto* label : {&openTitle_, &openHint_, &virtualTitle_, &measuringTitle_, &verdict_})
        label->setBorderSize({1, 0, 1, 0});  // in line with what stands below
    openTitle_.setText("A take that you have", juce::dontSendNotification);
    openHint_.setText("Or drop it anywhere on this window: a folder, a .csv, .zma or .frd.",
                      juce::dontSendNotification);
    look::setTone(openHint_, look::Tone::dim);
    openHint_.setFont(juce::Font(12.5f));
    virtualTitle_.setText("A virtual loudspeaker with a hidden effect", juce::dontSendNotification);
    measuringTitle_.setText("A loudspeaker of your own", juce::dontSendNotification);
    verdict_.setFont(juce::Font(17.0f));
    verdict_.setJustificationType(juce::Justification::topLeft);
    verdict_.setText("Nothing has been measured yet.", juce::dontSendNotification);
    report_.setMultiLine(true);
    report_.setReadOnly(true);
    report_.setCaretVisible(false);
    report_.setFont(juce::Font(14.0f));
    report_.setTitle("What the check says of the take");
    signal_.told = [this](const juce::String& text, bool trouble) { window_.tell(text, trouble); };
    for (std::size_t k = 0; k < bench::driverClasses().size(); ++k)
        driver_.addItem(words(bench::driverClasses()[k]), static_cast<int>(k) + 1);
    driver_.setSelectedItemIndex(2, juce::dontSendNotification);
    driver_.setTitle("Class of the virtual loudspeaker");
    driver_.setTooltip("What kind of loudspeaker is drawn");
    seed_.setTitle("Seed of the virtual loudspeaker");
    seed_.setTooltip("The same seed draws the same loudspeaker");
    draw_.setTooltip("Draws a virtual loudspeaker, hides an effect in it and measures it");
    open_.setTooltip("Ctrl+O");
    seed_.setRange(1.0, 9999.0, 1.0);
    seed_.setValue(7.0, juce::dontSendNotification);
    draw_.onClick = [this] {
        const VirtualOrder order {driver_.getText().toStdString(), static_cast<std::uint64_t>(seed_.getValue())};
        window_.onceAgreed(false, "draw a loudspeaker", [this, order] { session().open(order); });
    };
    open_.onClick = [this] { choose(); };
    folder_.onClick = [this] {
        chooser_ = std::make_unique<juce::FileChooser>("Open the folder of a take");
        chooser_->launchAsync(juce::FileBrowserComponent::openMode | juce::FileBrowserComponent::canSelectDirectories,
                              [this](const juce::FileChooser& chosen) { open(chosen.getResult()); });
    };
    // What is saved is what was there at the click: while the dialog is open, another take may come.
    const auto ask = [this](const juce::String& what, auto save) {
        const auto home = juce::File::getSpecialLocation(juce::File::userHomeDirectory);
        chooser_ = std::make_unique<juce::FileChooser>("Save the " + what + " as a folder",
                                                       home.getChildFile(what).getNonexistentSibling());
        chooser_->launchAsync(juce::FileBrowserComponent::saveMode, [save](const juce::FileChooser& chosen) {
            if (chosen.getResult() != juce::File())
                save(chosen.getResult());
        });
    };
    save_.onClick = [this, ask] {
        ask("take", [this, now = session().findings()](const juce::File& folder) { saveTake(now, folder); });
    };
    saveRecording_.onClick = [this, ask] {
        ask("recording",
            [this, now = session().recordingWithoutTake()](const juce::File& folder) { saveRecording(now, folder); });
    };
    saveRecording_.setTooltip("The last recording, of which no take has come, with its plan");
    add({&openTitle_, &open_, &folder_, &openHint_, &virtualTitle_, &driver_, &seed_, &draw_, &measuringTitle_});
    save_.setEnabled(false);
    if (devices != nullptr) {
        measuring_ = std::make_unique<MeasuringPanel>(window, *devices);
        add({measuring_.get()});
    } else {
        measuringTitle_.setText("To measure a loudspeaker, start the app: within a host the devices are the host's.",
                                juce::dontSendNotification);
        measuringTitle_.setFont(juce::Font(13.0f));
        look::setTone(measuringTitle_, look::Tone::dim);
    }
    add({&verdict_, &report_, &signal_, &save_, &saveRecording_});
    saveRecording_.setVisible(false);
}

void MeasurePage::choose()
{
    chooser_ = std::make_unique<juce::FileChooser>("Open a take", juce::File(), "*.json;*.csv;*.txt;*.zma;*.frd;*.mat");
    chooser_->launchAsync(juce::FileBrowserComponent::openMode | juce::FileBrowserComponent::canSelectFiles,
                          [this](const juce::FileChooser& chosen) { open(chosen.getResult()); });
}

void MeasurePage::open(const juce::File& file)
{
    if (file != juce::File())
        window_.onceAgreed(false, "open another take", [this, path = file.getFullPathName().toStdString()] {
            session().open(path);
            window_.go(PageName::measure);
        });
}

void MeasurePage::show(const std::shared_ptr<const Findings>& fresh)
{
    const auto& findings = *fresh;
    const bool spectra = findings.take->asResponses() != nullptr;
    verdict_.setText(spectra ? juce::String("A frequency response: its linear effects can be told.")
                             : words(findings.report.verdict()),
                     juce::dontSendNotification);
    look::setTone(verdict_, findings.report.fitForUse() ? look::Tone::good : look::Tone::warning);
    report_.setText(textOf(findings), juce::dontSendNotification);
    report_.moveCaretToTop(false);
    signal_.show(signalPlot(findings.report));
    taken_ = !spectra;
}

/// Says so where the folder holds something of the kind already.
bool MeasurePage::isFree(const juce::File& folder)
{
    bool holds = folder.getChildFile("recording.wav").exists() || folder.getChildFile("plan").exists();
    std::error_code none;
    for (const auto& file : filesOfTake(folder.getFullPathName().toStdString()))
        holds = holds || std::filesystem::exists(file, none);
    if (holds)
        window_.tell("\"" + folder.getFileName() + "\" holds a take or a recording already: choose another name.",
                     true);
    return !holds;
}

void MeasurePage::saveTake(const std::shared_ptr<const Findings>& findings, const juce::File& folder)
{
    if (isFree(folder))
        session().saveTake(findings, folder.getFullPathName().toStdString());
}

void MeasurePage::saveRecording(const std::shared_ptr<const RecordingOptions>& recording, const juce::File& folder)
{
    if (isFree(folder))
        session().saveRecording(recording, folder.getFullPathName().toStdString());
}

void MeasurePage::tick()
{
    saveRecording_.setVisible(session().recordingWithoutTake() != nullptr);
    save_.setEnabled(taken_);
    if (measuring_)
        measuring_->tick();
}

void MeasurePage::recolour() { report_.applyColourToAllText(look::palette().text); }

void MeasurePage::resized()
{
    auto area = getLocalBounds();
    auto left = area.removeFromLeft(juce::jlimit(370, 430, getWidth() * 2 / 5));
    area.removeFromLeft(16);
    // What is left over of the height goes between the groups.
    const int least = 22 + 28 + 20 + 22 + 28 + 22 + MeasuringPanel::leastHeight,
              gap = juce::jlimit(4, 18, (getHeight() - least) / 3);
    openTitle_.setBounds(left.removeFromTop(22));
    auto line = left.removeFromTop(28);
    open_.setBounds(line.removeFromLeft(140));
    line.removeFromLeft(8);
    folder_.setBounds(line.removeFromLeft(140));
    openHint_.setBounds(left.removeFromTop(20));
    left.removeFromTop(gap);
    virtualTitle_.setBounds(left.removeFromTop(22));
    line = left.removeFromTop(28);
    driver_.setBounds(line.removeFromLeft(120));
    line.removeFromLeft(8);
    seed_.setBounds(line.removeFromLeft(124));
    line.removeFromLeft(8);
    draw_.setBounds(line.removeFromLeft(106));
    left.removeFromTop(gap);
    measuringTitle_.setBounds(left.removeFromTop(measuring_ ? 22 : 40));
    if (measuring_)
        measuring_->setBounds(left.removeFromTop(juce::jmin(left.getHeight(), MeasuringPanel::leastHeight + 60)));
    verdict_.setBounds(area.removeFromTop(44));
    line = area.removeFromBottom(28);
    save_.setBounds(line.removeFromLeft(160));
    line.removeFromLeft(8);
    saveRecording_.setBounds(line.removeFromLeft(180));
    area.removeFromBottom(8);
    report_.setBounds(area.removeFromTop(area.getHeight() * 2 / 5));
    area.removeFromTop(8);
    signal_.setBounds(area);
}

}  // namespace excursion::plugin
