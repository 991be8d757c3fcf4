// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Plugin/History.h"
#include "Plugin/Juce.h"
#include "Plugin/Processor.h"
#include "Plugin/Session.h"
#include "Plugin/Text.h"

#include <functional>
#include <memory>

namespace excursion::plugin {

enum class PageName { measure, compare, diagnose, identify, linearize };

/// What a page may ask of the window that it is on.
class Window {
public:
    virtual ~Window() = default;
    virtual Processor& processor() = 0;
    virtual History& history() = 0;
    virtual void go(PageName) = 0;
    /// loads it into the processor; tells when it can't be run
    virtual void use(const Model&, const juce::String& from) = 0;
    /// The same, and the signal is linearized from then on unless a person has chosen what is done with it
    /// @param fullScale  V at the loudspeaker for an output sample of 1.0, of which the limits are told; 0: not known,
    ///                   and the parameter stays
    virtual void linearizeWith(const Model&, const juce::String& from, double fullScale) = 0;
    /// The same with the document of a model without physics, once its rehearsal has found that it helps
    virtual void linearizeWith(const nlohmann::ordered_json&, const juce::String& from, double fullScale) = 0;
    /// use() with the model in a file, of a driver or without physics; the latter is rehearsed first
    virtual void useFile(const juce::File&) = 0;
    /// the document of a model without physics, which is rehearsed first
    virtual void useBox(const nlohmann::ordered_json&, const juce::String& from) = 0;
    virtual void saveModel(const Model&) = 0;  ///< asks for a file
    /// does it, once a person agrees to lose what the session has in no file; at once where that is nothing
    /// @param withRecording  see Session::unsaved()
    virtual void onceAgreed(bool withRecording, const juce::String& wish, std::function<void()>) = 0;
    virtual void tell(const juce::String&, bool trouble) = 0;  ///< in the status line
};

/// One side of the window. All on the message thread.
class Page : public juce::Component {
public:
    explicit Page(Window& window) : window_(window) {}

    virtual void show(const std::shared_ptr<const Findings>&) {}  ///< they are new; never null
    virtual void tick() {}                                        ///< 20 times a second, while the page is seen
    virtual void recolour() {}                                    ///< the theme is another

protected:
    /// Makes them visible; Tab goes through them in this order.
    void add(std::initializer_list<juce::Component*> parts)
    {
        for (auto* part : parts) {
            part->setExplicitFocusOrder(++parts_);
            addAndMakeVisible(part);
        }
    }
    Session& session() { return window_.processor().session(); }

    Window& window_;

private:
    int parts_ = 0;
};

}  // namespace excursion::plugin
