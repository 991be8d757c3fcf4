// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/Juce.h"

#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <unistd.h>

int main(int count, char* arguments[])
{
    // The window's preferences are those of nobody.
    const auto preferences = std::filesystem::temp_directory_path() / ("excursion window " + std::to_string(getpid()));
    setenv("EXCURSION_PREFERENCES", preferences.c_str(), 1);
    const juce::ScopedJuceInitialiser_GUI juce;
    const int result = Catch::Session().run(count, arguments);
    std::filesystem::remove(preferences);
    return result;
}
