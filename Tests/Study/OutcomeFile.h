// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Study/Case.h"

#include <nlohmann/json_fwd.hpp>

#include <filesystem>
#include <vector>

namespace excursion::study {

nlohmann::ordered_json toJson(const Outcome&);

/// The takes of the file of an earlier study. Throws Error (input) where it is none.
std::vector<Outcome> readOutcomes(const std::filesystem::path&);

}  // namespace excursion::study
