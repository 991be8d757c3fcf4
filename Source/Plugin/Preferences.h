// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Plugin/Look.h"

namespace excursion::plugin {

/// What a person has chosen of the window, for all windows on this computer: no part of a host's project, where it
/// would make the same state differ from screen to screen.
struct Preferences {
    static constexpr double leastScale = 0.75, mostScale = 3.0;

    double scale = 0.0;  ///< 1: as designed; 0: grows with the window
    look::Theme theme = look::Theme::system;
    int width = 0, height = 0;  ///< of the window, as it was closed; 0: never
};

/// EXCURSION_PREFERENCES where it is set, otherwise the user's folder for settings.
juce::File preferencesFile();

/// What the file says; what it does not say, or what makes no sense, as it is at first.
Preferences readPreferences(const juce::File&);
/// Makes the folder. False when the file cannot be written.
bool writePreferences(const Preferences&, const juce::File&);

}  // namespace excursion::plugin
