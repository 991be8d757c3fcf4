// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Diagnosis/LadderFile.h"
#include "Report/Page.h"

#include <string>
#include <vector>

namespace excursion {

/// The sections of the report, each in its own file. All but the first two need a rung.
void addVerdict(Page&, const LadderFile&);      ///< the answer and what it was got from
void addProblems(Page&, const LadderFile&);     ///< what is wrong with the take
void addRungs(Page&, const LadderFile&);        ///< how the error fell
void addLaws(Page&, const LadderFile&);         ///< Bl(x), K(x), ... with their bands
void addResponses(Page&, const LadderFile&);    ///< impedance and other frequency responses
void addSpectra(Page&, const LadderFile&);      ///< per level and channel
void addResiduals(Page&, const LadderFile&);    ///< missing force and voltage, before and after each rung
void addRanking(Page&, const LadderFile&);      ///< what competed at each rung, and why
void addParameters(Page&, const LadderFile&);

/// Title of an effect of the catalogue; the id itself when the file knows an effect that this program does not.
std::string effectTitle(const std::string& id);

/// "start" for the first rung, "1 · Stiffness K(x)" for the next.
std::string rungTitle(const Ladder&, std::size_t rung);

/// The text with a capital at its head.
std::string capitalized(std::string_view);

/// Columns in which so many pictures leave no hole, at most three.
int columnsFor(std::size_t pictures);

/// Values times the factor of a display unit.
std::vector<double> scaled(const std::vector<double>&, double factor);
double largest(const std::vector<double>&);   ///< magnitude among the finite ones; 0 when there is none

} // namespace excursion
