// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Plugin/Juce.h"

namespace excursion::plugin {

/// The items of a list; what was chosen stays chosen as far as it can. A list that is open and gets other items closes:
/// the place that is clicked would be one of the items before.
inline void fillList(juce::ComboBox& list, const juce::StringArray& items, int otherwise)
{
    juce::StringArray present;
    for (int k = 0; k < list.getNumItems(); ++k)
        present.add(list.getItemText(k));
    if (present == items && list.getSelectedItemIndex() >= 0)
        return;
    list.hidePopup();
    const int before = list.getSelectedItemIndex();
    list.clear(juce::dontSendNotification);
    list.addItemList(items, 1);
    list.setSelectedItemIndex(before >= 0 && before < items.size() ? before : otherwise, juce::dontSendNotification);
}

}  // namespace excursion::plugin
