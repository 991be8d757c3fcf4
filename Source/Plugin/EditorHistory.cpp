// SPDX-License-Identifier: GPL-3.0-or-later
// What a person loads, saves, adds and takes back through the window.
#include "Plugin/Editor.h"

#include "Engine/Error.h"
#include "Engine/Loudspeaker/ModelFile.h"

#include <nlohmann/json.hpp>

#include <utility>

namespace excursion::plugin {
namespace {

/// Whether a file says that it is a model.
bool holdsModel(const juce::File& file)
{
    if (!file.hasFileExtension("json") || file.getSize() > (1 << 26))
        return false;
    const auto document = nlohmann::json::parse(file.loadFileAsString().toStdString(), nullptr, false);
    if (!document.is_object() || !document.contains("format"))
        return true;
    const auto& format = document["format"];
    return format != "excursion-measurement" && format != "excursion-plan";
}

}  // namespace

/// Whether the history may step; says why not while the session works.
bool Editor::mayStep(const juce::String& wish)
{
    const bool busy = owner_.session().status().busy;
    if (busy)
        tell("Wait until the work is done, or cancel it, before you " + wish + ".", false);
    return !busy;
}

void Editor::undo()
{
    if (!mayStep("take something back"))
        return;
    history_.undo();
    update();
}

void Editor::redo()
{
    if (!mayStep("do something again"))
        return;
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
    // A step moves only the ladder that it is of: one that was cancelled amid other steps has left another.
    const auto back = [this](const std::vector<std::string>& of) {
        return [this, of] {
            if (rungs_ != of)
                return;
            laddering_ = true;
            owner_.session().undo();
        };
    };
    const auto again = [this](const std::vector<std::string>& of, const std::string& effect) {
        return [this, of, effect] {
            if (rungs_ != of)
                return;
            laddering_ = true;
            owner_.session().add(effect);
        };
    };
    if (rungs.size() == before.size() + 1)
        history_.did("Add " + words(rungs.back()), back(rungs), again(before, rungs.back()));
    else if (rungs.size() + 1 == before.size())
        history_.did("Take back " + words(before.back()), again(rungs, before.back()), back(before));
}

/// That another model plays is a step of the history.
void Editor::noteModel(const AnyModel& before, const AnyModel& now)
{
    const auto put = [this](const AnyModel& which) {
        return [this, which] {
            try {
                owner_.setModel(which);
                owner_.tellHostOfState();
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
        linearizes_.reset();
        noteModel(before, model);
        owner_.tellHostOfState();
        tell("The model is from " + from + ".", false);
    } catch (const Error& error) {
        tell(words(error.what()), true);
    }
}

void Editor::linearizeWith(const Model& model, const juce::String& from, double fullScale)
{
    const auto before = owner_.modelVersion();
    use(model, from);
    go(PageName::linearize);
    if (owner_.modelVersion() != before)
        linearize_.turnOn(fullScale);
}

void Editor::linearizeWith(const nlohmann::ordered_json& document, const juce::String& from, double fullScale)
{
    useBox(document, from);
    linearizes_ = fullScale;
    go(PageName::linearize);
}

void Editor::useFile(const juce::File& file)
{
    const auto path = file.getFullPathName().toStdString();
    try {
        const auto text = file.loadFileAsString().toStdString();
        requireShallow(text, path);
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
    linearizes_.reset();
    owner_.rehearsing().load(document, from.toStdString());
    tell("Rehearsing what it is worth to invert the model of " + from + ".", false);
}

void Editor::saveModel(const Model& model)
{
    chooser_ = std::make_unique<juce::FileChooser>(
        "Save the model", juce::File::getSpecialLocation(juce::File::userHomeDirectory).getChildFile("model.json"),
        "*.json");
    chooser_->launchAsync(juce::FileBrowserComponent::saveMode | juce::FileBrowserComponent::warnAboutOverwriting,
                          [this, model](const juce::FileChooser& chosen) {
                              if (chosen.getResult() != juce::File())
                                  saveModel(model, chosen.getResult());
                          });
}

void Editor::saveModel(const Model& model, const juce::File& file)
{
    try {
        writeModel(model, file.getFullPathName().toStdString());
        tell("Wrote " + file.getFullPathName() + ".", false);
    } catch (const Error& error) {
        tell(words(error.what()), true);
    }
}

void Editor::onceAgreed(bool withRecording, const juce::String& wish, std::function<void()> then)
{
    auto lost = words(owner_.session().unsaved(withRecording));
    if (auto* measuring = measure_.measuring(); withRecording && measuring != nullptr && measuring->running())
        lost += (lost.isEmpty() ? "" : " and ") + juce::String("the measurement under way");
    if (lost.isEmpty()) {
        then();
        return;
    }
    question_ = std::make_unique<Question>("Not saved, and lost by this: " + lost + ".",
                                           wish.substring(0, 1).toUpperCase() + wish.substring(1));
    agreed_ = std::move(then);
    body_.addAndMakeVisible(*question_);
    question_->setBounds(body_.getLocalBounds());
    question_->enterModalState(false);
}

void Editor::hearAnswer()
{
    if (!question_ || !question_->answered())
        return;
    const auto asked = std::move(question_);
    const auto then = std::exchange(agreed_, {});
    if (*asked->answered())
        then();
}

/// What came of a model without physics that was loaded.
void Editor::noteRehearsal()
{
    const auto status = owner_.rehearsing().status();
    if (status.version == rehearsed_)
        return;
    rehearsed_ = status.version;
    if (!status.trouble && replaced_) {  // the processor tells the host
        noteModel(*replaced_, owner_.anyModel());
        const auto box = owner_.box();
        if (linearizes_ && box && box->played.rehearsal)
            linearize_.turnOn(*linearizes_);
    }
    replaced_.reset();
    linearizes_.reset();
    tell(words(status.words), status.trouble);
}

void Editor::load(const juce::File& file)
{
    if (!holdsModel(file)) {
        measure_.open(file);
        return;
    }
    useFile(file);
    go(PageName::linearize);
}

void Editor::filesDropped(const juce::StringArray& files, int, int)
{
    try {
        load(juce::File(files[0]));
    } catch (const std::exception& error) {  // no host expects one here
        tell(words(error.what()), true);
    }
}

}  // namespace excursion::plugin
