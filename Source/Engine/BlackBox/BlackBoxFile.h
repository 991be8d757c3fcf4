// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Document/JsonField.h"
#include "Engine/BlackBox/BlackBox.h"

#include <filesystem>

namespace excursion {

/// Whether the document is one of a model without physics that can be played: "excursion-pnlss",
/// "excursion-fractional-pnlss", "excursion-block-model", "excursion-parallel-hammerstein", "excursion-narx".
bool isBlackBox(const JsonField&);

/// Throws Error (input) naming the field when the document is none of these, (data) for one that does not say what it
/// was fitted under, whose linear part is not stable, or that blackBoxOf() refuses.
BlackBox blackBoxFromJson(const JsonField&);

BlackBox readBlackBox(const std::filesystem::path&);

}  // namespace excursion
