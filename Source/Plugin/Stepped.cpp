// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/Stepped.h"

#include <algorithm>

namespace excursion::plugin {

void Stepped::set(float proportion)
{
    setValue(proportion);
    tell();
}

void Stepped::tell() { sendValueChangedMessageToListeners(getValue()); }

void Stepped::setValue(float sent)
{
    sent_.store(sent > 0.0f ? std::min(sent, 1.0f) : 0.0f, std::memory_order_relaxed);  // what is no number is 0
}

OnOff& OnOff::operator=(bool on)
{
    set(on ? 1.0f : 0.0f);
    return *this;
}

float OnOff::getValueForText(const juce::String& text) const
{
    for (const auto* word : {"on", "yes", "true"})
        if (text.equalsIgnoreCase(word))
            return 1.0f;
    return text.getIntValue() != 0 ? 1.0f : 0.0f;
}

Choice& Choice::operator=(int index)
{
    set(proportionOf(index));
    return *this;
}

}  // namespace excursion::plugin
