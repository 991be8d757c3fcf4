// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/LimitMeters.h"

#include "Engine/BlackBox/BoxProtection.h"
#include "Engine/Datasheet/KnownScale.h"
#include "Engine/Error.h"
#include "Engine/Predistortion/Predistorter.h"

#include <cmath>

namespace excursion::plugin {
namespace {

constexpr int meterHeight = 30, meterGap = 4;  // px, of each

}  // namespace

LimitMeters::LimitMeters(Window& window) : processor_(window.processor())
{
    for (auto* meter : {&excursion_, &voltage_, &power_})
        addAndMakeVisible(meter);
    power_.setVisible(false);
}

void LimitMeters::showModel(const AnyModel& model)
{
    const auto* box = std::get_if<LoadedBoxPointer>(&model);
    box_ = box != nullptr ? *box : nullptr;
    hasCoil_ = hasCoil(model);
    givesExcursion_ = givesExcursion(model);
    const auto* driver = std::get_if<Model>(&model);
    motionIsGuessed_ = driver != nullptr && withKnown(*driver, {}).motionIsGuessed;
    excursion_.setHead(givesExcursion_ ? "Excursion" : "Region");
}

/// What the protection leaves of the limit. It is asked for only when it can be another, as a driver's sensitivity to
/// its parameters is computed for it.
double LimitMeters::excursionShare(double margin)
{
    const std::tuple question {processor_.modelVersion(), processor_.parameters().switches(), margin};
    if (question == asked_)
        return share_;
    asked_ = question;
    share_ = 1.0;
    if (box_) {
        if (const auto& rehearsal = box_->played.rehearsal)  // without one it is only heard, and nothing is protected
            share_ = BoxProtection::share(box_->played.box, *rehearsal, margin);
        return share_;
    }
    const auto whole = processor_.model();
    try {
        share_ = Predistorter::share(withoutOff(whole, processor_.parameters().recipe()), margin);
    } catch (const Error&) {
        share_ = Predistorter::share(whole, margin);  // it plays whole where it cannot be run without some effect
    }
    return share_;
}

juce::String LimitMeters::motionInWords(double displacement, double range) const
{
    juce::StringArray parts;
    if (!motionIsGuessed_)
        parts.add(juce::String(1e3 * displacement, 2) + " mm");
    parts.add(std::isfinite(range) ? whole(100.0 * displacement / range) + " % of what was measured"
                                   : juce::String("not limited: the model tells no range"));
    return parts.joinIntoString(", ");
}

void LimitMeters::tick()
{
    const auto meters = processor_.collectMeters();
    const double range = box_ ? measuredDisplacement(box_->played) : measuredDisplacement(processor_.model());
    const auto limits = processor_.parameters().controls(range).predistortion;
    if (!processor_.standstill().empty())
        excursion_.show(0.0, "no engine runs at this rate: the signal goes through as it is", 0.0);
    else if (!givesExcursion_)
        excursion_.show(meters.region, whole(100.0 * meters.region) + " % of where it was fitted",
                        meters.displacementReduction);
    else
        excursion_.show(meters.displacement / (limits.displacementLimit * excursionShare(limits.margin)),
                        motionInWords(meters.displacement, range), meters.displacementReduction);
    voltage_.show(meters.voltage / limits.voltageLimit, juce::String(meters.voltage, 1) + " V",
                  meters.voltageReduction);
    if (const bool shown = std::isfinite(limits.powerLimit) && hasCoil_ && (!box_ || limits.coilResistance > 0.0);
        shown != power_.isVisible()) {
        power_.setVisible(shown);
        if (reshaped)
            reshaped();
    }
    const double powerMargin = givesExcursion_ ? limits.margin
                                               : 0.0;  // without it there is no margin, see BoxProtection
    power_.show(meters.power / (limits.powerLimit * Protection::powerShare(powerMargin)),
                juce::String(meters.power, meters.power < 10.0 ? 2 : 1) + " W", meters.powerReduction);
    if (meters.faults > faults_ && told)
        told("Something was not finite: the engine has started anew.", true);
    faults_ = meters.faults;
}

int LimitMeters::wantedHeight() const { return (power_.isVisible() ? 3 : 2) * (meterHeight + meterGap); }

void LimitMeters::resized()
{
    auto area = getLocalBounds();
    for (auto* meter : {&excursion_, &voltage_, &power_}) {
        if (!meter->isVisible())
            continue;
        meter->setBounds(area.removeFromTop(meterHeight));
        area.removeFromTop(meterGap);
    }
}

}  // namespace excursion::plugin
