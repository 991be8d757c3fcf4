// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Plugin/Juce.h"

/// The colours of the window.
namespace excursion::plugin::look {

inline const juce::Colour background {0xff14181d}, panel {0xff1e242b}, text {0xffe6ebf0}, dim {0xff8793a0},
    accent {0xff4fb3ff}, warning {0xffff9f43}, grid {0xff2b333c}, good {0xff2bc48a};

}  // namespace excursion::plugin::look
