// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/DiagnosePage.h"

#include "Engine/Document/Engineering.h"
#include "Plots/Plots.h"
#include "Plots/Words.h"
#include "Plugin/Look.h"

#include <algorithm>

namespace excursion::plugin {
namespace {

look::Tone toneOf(Verdict verdict)
{
    return verdict == Verdict::complete        ? look::Tone::good
           : verdict == Verdict::missingEffect ? look::Tone::accent
                                               : look::Tone::warning;
}

/// The effect as the trial found it, or the frequency response that it changes.
Plot evidenceOf(const RankedEffect& ranked, const Findings& findings)
{
    if (ranked.model.components.empty())
        return {};
    for (auto& plot : effectPlots(ranked.model))
        if (plot.title == effectTitle(ranked.effect)) {
            plot.title += ", as the trial found it";
            return plot;
        }
    Ladder two;
    two.rungs.resize(2);
    two.rungs[0].model = findings.file.ladder.model();
    two.rungs[1].model = ranked.model;
    auto plots = responsePlots(two, findings.file.responses);
    const bool electrical = ranked.model.find(ranked.effect)->effect->electrical();
    for (auto& plot : plots)
        if ((plot.title == "Impedance") == electrical) {
            for (auto& series : plot.series)
                series.title = series.role == Role::before  ? "now"
                               : series.role == Role::model ? "with the effect"
                                                            : series.title;
            return plot;
        }
    return plots.empty() ? Plot {} : plots.front();
}

/// The last model, with a name.
Model namedModel(const Findings& findings)
{
    auto model = findings.file.ladder.model();
    if (model.name.empty())
        model.name = findings.source;
    return model;
}

/// What the last model's effects do to the sound.
Plot soundOf(const Findings& findings)
{
    if (!findings.file.whatIf)
        return {};
    auto plot = distortionPlots(findings.file.whatIf->distortion).back();
    plot.title = "Distortion of the sound";
    return plot;
}

}  // namespace

DiagnosePage::DiagnosePage(Window& window) : Page(window)
{
    verdict_.setFont(juce::Font(17.0f));
    verdict_.setBorderSize({1, 0, 1, 0});
    verdict_.setJustificationType(juce::Justification::topLeft);
    verdict_.setText("Open or measure a take first.", juce::dontSendNotification);
    list_.setViewedComponent(&rows_, false);
    list_.setScrollBarsShown(true, false);
    list_.setTitle("What competes for the missing effect");
    rows_.setTitle("What competes for the missing effect");
    truth_.setFont(juce::Font(14.0f));
    undo_.setTooltip("Ctrl+Z takes it back, too");
    const auto tell = [this](const juce::String& text, bool trouble) { window_.tell(text, trouble); };
    evidence_.told = tell;
    evidence_.getProperties().set("empty", "What the trial of an effect has found is drawn here.");
    falls_.told = tell;
    begin_.onClick = [this] { session().begin(); };
    undo_.onClick = [this] { session().undo(); };
    linearize_.onClick = [this] {
        if (findings_ && !findings_->file.ladder.rungs.empty()) {
            window_.linearizeWith(namedModel(*findings_), words(findings_->source), findings_->fullScale);
        }
    };
    report_.onClick = [this] {
        const auto now = session().findings();  // while the dialog is open, another take may come
        chooser_ = std::make_unique<juce::FileChooser>(
            "Save the report",
            juce::File::getSpecialLocation(juce::File::userHomeDirectory).getChildFile("report.html"), "*.html");
        chooser_->launchAsync(juce::FileBrowserComponent::saveMode | juce::FileBrowserComponent::warnAboutOverwriting,
                              [this, now](const juce::FileChooser& chosen) {
                                  if (chosen.getResult() != juce::File())
                                      session().saveReport(now, chosen.getResult().getFullPathName().toStdString());
                              });
    };
    save_.setTooltip("As a file that the last page and the command read");
    save_.onClick = [this] {
        if (findings_ && !findings_->file.ladder.rungs.empty())
            window_.saveModel(namedModel(*findings_));
    };
    reveal_.onClick = [this] {
        truth_.setVisible(true);
        resized();
    };
    add({&verdict_, &list_, &evidence_, &falls_, &begin_, &undo_, &linearize_, &save_, &report_, &reveal_, &truth_});
    begin_.setVisible(false);
    reveal_.setVisible(false);
    truth_.setVisible(false);
}

void DiagnosePage::show(const std::shared_ptr<const Findings>& fresh)
{
    findings_ = fresh;
    const auto& findings = *fresh;
    const auto& ladder = findings.file.ladder;
    candidates_.clear();
    advice_.reset();
    reveal_.setVisible(!findings.truth.empty());
    truth_.setVisible(truth_.isVisible() && !findings.truth.empty() && ladder.rungs.size() > 1);
    truth_.setText("Hidden: " + words(findings.truth), juce::dontSendNotification);
    const bool fit = findings.report.fitForUse();
    const bool unknown = !ladder.rungs.empty() && ladder.rungs.back().diagnosis.verdict == Verdict::unknownEffect;
    const auto verdict = unknown ? foundInWords(ladder) + "Left unexplained: "
                                       + inFewWords(ladder.rungs.back().diagnosis.remainder) + "."
                                 : ladder.sentence;
    verdict_.setTooltip(typeset(ladder.sentence));
    if (!lacksModel())
        verdict_.setText(typeset(fit ? verdict : findings.report.verdict()), juce::dontSendNotification);
    look::setTone(verdict_, !ladder.rungs.empty() || !fit ? toneOf(fit ? ladder.verdict : Verdict::badMeasurement)
                                                          : look::Tone::dim);
    std::vector<Plot> falls;
    int order = 0;
    if (!ladder.rungs.empty()) {
        const auto& diagnosis = ladder.rungs.back().diagnosis;
        if (findings.file.whatIf && ladder.verdict != Verdict::missingEffect) {
            advice_ = std::make_unique<TextCard>("What makes the distortion, and what limits the stroke",
                                                 typeset(advice(*findings.file.whatIf)),
                                                 [this] { select(noCandidate); });
            advice_->setExplicitFocusOrder(++order);
            rows_.addAndMakeVisible(*advice_);
        }
        for (std::size_t k = 0; k < diagnosis.ranking.size(); ++k) {
            candidates_.push_back(std::make_unique<CandidateCard>(
                diagnosis.ranking[k], diagnosis.error, k, [this, k] { select(k); }, [this, k] { addCandidate(k); }));
            candidates_.back()->setExplicitFocusOrder(++order);
            rows_.addAndMakeVisible(*candidates_.back());
        }
        for (const auto& channel : ladder.rungs.front().comparison.channels) {
            falls.push_back(fallPlot(ladder, channel.quantity));
            falls.back().y.title = "error";
            falls.back().key = falls.size() == 1;  // the same for all
        }
    }
    falls_.show(std::move(falls));
    select(advice_ ? noCandidate : 0);
    resized();
    // The focus went from card to card as they were taken away, and the list with it.
    list_.setViewPosition(0, 0);
    repaint();
}

void DiagnosePage::addCandidate(std::size_t place)
{
    const auto& ranking = findings_->file.ladder.rungs.back().diagnosis.ranking;
    if (place < ranking.size() && !session().status().busy)
        session().add(ranking[place].effect);
}

void DiagnosePage::select(std::size_t place)
{
    selected_ = place;
    if (advice_)
        advice_->choose(place == noCandidate);
    for (std::size_t k = 0; k < candidates_.size(); ++k)
        candidates_[k]->choose(k == place);
    evidence_.show(place < candidates_.size()
                       ? evidenceOf(findings_->file.ladder.rungs.back().diagnosis.ranking[place], *findings_)
                       : soundOf(*findings_));
}

bool DiagnosePage::lacksModel() const
{
    return findings_ && findings_->file.ladder.rungs.empty() && findings_->report.fitForUse();
}

void DiagnosePage::tick()
{
    const bool idle = !session().status().busy;
    begin_.setVisible(idle && lacksModel());
    undo_.setVisible(!begin_.isVisible());
    if (lacksModel())
        verdict_.setText(idle ? "There is no model of this take yet." : "The first model is being fitted.",
                         juce::dontSendNotification);
    const auto rungs = findings_ ? findings_->file.ladder.rungs.size() : 0;
    for (auto& candidate : candidates_)
        candidate->enable(idle);
    undo_.setEnabled(idle && rungs > 1);
    linearize_.setEnabled(rungs > 0);
    save_.setEnabled(rungs > 0);
    report_.setEnabled(idle && rungs > 0);
}

void DiagnosePage::paint(juce::Graphics& g)
{
    if (findings_ && candidates_.empty() && !advice_ && !findings_->file.ladder.rungs.empty()) {
        g.setColour(look::palette().dim);
        g.setFont(14.0f);
        g.drawFittedText("No effect of the catalogue competes.", list_.getBounds().removeFromTop(60),
                         juce::Justification::centred, 2, 1.0f);
    }
}

void DiagnosePage::layOutList()
{
    const int width = list_.getWidth() - list_.getScrollBarThickness() - 2;
    int below = 0;
    const auto place = [&](Card& card) {
        const int height = card.heightFor(width);
        card.setBounds(0, below, width, height);
        below += height;
    };
    if (advice_)
        place(*advice_);
    for (auto& candidate : candidates_)
        place(*candidate);
    rows_.setSize(width, std::max(1, below));
}

void DiagnosePage::resized()
{
    auto area = getLocalBounds();
    verdict_.setBounds(area.removeFromTop(58));
    auto foot = area.removeFromBottom(28);
    const int width = std::min(200, (foot.getWidth() - 4 * 8) / 5);
    begin_.setBounds(foot.withWidth(width));
    for (auto* button : {&undo_, &linearize_, &save_, &report_, &reveal_}) {
        button->setBounds(foot.removeFromLeft(width));
        foot.removeFromLeft(8);
    }
    // beside the buttons where it has room, otherwise above them
    truth_.setBounds(foot.getWidth() >= 240 || !truth_.isVisible() ? foot : area.removeFromBottom(22));
    area.removeFromBottom(8);
    list_.setBounds(area.removeFromLeft(area.getWidth() * 11 / 20));
    layOutList();
    area.removeFromLeft(8);
    evidence_.setBounds(area.removeFromTop(area.getHeight() / 2));
    falls_.setBounds(area);
}

}  // namespace excursion::plugin
