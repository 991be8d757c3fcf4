// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/DiagnosePage.h"

#include "Plots/Engineering.h"
#include "Plots/Plots.h"
#include "Plots/Words.h"
#include "Plugin/Look.h"

#include <algorithm>

namespace excursion::plugin {
namespace {

constexpr int rowHeight = 118, lineHeight = 42;

juce::Colour toneOf(Verdict verdict)
{
    return verdict == Verdict::complete ? look::good : verdict == Verdict::missingEffect ? look::accent : look::warning;
}

/// "current −28.1 → −60.2 dB": as confirmed by a refit, else as predicted.
juce::String fallOf(const RankedEffect& ranked, const ErrorByChannel& before)
{
    const auto& after = ranked.confirmedErrorDb.empty() ? ranked.predictedErrorDb : ranked.confirmedErrorDb;
    juce::StringArray parts;
    for (const auto& [quantity, error] : before)
        if (const auto found = after.find(quantity); found != after.end())
            parts.add(words(std::string(name(quantity)) + " " + fixedText(error.db, 1) + " \u2192 "
                            + decibels(found->second)));
    return parts.joinIntoString(", ") + (ranked.confirmedErrorDb.empty() ? " (predicted)" : "");
}

/// The law as the trial found it; an effect without a law is seen in the frequency response.
Plot evidenceOf(const RankedEffect& ranked, const Findings& findings)
{
    if (ranked.model.components.empty())
        return {};
    for (auto& plot : lawPlots(ranked.model))
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

/// What the last model's effects do to the sound.
Plot soundOf(const Findings& findings)
{
    if (!findings.file.whatIf)
        return {};
    auto plot = distortionPlots(findings.file.whatIf->distortion).back();
    plot.title = "Distortion of the sound";
    return plot;
}

void paintCard(juce::Graphics& g, juce::Rectangle<float> area, bool chosen)
{
    g.setColour(look::panel);
    g.fillRoundedRectangle(area, 4.0f);
    if (chosen) {
        g.setColour(look::accent);
        g.fillRect(area.withWidth(3.0f));
    }
}

}  // namespace

/// One effect that competes.
class DiagnosePage::Candidate : public juce::Component {
public:
    Candidate(const RankedEffect& ranked, const ErrorByChannel& before, std::size_t place,
              std::function<void()> selected, std::function<void()> added)
        : title_(juce::String(static_cast<int>(place) + 1) + ".  " + words(effectTitle(ranked.effect))),
          fall_(fallOf(ranked, before)),
          reason_(words(ranked.reason)),
          confidence_(ranked.confidence),
          selected_(std::move(selected))
    {
        add_.onClick = std::move(added);
        addAndMakeVisible(add_);
    }

    void choose(bool chosen)
    {
        chosen_ = chosen;
        repaint();
    }
    void enable(bool on) { add_.setEnabled(on); }
    int height() const { return speaksFor() ? rowHeight : lineHeight; }
    void mouseDown(const juce::MouseEvent&) override { selected_(); }

    void paint(juce::Graphics& g) override
    {
        auto area = getLocalBounds().toFloat().reduced(1.0f, 3.0f);
        paintCard(g, area, chosen_);
        area.reduce(12.0f, 6.0f);
        auto head = area.removeFromTop(22.0f).withTrimmedRight(78.0f);
        g.setFont(15.0f);
        g.setColour(look::text);
        g.drawText(title_, head, juce::Justification::left);
        g.setFont(12.5f);
        if (!speaksFor()) {
            g.setColour(look::dim);
            g.drawText("takes nothing away", head, juce::Justification::right);
            return;
        }
        auto bar = area.removeFromTop(17.0f);
        auto gauge = bar.removeFromLeft(60.0f).withSizeKeepingCentre(60.0f, 6.0f);
        g.setColour(look::background);
        g.fillRoundedRectangle(gauge, 3.0f);
        g.setColour(look::accent);
        g.fillRoundedRectangle(gauge.withWidth(static_cast<float>(confidence_) * gauge.getWidth()), 3.0f);
        g.setColour(look::dim);
        g.drawFittedText("  " + whole(100.0 * confidence_) + " %   " + fall_, bar.getSmallestIntegerContainer(),
                         juce::Justification::left, 1, 0.8f);
        area.removeFromTop(2.0f);
        g.setColour(look::text.withAlpha(0.85f));
        g.drawFittedText(reason_, area.getSmallestIntegerContainer(), juce::Justification::topLeft, 4, 1.0f);
    }

    void resized() override { add_.setBounds(getWidth() - 84, 9, 72, 24); }

private:
    bool speaksFor() const { return confidence_ >= 0.005; }  // else all of it would be about nothing

    juce::String title_, fall_, reason_;
    double confidence_;
    bool chosen_ = false;
    std::function<void()> selected_;
    juce::TextButton add_ {"Add"};
};

/// What the model's effects do to the sound, and what to change in the driver.
class DiagnosePage::Advice : public juce::Component {
public:
    Advice(const WhatIf& whatIf, std::function<void()> selected) : selected_(std::move(selected))
    {
        text_.append("What makes the distortion, and what limits the stroke\n", juce::Font(15.0f), look::text);
        text_.append(words(advice(whatIf)), juce::Font(13.5f), look::text.withAlpha(0.85f));
        text_.setLineSpacing(3.0f);
    }

    int heightFor(int width) const
    {
        juce::TextLayout layout;
        layout.createLayout(text_, static_cast<float>(width) - 2.0f * margin);
        return static_cast<int>(std::ceil(layout.getHeight())) + 2 * static_cast<int>(margin);
    }
    void choose(bool chosen)
    {
        chosen_ = chosen;
        repaint();
    }
    void mouseDown(const juce::MouseEvent&) override { selected_(); }

    void paint(juce::Graphics& g) override
    {
        const auto area = getLocalBounds().toFloat().reduced(1.0f, 3.0f);
        paintCard(g, area, chosen_);
        text_.draw(g, area.reduced(margin, margin - 3.0f));
    }

private:
    static constexpr float margin = 12.0f;
    juce::AttributedString text_;
    bool chosen_ = false;
    std::function<void()> selected_;
};

DiagnosePage::DiagnosePage(Window& window) : Page(window)
{
    verdict_.setFont(juce::Font(17.0f));
    verdict_.setJustificationType(juce::Justification::topLeft);
    verdict_.setMinimumHorizontalScale(0.85f);
    verdict_.setText("Open or measure a take first.", juce::dontSendNotification);
    list_.setViewedComponent(&rows_, false);
    list_.setScrollBarsShown(true, false);
    undo_.onClick = [this] { session().undo(); };
    linearize_.onClick = [this] {
        if (findings_ && !findings_->file.ladder.rungs.empty()) {
            auto model = findings_->file.ladder.model();
            if (model.name.empty())
                model.name = findings_->source;
            window_.use(model, words(findings_->source));
            window_.go(PageName::linearize);
        }
    };
    report_.onClick = [this] {
        chooser_ = std::make_unique<juce::FileChooser>(
            "Save the report",
            juce::File::getSpecialLocation(juce::File::userHomeDirectory).getChildFile("report.html"), "*.html");
        chooser_->launchAsync(juce::FileBrowserComponent::saveMode | juce::FileBrowserComponent::warnAboutOverwriting,
                              [this](const juce::FileChooser& chosen) {
                                  if (chosen.getResult() != juce::File())
                                      session().saveReport(chosen.getResult().getFullPathName().toStdString());
                              });
    };
    reveal_.onClick = [this] { truth_.setVisible(true); };
    for (juce::Component* component :
         std::initializer_list<juce::Component*> {&verdict_, &list_, &evidence_, &undo_, &linearize_, &report_})
        addAndMakeVisible(component);
    addChildComponent(reveal_);
    addChildComponent(truth_);
}

DiagnosePage::~DiagnosePage() = default;

void DiagnosePage::show(const std::shared_ptr<const Findings>& fresh)
{
    findings_ = fresh;
    const auto& findings = *fresh;
    const auto& ladder = findings.file.ladder;
    candidates_.clear();
    advice_.reset();
    falls_.clear();
    reveal_.setVisible(!findings.truth.empty());
    truth_.setVisible(truth_.isVisible() && !findings.truth.empty() && ladder.rungs.size() > 1);
    truth_.setText("Hidden: " + words(findings.truth), juce::dontSendNotification);
    const bool fit = findings.report.fitForUse();
    const bool unknown = !ladder.rungs.empty() && ladder.verdict == Verdict::unknownEffect;
    const auto verdict = unknown ? foundInWords(ladder) + "Left unexplained: "
                                       + inFewWords(ladder.rungs.back().diagnosis.remainder) + "."
                                 : ladder.sentence;
    verdict_.setTooltip(words(ladder.sentence));
    verdict_.setText(words(!ladder.rungs.empty() ? verdict
                           : fit                 ? "The first model is being fitted."
                                                 : findings.report.verdict()),
                     juce::dontSendNotification);
    verdict_.setColour(juce::Label::textColourId, !ladder.rungs.empty() || !fit
                                                      ? toneOf(fit ? ladder.verdict : Verdict::badMeasurement)
                                                      : look::dim);
    if (!ladder.rungs.empty()) {
        const auto& diagnosis = ladder.rungs.back().diagnosis;
        if (findings.file.whatIf && ladder.verdict != Verdict::missingEffect) {
            advice_ = std::make_unique<Advice>(*findings.file.whatIf, [this] { select(noCandidate); });
            rows_.addAndMakeVisible(*advice_);
        }
        for (std::size_t k = 0; k < diagnosis.ranking.size(); ++k) {
            candidates_.push_back(std::make_unique<Candidate>(
                diagnosis.ranking[k], diagnosis.error, k, [this, k] { select(k); }, [this, k] { add(k); }));
            rows_.addAndMakeVisible(*candidates_.back());
        }
        for (const auto& channel : ladder.rungs.front().comparison.channels) {
            falls_.push_back(std::make_unique<PlotView>());
            auto plot = fallPlot(ladder, channel.quantity);
            plot.y.title = "error";
            falls_.back()->show(std::move(plot));
            addAndMakeVisible(*falls_.back());
        }
    }
    select(advice_ ? noCandidate : 0);
    resized();
    repaint();
}

void DiagnosePage::add(std::size_t place)
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

void DiagnosePage::tick()
{
    const bool idle = !session().status().busy;
    const auto rungs = findings_ ? findings_->file.ladder.rungs.size() : 0;
    for (auto& candidate : candidates_)
        candidate->enable(idle);
    undo_.setEnabled(idle && rungs > 1);
    linearize_.setEnabled(rungs > 0);
    report_.setEnabled(idle && rungs > 0);
}

void DiagnosePage::paint(juce::Graphics& g)
{
    if (findings_ && candidates_.empty() && !advice_ && !findings_->file.ladder.rungs.empty()) {
        g.setColour(look::dim);
        g.setFont(14.0f);
        g.drawFittedText("No effect of the catalogue competes.", list_.getBounds().removeFromTop(60),
                         juce::Justification::centred, 2);
    }
}

void DiagnosePage::resized()
{
    auto area = getLocalBounds();
    verdict_.setBounds(area.removeFromTop(64));
    auto foot = area.removeFromBottom(30);
    for (auto* button : {&undo_, &linearize_, &report_, &reveal_}) {
        button->setBounds(foot.removeFromLeft(button == &report_ ? 150 : 190));
        foot.removeFromLeft(8);
    }
    truth_.setBounds(foot);
    area.removeFromBottom(8);
    list_.setBounds(area.removeFromLeft(area.getWidth() * 11 / 20));
    area.removeFromLeft(8);
    const int width = list_.getMaximumVisibleWidth(), head = advice_ ? advice_->heightFor(width) : 0;
    if (advice_)
        advice_->setBounds(0, 0, width, head);
    int below = head;
    for (auto& candidate : candidates_) {
        candidate->setBounds(0, below, width, candidate->height());
        below += candidate->height();
    }
    rows_.setSize(width, std::max(1, below));
    auto top = area.removeFromTop(area.getHeight() / 2);
    evidence_.setBounds(top);
    const int columns = falls_.size() > 2 ? 2 : 1,
              rows = std::max(1, (static_cast<int>(falls_.size()) + columns - 1) / columns);
    for (std::size_t k = 0; k < falls_.size(); ++k)
        falls_[k]->setBounds(area.getX() + static_cast<int>(k) % columns * area.getWidth() / columns,
                             area.getY() + static_cast<int>(k) / columns * area.getHeight() / rows,
                             area.getWidth() / columns, area.getHeight() / rows);
}

}  // namespace excursion::plugin
