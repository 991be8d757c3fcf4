// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Diagnosis/Compare.h"
#include "Engine/Loudspeaker/OutputError.h"

namespace excursion {

/// The residual force and voltage of Compare.h at the loudest level of some simulated sections, in bins of x, v and i.
/// A channel set that tells no displacement (velocity, acceleration) gives no force; one without current no voltage,
/// unless the driver is mechanical-only.
std::vector<ResidualCurve> residualCurves(const Model&, const Record&, const std::vector<std::size_t>& sections,
                                          const std::vector<SectionFit>& fits);

}  // namespace excursion
