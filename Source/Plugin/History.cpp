// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/History.h"

#include <utility>

namespace excursion::plugin {
namespace {

class Step : public juce::UndoableAction {
public:
    Step(std::function<void()> back, std::function<void()> again, const bool& asks)
        : back_(std::move(back)), again_(std::move(again)), asks_(asks)
    {
    }

    bool perform() override
    {
        if (std::exchange(done_, true) && asks_)
            again_();
        return true;
    }
    bool undo() override
    {
        if (asks_)
            back_();
        return true;
    }

private:
    std::function<void()> back_, again_;
    const bool& asks_;
    bool done_ = false;
};

}  // namespace

void History::did(const juce::String& what, std::function<void()> back, std::function<void()> again)
{
    if (moving_)
        return;
    last_ = Way::none;
    steps_.beginNewTransaction(what);
    steps_.perform(new Step(std::move(back), std::move(again), asks_));
}

void History::clear()
{
    last_ = Way::none;
    steps_.clearUndoHistory();
}

void History::move(Way way)
{
    const juce::ScopedValueSetter<bool> within(moving_, true);
    if (way == Way::back ? steps_.undo() : steps_.redo())
        last_ = way;
}

void History::undo() { move(Way::back); }
void History::redo() { move(Way::again); }

void History::failed()
{
    if (last_ == Way::none)
        return;
    const juce::ScopedValueSetter<bool> silent(asks_, false);
    move(last_ == Way::back ? Way::again : Way::back);
    last_ = Way::none;
}

}  // namespace excursion::plugin
