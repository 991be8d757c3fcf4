// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Diagnosis/Improvement.h"

namespace excursion {

/// Fits the base (with the effects in `with`), then diagnoses and adds effects until the verdict is no longer
/// missing-effect. A take with a fatal problem gives bad-measurement and no rung.
Ladder improve(const PreparedTake&, const ImproveOptions& = {}, const Progress& = {});

}  // namespace excursion
