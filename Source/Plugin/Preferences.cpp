// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/Preferences.h"

#include "Engine/Document/JsonText.h"
#include "Plugin/Text.h"

#include <nlohmann/json.hpp>

#include <array>
#include <cmath>

namespace excursion::plugin {
namespace {

constexpr auto preferencesName = "excursion-window";
constexpr std::array themes {"system", "light", "dark"};
constexpr int largest = 16384;  // px, of a side of a window

}  // namespace

juce::File preferencesFile()
{
    if (const auto named = juce::SystemStats::getEnvironmentVariable("EXCURSION_PREFERENCES", {}); named.isNotEmpty())
        return juce::File::getCurrentWorkingDirectory().getChildFile(named);
    return juce::File::getSpecialLocation(juce::File::userApplicationDataDirectory)
        .getChildFile("excursion")
        .getChildFile("window.json");
}

Preferences readPreferences(const juce::File& file)
{
    Preferences result;
    const auto document = nlohmann::json::parse(file.loadFileAsString().toStdString(), nullptr, false);
    if (!document.is_object())
        return result;
    const auto number = [&document](const char* key, double least, double most) {
        const auto found = document.find(key);
        if (found == document.end() || !found->is_number())
            return 0.0;
        const double value = found->get<double>();
        return value >= least && value <= most ? value : 0.0;
    };
    result.scale = number("scale", Preferences::leastScale, Preferences::mostScale);
    result.width = static_cast<int>(number("width", 1, largest));
    result.height = static_cast<int>(number("height", 1, largest));
    for (std::size_t k = 0; k < themes.size(); ++k)
        if (const auto theme = document.find("theme"); theme != document.end() && *theme == themes[k])
            result.theme = static_cast<look::Theme>(k);
    return result;
}

bool writePreferences(const Preferences& preferences, const juce::File& file)
{
    const nlohmann::ordered_json document {{"format", preferencesName},
                                           {"scale", preferences.scale},
                                           {"theme", themes[static_cast<std::size_t>(preferences.theme)]},
                                           {"width", preferences.width},
                                           {"height", preferences.height}};
    return file.getParentDirectory().createDirectory().wasOk() && file.replaceWithText(words(jsonText(document)));
}

}  // namespace excursion::plugin
