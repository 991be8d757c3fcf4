// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/OpenDevice.h"

#include <juce_audio_plugin_client/Standalone/juce_StandaloneFilterWindow.h>

namespace excursion::plugin {

juce::AudioDeviceManager* standaloneDevices()
{
    auto* const app = juce::StandalonePluginHolder::getInstance();
    return app != nullptr ? &app->deviceManager : nullptr;
}

void enableAppOptions(bool enabled)
{
    for (int k = 0; k < juce::TopLevelWindow::getNumTopLevelWindows(); ++k)
        if (auto* window = dynamic_cast<juce::StandaloneFilterWindow*>(juce::TopLevelWindow::getTopLevelWindow(k)))
            for (auto* child : window->juce::Component::getChildren())
                if (auto* button = dynamic_cast<juce::TextButton*>(child);
                    button != nullptr && button->getButtonText() == "Options")
                    button->setEnabled(enabled);
}

}  // namespace excursion::plugin
