// SPDX-License-Identifier: GPL-3.0-or-later
#include "BlackBox/EveryClass.h"
#include "Plugin/Clicks.h"
#include "Plugin/Editor.h"
#include "Plugin/Walk.h"

#include "Engine/Loudspeaker/ModelFile.h"

#include <catch2/catch.hpp>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <memory>
#include <thread>

using namespace excursion;
using plugin::Editor;
using plugin::Processor;

TEST_CASE("A model is loaded from a file, and what is none is told and changes nothing", "[plugin]")
{
    const auto folder = std::filesystem::temp_directory_path() / "excursion plugin \u00e4";
    std::filesystem::create_directories(folder);
    Processor processor;
    Editor editor(processor);
    auto model = plugin::modelFromText(plugin::factoryDrivers().front().text, "a driver");
    model.name = "of a file";
    writeModel(model, folder / "model.json");
    std::ofstream(folder / "broken.json") << "{\"format\": \"excursion-model\"";
    editor.load(juce::File(folder.string()).getChildFile("model.json"));
    CHECK(processor.model().name == "of a file");
    CHECK(editor.status().contains("model.json"));
    editor.load(juce::File(folder.string()).getChildFile("broken.json"));
    CHECK(processor.model().name == "of a file");
    CHECK(editor.status().contains("broken.json"));
    model.baseParameter("Bl").value = 0.0;
    writeModel(model, folder / "model.json");
    editor.load(juce::File(folder.string()).getChildFile("model.json"));
    CHECK(processor.model().baseParameter("Bl").value > 0.0);
    CHECK(editor.status().contains("Bl"));
    std::filesystem::remove_all(folder);
}

TEST_CASE("The window opens and closes while audio runs", "[plugin]")
{
    Processor processor;
    processor.prepareToPlay(48000.0, 128);
    std::atomic<bool> done {false};
    std::thread audio([&] {
        juce::AudioBuffer<float> buffer(2, 128);
        juce::MidiBuffer midi;
        while (!done) {
            buffer.clear();
            processor.processBlock(buffer, midi);
        }
    });
    for (int k = 0; k < 10; ++k) {
        const std::unique_ptr<juce::AudioProcessorEditor> editor(processor.createEditor());
        CHECK(editor->getWidth() > 0);
        processor.editorBeingDeleted(editor.get());
    }
    done = true;
    audio.join();
}

TEST_CASE("A model without physics is loaded from a file, told what it is worth, and taken back", "[plugin][blackbox]")
{
    const auto folder = std::filesystem::temp_directory_path() / "excursion plugin boxes";
    std::filesystem::create_directories(folder);
    Processor processor;
    Editor editor(processor);
    const auto first = processor.model().name;
    const auto load = [&](const nlohmann::ordered_json& document) {
        std::ofstream(folder / "box.json") << document;
        editor.load(juce::File(folder.string()).getChildFile("box.json"));
        CHECK(editor.status().contains("box.json"));
        processor.rehearsing().wait();
        editor.update();
    };
    auto document = everyClass()[2];
    load(document);
    REQUIRE(processor.box());
    CHECK(editor.status().contains("a gain of"));
    CHECK(editor.history().canUndo());
    editor.undo();
    CHECK_FALSE(processor.box());
    editor.redo();
    REQUIRE(processor.box());
    CHECK(processor.box()->document == document);
    document.erase("stimulus");
    document["name"] = "another";
    load(document);
    CHECK(editor.status().contains("stimulus"));
    CHECK(processor.box()->played.box.name == "block");
    editor.undo();
    CHECK_FALSE(processor.box());
    CHECK(processor.model().name == first);
    std::filesystem::remove_all(folder);
}

TEST_CASE("A measured driver is linearized at the volts that its output was measured with, a step and a gesture of its "
          "own",
          "[plugin]")
{
    Processor processor;
    Editor editor(processor);
    auto findings = std::make_shared<plugin::Findings>(*plugin::syntheticFindings(2));
    const auto click = [&] {
        editor.show(findings);
        editor.go(plugin::PageName::diagnose);
        editor.update();
        plugin::click(editor, "Linearize with this model");
        return processor.parameters().settings().fullScale;
    };
    CHECK(click() == 10.0);  // as it is not known
    editor.undo();
    editor.undo();
    findings->fullScale = 16.125;
    CHECK(click() == 16.125);
    CHECK(processor.parameters().settings().mode == Mode::linearize);
    editor.undo();
    CHECK(editor.history().nextBack() == "Volts at 0 dBFS");
    editor.undo();
    CHECK(processor.parameters().settings().fullScale == 10.0);
    editor.redo();
    CHECK(processor.parameters().settings().fullScale == 16.125);
}

TEST_CASE("The model of a diagnosis is saved as a file that can be loaded", "[plugin]")
{
    Processor processor;
    Editor editor(processor);
    const auto findings = plugin::syntheticFindings(2);
    editor.show(findings);
    editor.go(plugin::PageName::diagnose);
    editor.update();
    REQUIRE(plugin::find<juce::TextButton>(editor, "Save the model...") != nullptr);
    CHECK(plugin::find<juce::TextButton>(editor, "Save the model...")->isEnabled());
    const auto file = juce::File::createTempFile("model.json");
    const auto& model = findings->file.ladder.model();
    editor.saveModel(model, file);
    CHECK(editor.status().contains(file.getFullPathName()));
    CHECK(toJson(readModel(file.getFullPathName().toStdString())).dump() == toJson(model).dump());
    file.deleteFile();
    editor.saveModel(model, juce::File("/nowhere/at all/model.json"));
    CHECK(editor.status().contains("at all"));
}
