// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Fit.h"

namespace excursion {

/// A fit by simulation on all sections that are not held out, as thorough as worthwhile: rough far above the noise,
/// with gradients from fed laws near it. At the noise laws are expanded further where that still pays. What does not
/// pay of any law is taken back.
/// @param toTheEnd  fits as far as possible if something is left, before the remainder is called unknown
FitSummary fitBySimulation(Model&, const Record&, const FitOptions&, bool toTheEnd, const Progress& = {});

/// Refits a model whose newest effects have just been found. Everything is free, and laws are expanded as far as
/// justified. For a take with periods the fits are quick ones. A model that comes near the noise, or was better in
/// simulation, is fitted by simulation in the end. If not, FitSummary::substeps is 0.
FitSummary refine(Model&, const Record&, const FitOptions&, const Progress& = {});

/// refine(), against the noise without drift once the model follows what the periods drift (followsDrift()): such
/// a model is fitted again, or stays if that fails. The record may have another noise then.
FitSummary refineByNoise(Model&, Record&, const FitOptions&, const Progress& = {});

}  // namespace excursion
