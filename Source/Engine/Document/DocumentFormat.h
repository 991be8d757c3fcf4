// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Document/JsonField.h"

#include <nlohmann/json.hpp>

#include <string_view>

namespace excursion {

/// What a JSON document begins with: the name of its format and the version of that. A format that is read has one
/// constant, which its writer and its reader share.
struct DocumentFormat {
    std::string_view name;
    int version = 1;

    /// A document of this format with these fields after its header.
    nlohmann::ordered_json with(const nlohmann::ordered_json& fields = nlohmann::ordered_json::object()) const;

    /// Throws Error (input) unless the document says that it has this format and version.
    void require(const JsonField& document) const;
};

}  // namespace excursion
