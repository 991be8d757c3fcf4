// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/AnyModel.h"

#include "Engine/BlackBox/BoxMotion.h"
#include "Engine/BlackBox/ModelDocument.h"
#include "Engine/Predistortion/RealTime.h"

#include <cmath>

namespace excursion::plugin {

LoadedBoxPointer loadedBox(const nlohmann::ordered_json& document, const std::string& where, const Progress& progress)
{
    const nlohmann::json plain(document);
    const auto box = blackBoxOf(modelDocumentFrom(JsonField(plain, "", where)));
    return std::make_shared<const LoadedBox>(LoadedBox {document, PlayedBox(box, progress)});
}

bool hasCoil(const AnyModel& model)
{
    const auto* box = std::get_if<LoadedBoxPointer>(&model);
    return box != nullptr ? drivesCoil((*box)->played.box) : std::get<Model>(model).electrical();
}

bool givesExcursion(const AnyModel& model)
{
    const auto* box = std::get_if<LoadedBoxPointer>(&model);
    return box == nullptr || std::isfinite(measuredDisplacement((*box)->played));
}

bool limitsExcursion(const AnyModel& model)
{
    const auto* box = std::get_if<LoadedBoxPointer>(&model);
    return box != nullptr ? (*box)->played.rehearsal && givesExcursion(model)
                          : std::isfinite(measuredDisplacement(std::get<Model>(model)));
}

bool holdsBox(std::string_view text)
{
    const auto document = nlohmann::json::parse(text, nullptr, false);
    return document.is_object() && isModelDocument(JsonField(document, "", ""));
}

}  // namespace excursion::plugin
