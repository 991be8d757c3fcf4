// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/OpenDevice.h"

#include <juce_audio_plugin_client/Standalone/juce_StandaloneFilterWindow.h>

namespace excursion::plugin {

juce::AudioDeviceManager* standaloneDevices()
{
    auto* const app = juce::StandalonePluginHolder::getInstance();
    return app != nullptr ? &app->deviceManager : nullptr;
}

}  // namespace excursion::plugin
