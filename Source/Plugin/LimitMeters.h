// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Plugin/Meter.h"
#include "Plugin/Page.h"

#include <cstdint>
#include <functional>
#include <tuple>

namespace excursion::plugin {

/// Excursion, voltage and power of what plays, each as a bar that is full where the protection turns the signal down.
/// Those of excursion and power are full at what the margin leaves of the limit. Of a model without physics that gives
/// no excursion, how far out of its fit it goes stands in its place.
class LimitMeters : public juce::Component {
public:
    explicit LimitMeters(Window&);

    void showModel(const AnyModel&);
    void tick();
    int wantedHeight() const;        ///< px
    std::function<void()> reshaped;  ///< wantedHeight() is another
    std::function<void(const juce::String&, bool trouble)> told;
    void resized() override;

private:
    double excursionShare(double margin);
    juce::String motionInWords(double displacement, double range) const;

    Processor& processor_;
    Meter excursion_ {"Excursion"}, voltage_ {"Voltage"}, power_ {"Power"};
    LoadedBoxPointer box_;                          ///< null: a driver is shown
    bool hasCoil_ = false, givesExcursion_ = true;  ///< see AnyModel.h
    bool motionIsGuessed_ = false;                  ///< see KnownScale.h: no millimetres are told
    /// version of the model, switches of its effects, and margin that the share is of
    std::tuple<std::uint64_t, std::uint64_t, double> asked_;
    double share_ = 1.0;
    int faults_ = 0;
};

}  // namespace excursion::plugin
