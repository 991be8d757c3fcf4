// SPDX-License-Identifier: GPL-3.0-or-later
// The standalone app: JUCE's window around the plugin, which asks before it closes on what is in no file. Compiled for
// the app alone.
#include "Plugin/Editor.h"

#include <juce_audio_plugin_client/Standalone/juce_StandaloneFilterWindow.h>

#include <memory>

namespace excursion::plugin {
namespace {

class AppWindow : public juce::StandaloneFilterWindow {
public:
    using StandaloneFilterWindow::StandaloneFilterWindow;

    void closeButtonPressed() override { juce::JUCEApplicationBase::getInstance()->systemRequestedQuit(); }

    Editor* editor() const { return dynamic_cast<Editor*>(pluginHolder->processor->getActiveEditor()); }

private:
    /// JUCE's own menu, but that what would be lost is asked for before all is as it was at first.
    void buttonClicked(juce::Button*) override
    {
        juce::PopupMenu menu;
        menu.addItem("Audio settings...", [this] { pluginHolder->showAudioSettingsDialog(); });
        menu.addSeparator();
        menu.addItem("Save current state...", [this] { pluginHolder->askUserToSaveState(); });
        menu.addItem("Load a saved state...", [this] { pluginHolder->askUserToLoadState(); });
        menu.addSeparator();
        menu.addItem("Reset to default state", [this] {
            auto* const shown = editor();
            if (shown == nullptr)
                return;
            // later, as this deletes the editor that calls it
            shown->onceAgreed(true, "reset", [window = SafePointer<AppWindow>(this)] {
                juce::MessageManager::callAsync([window] {
                    if (window != nullptr)
                        window->resetToDefaultState();
                });
            });
        });
        menu.showMenuAsync(juce::PopupMenu::Options().withDeletionCheck(*this));
    }
};

class App : public juce::JUCEApplication {
public:
    App()
    {
        juce::PropertiesFile::Options options;
        options.applicationName = getApplicationName();
        options.filenameSuffix = ".settings";
        options.osxLibrarySubFolder = "Application Support";
#if JUCE_LINUX || JUCE_BSD
        options.folderName = "~/.config";
#endif
        settings_.setStorageParameters(options);
    }

    const juce::String getApplicationName() override { return JucePlugin_Name; }
    const juce::String getApplicationVersion() override { return JucePlugin_VersionString; }
    bool moreThanOneInstanceAllowed() override { return true; }

    void initialise(const juce::String&) override
    {
        window_ = std::make_unique<AppWindow>(
            getApplicationName(),
            juce::LookAndFeel::getDefaultLookAndFeel().findColour(juce::ResizableWindow::backgroundColourId),
            settings_.getUserSettings(), false);
        window_->setVisible(true);
    }

    void shutdown() override
    {
        window_ = nullptr;
        settings_.saveIfNeeded();
    }

    void systemRequestedQuit() override
    {
        if (window_ == nullptr) {
            quit();
            return;
        }
        window_->pluginHolder->savePluginState();  // whatever comes of the question
        // Dialogs hold on to the devices, which end before them.
        if (juce::ModalComponentManager::getInstance()->cancelAllModalComponents()) {
            juce::Timer::callAfterDelay(100, [] {
                if (auto* app = JUCEApplicationBase::getInstance())
                    app->systemRequestedQuit();
            });
            return;
        }
        auto* const editor = window_->editor();
        if (editor == nullptr) {
            quit();
            return;
        }
        window_->setMinimised(false);
        window_->toFront(true);
        editor->onceAgreed(true, "quit", [] { quit(); });
    }

private:
    juce::ApplicationProperties settings_;
    std::unique_ptr<AppWindow> window_;
};

}  // namespace
}  // namespace excursion::plugin

juce::JUCEApplicationBase* juce_CreateApplication();
juce::JUCEApplicationBase* juce_CreateApplication() { return new excursion::plugin::App(); }
