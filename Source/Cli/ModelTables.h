// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Datasheet/LawTable.h"
#include "Engine/Design/StrokeLimits.h"
#include "Engine/Diagnosis/Compare.h"
#include "Engine/Loudspeaker/Fit.h"
#include "Engine/Loudspeaker/Model.h"

#include <nlohmann/json_fwd.hpp>

#include <string>
#include <vector>

namespace excursion::cli {

class Terminal;

/// The parameters with their standard errors in units of a handy size, then each law at its ends and at rest.
void printParameters(const Model&, Terminal&);

/// Each law at its ends and at rest, with half of its 95 % band.
void printLaws(const std::vector<LawTable>&, Terminal&);

/// How far the coil may go either way.
void printLimits(const StrokeLimits&, Terminal&);

/// Error, noise floor and chi squared of each channel, and what they mean.
void printErrors(const Comparison&, Terminal&);

/// "-28.1", or "-" when it is not known.
std::string decibelText(const std::optional<double>&);

/// Title of what chiSquaredText() writes.
constexpr auto chiSquaredTitle = "\u03c7\u00b2/value";

/// How many times the noise the error is, squared: "1.2", "350", "1.4e+05"; "-" when the noise is not known.
std::string chiSquaredText(double chiSquaredPerValue, bool noiseKnown);

/// "98 %", never 100: nobody is that sure.
std::string confidenceText(double confidence);

/// "the base and force-factor, stiffness"
std::string effectsText(const Model&);

/// What fit and add say of a model in their documents: effects, parameters, the errors and how the fit ended.
nlohmann::ordered_json modelJson(const Model&, const Comparison&, const FitSummary&);

}  // namespace excursion::cli
