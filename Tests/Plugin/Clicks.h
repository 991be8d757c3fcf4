// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Plugin/Editor.h"

#include <catch2/catch.hpp>

// of the message loop, which the tests do not run
namespace juce {
bool dispatchNextMessageOnSystemQueue(bool returnIfNoPendingMessages);
}

namespace excursion::plugin {

/// What waits for the message thread is done.
inline void dispatch()
{
    while (juce::dispatchNextMessageOnSystemQueue(true)) {}
}

/// A picture of the window, kept to be looked at; the number of its pixels (every fifth) that are not background.
inline int picture(Editor& editor, const juce::String& name)
{
    const auto image = editor.createComponentSnapshot(editor.getLocalBounds());
    int drawn = 0;
    for (int x = 0; x < image.getWidth(); x += 5)
        for (int y = 0; y < image.getHeight(); y += 5)
            drawn += image.getPixelAt(x, y) != image.getPixelAt(0, 0) ? 1 : 0;
    const juce::File file(juce::String(EXCURSION_SCREENSHOTS) + "/" + name + ".png");
    file.getParentDirectory().createDirectory();
    file.deleteFile();
    juce::FileOutputStream stream(file);
    CHECK(juce::PNGImageFormat().writeImageToStream(image, stream));
    return drawn;
}

template <class Component>
Component* find(juce::Component& parent, const juce::String& text)
{
    for (auto* child : parent.getChildren()) {
        if (auto* match = dynamic_cast<Component*>(child);
            match != nullptr && match->getButtonText() == text && match->isVisible())
            return match;
        if (child->isVisible())
            if (auto* match = find<Component>(*child, text))
                return match;
    }
    return nullptr;
}

inline int clicks = 0;

/// As a person does: only what is seen and enabled can be clicked.
inline void click(Editor& editor, const juce::String& text)
{
    auto* button = find<juce::TextButton>(editor, text);
    INFO(text);
    REQUIRE(button != nullptr);
    REQUIRE(button->isEnabled());
    ++clicks;
    button->onClick();
    editor.update();
}

/// The question that a person is asked now; null: none.
inline Question* question(juce::Component& parent)
{
    for (auto* child : parent.getChildren()) {
        if (auto* asked = dynamic_cast<Question*>(child); asked != nullptr && asked->isVisible())
            return asked;
        if (auto* asked = question(*child))
            return asked;
    }
    return nullptr;
}

inline void answer(Editor& editor, bool agreed)
{
    auto* const asked = question(editor);
    REQUIRE(asked != nullptr);
    asked->answer(agreed);
    editor.update();
    REQUIRE(question(editor) == nullptr);
}

inline void settle(Editor& editor)
{
    editor.processor().session().wait();
    editor.update();
    INFO(editor.status());
    REQUIRE(!editor.processor().session().status().trouble);
}

}  // namespace excursion::plugin
