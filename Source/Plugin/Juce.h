// SPDX-License-Identifier: GPL-3.0-or-later
// What the plugin uses of JUCE, whose headers are not held to our warnings.
#pragma once
#pragma GCC system_header

#include <juce_audio_processors/juce_audio_processors.h>
#include <juce_audio_utils/juce_audio_utils.h>
#include <juce_gui_basics/juce_gui_basics.h>
