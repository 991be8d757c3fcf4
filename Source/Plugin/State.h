// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Predistortion/Recipe.h"
#include "Plugin/AnyModel.h"

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace excursion::plugin {

/// Numbers that a host has sent between the steps of parameters, by their ids.
using Between = std::map<std::string, double>;

/// What a host keeps of the plugin, format "excursion-plugin-state", version 1: the recipe and the model itself, of
/// whatever class, not a path to it. Same state, same bytes.
struct State {
    Recipe recipe;
    AnyModel model;
    Between between;  ///< if any
};

std::string bytesOf(const State&);
/// A model without physics is rehearsed, which takes seconds. Throws Error (input), and (data) as loadedBox().
/// @param known  null, or a model that is taken where the state holds the same document
State stateFrom(std::string_view bytes, const LoadedBoxPointer& known = nullptr);

/// A document that is built in.
struct Factory {
    std::string title;
    std::string_view text;
};
const std::vector<Factory>& factoryDrivers();  ///< by resonance, the highest first
const std::vector<Factory>& factoryRecipes();

Model modelFromText(std::string_view text, const std::string& where);    ///< throws Error (input)
Recipe recipeFromText(std::string_view text, const std::string& where);  ///< throws Error (input)

}  // namespace excursion::plugin
