// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/LawDrive.h"
#include "Engine/Estimate/Record.h"
#include "Engine/Loudspeaker/ShownMotion.h"
#include "Engine/Loudspeaker/SmallSignal.h"

#include <cstddef>
#include <map>
#include <vector>

namespace excursion {

/// A linear response on the lines of a window.
struct Path {
    Spectrum value;
    std::vector<Spectrum> slopes;  ///< by parameter, empty if the parameter has no influence; none unless asked for
};

/// The linear part of a model, by its responses to the voltage and to a force on the cone, on the lines of a window.
struct Paths {
    std::vector<Path> fromVoltage, fromForce;  ///< by quantity; by line from `first` on
    std::size_t first = 0;
    double lateness = 0.0;  ///< s, of the sound at rest
};

/// 0 Hz is replaced by a small fraction of the first line's frequency, to avoid division by zero.
/// @param resolution  Hz from line to line
Paths pathsOf(const Model&, const std::vector<Quantity>&, std::size_t first, std::size_t last, double resolution,
              bool withGradient, unsigned threads = 1);

/// By window, in samples.
using PathsByWindow = std::map<std::size_t, Paths>;

/// pathsOf() the record's channels on the compared lines of each window of these sections.
PathsByWindow pathsToChannels(const Model&, const Record&, const std::vector<std::size_t>& sections, bool withGradient,
                              unsigned threads = 1);

/// The same of current and displacement, in this order, of the cone itself and from 0 Hz on.
PathsByWindow pathsToMotion(const Model&, const Record&, const std::vector<std::size_t>& sections,
                            unsigned threads = 1);

/// The contributions of all laws for the motion of one section.
struct Fed {
    std::vector<std::size_t> component;  ///< index in the model, one per law
    std::vector<LawDrive> laws;
    Spectrum voltage, force;  ///< at the terminals minus that of the laws, and on the cone
};

/// [component][section], a quarter of a period before its window; empty if the memory is not slow
using LawHistories = std::vector<std::vector<MemoryStart>>;

/// The slow memories of the laws after everything that was played before.
LawHistories lawHistories(const Model&, const Record&, const std::vector<std::size_t>& sections,
                          const std::vector<ShownMotion>&, bool withGradient);

/// By component, the slopes of laws on one section; none where not known.
using KnownSlopes = std::vector<std::shared_ptr<const LawSlopes>>;

/// The laws of a model, fed with the motion of a section. A memory that is not slow is settled there.
/// @param place   place of the section among those of `histories`
/// @param wanted  by component, parameters to differentiate by; empty: none
/// @param known   if given, slopes of this motion, or nearly this one. They are not computed again while they lead as
///                well as new ones: those that depend on the motion alone, and others while their law has hardly moved.
///                New ones are kept there
Fed feed(const Model&, const Record&, const Section&, const ShownMotion&, const LawHistories&, std::size_t place,
         const std::vector<std::vector<bool>>& wanted, KnownSlopes* known = nullptr);

}  // namespace excursion
