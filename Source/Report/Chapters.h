// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Diagnosis/LadderFile.h"
#include "Report/Page.h"

#include <string>
#include <vector>

namespace excursion {

/// The chapters of the report, each in its own file. All but the first two need a rung.
void addVerdict(Page&, const LadderFile&);    ///< the answer and what it was got from
void addProblems(Page&, const LadderFile&);   ///< what is wrong with the take
void addRungs(Page&, const LadderFile&);      ///< how the error fell
void addEffects(Page&, const LadderFile&);    ///< Bl(x), K(x), hysteresis loops, ... with their bands
void addWhatIf(Page&, const LadderFile&);     ///< which effect makes which distortion; limits of the stroke
void addResponses(Page&, const LadderFile&);  ///< impedance and other frequency responses
void addSpectra(Page&, const LadderFile&);    ///< per level and channel
void addResiduals(Page&, const LadderFile&);  ///< missing force and voltage, before and after each rung
void addRanking(Page&, const LadderFile&);    ///< what competed at each rung, and why
void addParameters(Page&, const LadderFile&);

}  // namespace excursion
