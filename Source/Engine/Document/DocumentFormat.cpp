// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Document/DocumentFormat.h"

#include <string>

namespace excursion {

nlohmann::ordered_json DocumentFormat::with(const nlohmann::ordered_json& fields) const
{
    nlohmann::ordered_json document {{"format", name}, {"version", version}};
    for (const auto& [key, value] : fields.items())
        document[key] = value;
    return document;
}

void DocumentFormat::require(const JsonField& document) const
{
    if (!document.value().is_object())
        document.refuse("an object of format " + std::string(name));
    const auto found = document.at("format");
    if (!found.value().is_string() || found.text() != name)
        found.refuse("\"" + std::string(name) + "\"; give another file");
    const auto number = document.at("version");
    if (!number.value().is_number() || number.value().get<double>() != version)
        number.refuse(std::to_string(version) + ", the only version that this program reads");
}

}  // namespace excursion
