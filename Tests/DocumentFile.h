// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Document/JsonField.h"
#include "Engine/Document/JsonText.h"
#include "Scratch.h"

#include <nlohmann/json.hpp>

#include <string>

namespace excursion::test {

/// A document in a file: what its reader makes of it, and of what it refuses after an edit.
template <class From>
class DocumentFile {
public:
    DocumentFile(const nlohmann::ordered_json& document, From from) : from_(from)
    {
        writeJson(document, scratch_ / "document.json");
    }

    auto read() const { return readDocument(scratch_ / "document.json", from_); }

    /// Requires a refusal that names a field.
    template <class Edit>
    void refuses(const std::string& named, Edit edit) const
    {
        auto broken = nlohmann::json::parse(bytesOf(scratch_ / "document.json"));
        edit(broken);
        const auto file = scratch_.file("broken.json", broken.dump());
        refused(Error::Kind::input, named, [&] { readDocument(file, from_); });
    }

private:
    Scratch scratch_;
    From from_;
};

}  // namespace excursion::test
