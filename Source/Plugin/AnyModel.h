// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/BlackBox/PlayedBox.h"
#include "Engine/Loudspeaker/Model.h"

#include <nlohmann/json.hpp>

#include <memory>
#include <string>
#include <string_view>
#include <variant>

namespace excursion::plugin {

/// A model without physics, ready to be played. It does not change once it is made.
struct LoadedBox {
    nlohmann::ordered_json document;  ///< as it was read: what a state keeps
    PlayedBox played;
};
using LoadedBoxPointer = std::shared_ptr<const LoadedBox>;

/// Takes seconds, as it rehearses. Throws Error (input) for a document that is broken, (data) for a model that cannot
/// be played, (cancelled).
LoadedBoxPointer loadedBox(const nlohmann::ordered_json& document, const std::string& where, const Progress& = {});

/// What the plugin plays: a driver, or a model without physics.
using AnyModel = std::variant<Model, LoadedBoxPointer>;

/// Whether it has a coil, whose heat may be limited.
bool hasCoil(const AnyModel&);
/// Whether it tells how far the cone moves, as a driver always does.
bool givesExcursion(const AnyModel&);
/// Whether it tells how far the cone may move: as far as its laws over x, or its states, were measured.
bool limitsExcursion(const AnyModel&);

/// Whether the text is the document of a model without physics.
bool holdsBox(std::string_view text);

}  // namespace excursion::plugin
