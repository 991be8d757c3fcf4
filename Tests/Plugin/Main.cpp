// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/Juce.h"

#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>

int main(int count, char* arguments[])
{
    const juce::ScopedJuceInitialiser_GUI juce;
    return Catch::Session().run(count, arguments);
}
