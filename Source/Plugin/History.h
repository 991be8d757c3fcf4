// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Plugin/Juce.h"

#include <functional>

namespace excursion::plugin {

/// What a person did, to be taken back and done again. All on the message thread.
class History {
public:
    /// It has been done already. @param what  in words, as in "Undo: Voltage limit"
    void did(const juce::String& what, std::function<void()> back, std::function<void()> again);
    void clear();

    bool canUndo() const { return steps_.canUndo(); }
    bool canRedo() const { return steps_.canRedo(); }
    juce::String nextBack() const { return steps_.getUndoDescription(); }
    juce::String nextAgain() const { return steps_.getRedoDescription(); }
    void undo();
    void redo();
    bool moving() const { return moving_; }  ///< within undo() or redo()
    /// Call it when what undo() or redo() asked for was cancelled or failed: puts the step back without carrying it
    /// out.
    void failed();

private:
    enum class Way { none, back, again };
    void move(Way);

    juce::UndoManager steps_;
    bool moving_ = false;
    bool asks_ = true;      ///< a step that moves does what it stands for
    Way last_ = Way::none;  ///< undo() or redo(), as long as nothing else came
};

}  // namespace excursion::plugin
