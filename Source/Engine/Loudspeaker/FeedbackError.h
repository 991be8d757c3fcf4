// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/FedLaws.h"
#include "Engine/Loudspeaker/OutputError.h"
#include "Engine/Loudspeaker/ShownMotions.h"

#include <vector>

namespace excursion {

/// The result of outputError() with laws that do not follow the simulation but are fed with the motion in the take
/// (nonlinear identification through feedback of the outputs, Adams & Allemang 2000, Mech. Syst. Signal Process. 14).
/// The model's linear part is exact,
///     Y = G_u (U - sum U_laws) + G_F sum F_laws,
/// with G_u and G_F the responses to the terminals and to a force on the cone, and U_laws and F_laws the laws' voltage
/// and force for the shown motion. Only the memories of laws are integrated. The residuals are linear in the strengths
/// of all laws at once and cannot run away. For a true model the error is the noise, as long as the noise of the shown
/// motion is small. A wrong model is judged by what its equations lack, not by where its simulation goes. `options`
/// apply as far as they do not concern steps.
/// @param motions  one per section of `sections`
/// @param played   if given, the result of a simulation of these sections, with spectra: the residuals are its own, and
///                 only the slopes are those of fed laws (it is the result where it is not finite). These differ from a
///                 simulation's by the effect of a law's change on the motion that it is fed. As the residuals are
///                 exact, the search still arrives where they are noise.
/// @param known  if given, one per section: slopes that depend on the motion alone, kept from one call to the next as
///               long as motions and `active` stay the same
std::vector<SectionFit> feedbackError(const Model&, const Record&, const std::vector<std::size_t>& sections,
                                      const ShownMotions& motions, const std::vector<Eigen::Index>& active,
                                      const OutputErrorOptions& options, const Progress& = {},
                                      const std::vector<SectionFit>* played = nullptr,
                                      std::vector<KnownSlopes>* known = nullptr);

/// outputError() of a record with periods, with the slopes of fed laws if slopes are asked for: in a tenth of the time.
std::vector<SectionFit> playedError(const Model&, const Record&, const std::vector<std::size_t>& sections,
                                    const ShownMotions& motions, const std::vector<Eigen::Index>& active,
                                    const OutputErrorOptions&, const Progress& = {});

/// Whether a simulation leaves less than fed laws: then the noise of the fed motion exceeds the model's error. Always
/// false for a record without periods and for a model without laws.
bool isBetterPlayed(const Model&, const Record&, const std::vector<std::size_t>& sections, const OutputErrorOptions&);

/// The quickest error of a model. If the record has periods: with laws fed with the settled motion, or playedError() if
/// the options say so; else by simulation.
std::vector<SectionFit> quickError(const Model&, const Record&, const std::vector<std::size_t>& sections,
                                   const std::vector<Eigen::Index>& active, const OutputErrorOptions&,
                                   const Progress& = {});

/// The record without the laws of a model: every channel minus their contribution, so that its responses are those of
/// the linear part, and of what the model lacks. The record itself if it has no periods, or if the model has no active
/// law.
Record withoutLaws(const Model&, const Record&, unsigned threads = 2);

}  // namespace excursion
