// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Batch/Collection.h"

#include <filesystem>
#include <string>

namespace excursion {

/// The page of a batch: yield, units, outliers, all quantities over the batch, and the laws of all units. One
/// self-contained HTML page as reportHtml(); same collection, same bytes. Throws Error (numerical) when gnuplot is
/// missing.
std::string batchHtml(const Collection&);

void writeBatchReport(const Collection&, const std::filesystem::path&);

}  // namespace excursion
