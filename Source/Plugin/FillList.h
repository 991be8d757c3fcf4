// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Plugin/Juce.h"

namespace excursion::plugin {

/// The items of a list; what was chosen stays chosen as far as it can.
inline void fillList(juce::ComboBox& list, const juce::StringArray& items, int otherwise)
{
    const int before = list.getSelectedItemIndex();
    list.clear(juce::dontSendNotification);
    list.addItemList(items, 1);
    list.setSelectedItemIndex(before >= 0 && before < items.size() ? before : otherwise, juce::dontSendNotification);
}

}  // namespace excursion::plugin
