// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"
#include "Engine/Estimate/Record.h"
#include "Engine/Progress.h"

#include <string>
#include <vector>

namespace excursion {

/// What a model adds to a channel that its linear part would not, for a stimulus u. Played as it is and upside down, it
/// falls apart:
///     even = (y(u) + y(-u))/2,     odd = (y(u) - y(-u))/2 - g yl,
/// yl the response of the linear part. g is what of the odd part is no distortion but a change of level: on the lines
/// of a multisine that leaves odd lines out it is free on each line, so that the lines left out show the distortion,
/// which then is taken to be as strong between them; for any other stimulus it is one complex number a band of a third
/// of an octave, at least eight lines wide.
struct ChannelDistortion {
    Quantity quantity = Quantity::displacement;
    double rms = 0.0;  ///< of the channel, in its unit
    /// 10 log10 of the power over that of the whole model's channel; -120 where there is none
    double evenDb = 0.0, oddDb = 0.0;
    /// level of the odd part over that of the linear part: below zero is compression
    double gainDb = 0.0;
    std::vector<double> frequency;  ///< Hz, centres of bands that the stimulus excites
    /// dB in these; even and odd over the power of the whole model's channel in the band
    std::vector<double> even, odd, gain;
};

/// An effect switched off, and alone on beside the linear ones. A list is empty where it makes no sense (an effect that
/// is linear has no distortion of its own) or where that loudspeaker runs away.
struct EffectDistortion {
    std::string effect;                             ///< id
    std::vector<ChannelDistortion> without, alone;  ///< [channel], as DistortionByEffect::whole
};

struct DistortionByEffect {
    double level = 0.0;                     ///< V (or N) rms of the stimulus
    std::vector<ChannelDistortion> whole;   ///< current of a driver with a coil, displacement, sound pressure
    std::vector<EffectDistortion> effects;  ///< in the order of the model
};

/// Plays sections of a record to the model, to the model without each of its effects, and with each alone; powers are
/// means over the sections.
/// @param sections  indices into record.sections, all of one shape
/// @throws Error (numerical) when the model itself runs away
DistortionByEffect distortionByEffect(const Model&, const Record&, const std::vector<std::size_t>& sections,
                                      const Progress& = {});

/// The sections that drive a model hardest: those of the loudest level, or the one of the largest rms where there are
/// no levels.
std::vector<std::size_t> loudestSections(const Record&);

}  // namespace excursion
