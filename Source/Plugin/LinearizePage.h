// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Plugin/Dials.h"
#include "Plugin/ExpectedDistortion.h"
#include "Plugin/LimitMeters.h"
#include "Plugin/ModelDials.h"
#include "Plugin/Page.h"
#include "Plugin/PlotGrid.h"
#include "Plugin/TargetPanel.h"

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace excursion::plugin {

/// What is done to the signal with the model: mode, limits, effects as switches, the laws, the meters of the
/// protection, the target, and the distortion that is to be expected with and without linearization. Of a model without
/// physics, the response of its linear part in place of laws, and no limits that only a cone and a coil have.
class LinearizePage : public Page {
public:
    explicit LinearizePage(Window&);

    void showModel(const AnyModel&);
    void tick() override;
    TargetPanel& target() { return target_; }
    /// As if a person had chosen to linearize; only in bypass, which is the mode that nobody chose.
    /// @param fullScale  V at the loudspeaker for a sample of 1.0, entered before; 0: stays
    void turnOn(double fullScale);
    void resized() override;

private:
    void showDriver(const Model&);
    void showFactory(int id);
    void showBox(const PlayedBox&);
    void showFacts();
    void choose();
    void follow();
    void useAdapted();

    Processor& processor_;
    juce::Label name_, facts_;
    /// A list of which the entry that was chosen last can be chosen again.
    struct Menu : juce::ComboBox {
        void showPopup() override
        {
            setSelectedId(0, juce::dontSendNotification);
            juce::ComboBox::showPopup();
            opened_ = true;
        }
        /// Closed, but without a choice; asked once.
        bool isDismissed()
        {
            const bool closed = opened_ && !isPopupActive();
            opened_ = opened_ && !closed;
            return closed && getSelectedId() == 0;
        }

    private:
        bool opened_ = false;
    };
    Menu drivers_, recipes_;
    int shownDriver_ = 0;  ///< in the list; 0: none
    juce::String shownRecipe_;
    juce::TextButton load_ {"Load a model..."}, adapt_ {"Adapt"}, save_ {"Save..."};
    ChoiceBox mode_;
    ModelDials dials_;
    PlotGrid laws_ {"Laws of the model"};
    ExpectedDistortion distortion_;
    TargetPanel target_;
    LimitMeters meters_;
    LoadedBoxPointer box_;        ///< null: a driver is shown
    std::uint64_t followed_ = 0;  ///< version of a model that has followed its take, which the facts tell of
    std::unique_ptr<juce::FileChooser> chooser_;
};

}  // namespace excursion::plugin
