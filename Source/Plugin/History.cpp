// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/History.h"

#include <utility>

namespace excursion::plugin {
namespace {

class Step : public juce::UndoableAction {
public:
    Step(std::function<void()> back, std::function<void()> again) : back_(std::move(back)), again_(std::move(again)) {}

    bool perform() override
    {
        if (std::exchange(done_, true))
            again_();
        return true;
    }
    bool undo() override
    {
        back_();
        return true;
    }

private:
    std::function<void()> back_, again_;
    bool done_ = false;
};

}  // namespace

void History::did(const juce::String& what, std::function<void()> back, std::function<void()> again)
{
    if (moving_)
        return;
    steps_.beginNewTransaction(what);
    steps_.perform(new Step(std::move(back), std::move(again)));
}

void History::undo()
{
    const juce::ScopedValueSetter<bool> within(moving_, true);
    steps_.undo();
}

void History::redo()
{
    const juce::ScopedValueSetter<bool> within(moving_, true);
    steps_.redo();
}

}  // namespace excursion::plugin
