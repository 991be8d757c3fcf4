// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/OutputError.h"
#include "Engine/Loudspeaker/ShownMotions.h"

#include <vector>

namespace excursion {

/// What outputError() tells, where the laws do not follow the simulation but are fed the motion that the take shows
/// (nonlinear identification through feedback of the outputs, Adams & Allemang 2000, Mech. Syst. Signal Process. 14).
/// The model's linear part is exact,
///     Y = G_u (U - sum U_laws) + G_F sum F_laws,
/// G_u and G_F from the terminals and from a force on the cone, U_laws and F_laws what the laws make of the shown
/// motion, as voltage and force. Nothing is integrated but the memories of laws; residuals are linear in the strengths
/// of all laws at once and know no runaway. For a model that is true the error is the noise, as far as that of the
/// shown motion is small; a model that is not is told by what its equations lack, not by where its simulation goes.
/// `options` count as far as they are not about steps.
/// @param motions  one a section of `sections`
/// @param played   when given, what a simulation left of these sections, with spectra: the residuals are its own, and
///                 only the slopes are those of fed laws. These differ from a simulation's by what a law's change does
///                 to the motion that it is fed. With the residuals being exact the search arrives where they are
///                 noise all the same.
std::vector<SectionFit> feedbackError(const Model&, const Record&, const std::vector<std::size_t>& sections,
                                      const ShownMotions& motions, const std::vector<Eigen::Index>& active,
                                      const OutputErrorOptions& options, const Progress& = {},
                                      const std::vector<SectionFit>* played = nullptr);

/// outputError() of a record with periods, with the slopes of laws that are fed where slopes are asked for: at a tenth
/// of the price.
std::vector<SectionFit> playedError(const Model&, const Record&, const std::vector<std::size_t>& sections,
                                    const ShownMotions& motions, const std::vector<Eigen::Index>& active,
                                    const OutputErrorOptions&, const Progress& = {});

/// Whether a simulation leaves less than laws that are fed: the noise of the motion that they are fed is larger then
/// than what is wrong with the model. Never so of a record without periods, and of a model without laws.
bool isBetterPlayed(const Model&, const Record&, const std::vector<std::size_t>& sections, const OutputErrorOptions&);

/// What is quickest told of a model. Where the record has periods: with laws that are fed the settled motion, or
/// playedError() where the options say so; else by simulation.
std::vector<SectionFit> quickError(const Model&, const Record&, const std::vector<std::size_t>& sections,
                                   const std::vector<Eigen::Index>& active, const OutputErrorOptions&,
                                   const Progress& = {});

/// The record as it would be if the laws of a model were not at work: every channel less what they add to it, so that
/// its responses are those of the linear part, and of what the model lacks. The record itself where it has no periods,
/// or where no law is at work.
Record withoutLaws(const Model&, const Record&, unsigned threads = 2);

}  // namespace excursion
