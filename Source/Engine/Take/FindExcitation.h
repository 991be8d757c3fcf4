// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Take/Measurement.h"

#include <optional>
#include <span>
#include <vector>

namespace excursion {

/// The excited DFT lines of a record whose periods are known, ascending.
/// With U_k the DFT of a period averaged over the periods of a realization, power and noise are added
/// over all realizations and levels (each level as if it were 1 V rms). Line k is excited when
///   - its power is 10 dB above the noise of its neighbourhood, which is the scatter between the periods
///     (none is known from one period), and
///   - its power is at most 16 dB below what the excitation must have there if any other line is excited:
///     a multisine is somewhere between white and red, so P_k is at least P_j (j/k)^2 above line j and
///     at least P_j below it. Distortion of an amplifier, 20 dB or more below its neighbours, is left out.
/// @param input  the record of the voltage, at least excitation.totalSamples() long; else Error (data)
std::vector<int> findLines(std::span<const double> input, const Excitation& excitation);

/// What can be told of the excitation from the input alone, when nobody said it: the period and, where
/// the record from its first sample on is a whole number of realizations of equal length (each a period
/// that repeats at least once), their number, the levels and the lines. The periods that
/// differ from the next, and the first of three or more at all events, are taken for settling. Grid is given as "full",
/// shape as "white" and the band by the outer lines: they are not looked for. Absent where any of this does not come
/// out cleanly: then the record is as good as aperiodic.
std::optional<Excitation> findExcitation(std::span<const double> input, double sampleRate);

/// The shortest lag in samples, 16 or more, after which at least 30 % of a record comes again (what is loud
/// counts most, silence does not count); 0 when there is none up to half its length.
int findPeriod(std::span<const double> input);

/// The take with its excitation completed: the lines found where they are missing, all of it where it is absent
/// and can be told (see findExcitation). What is there is not touched.
void completeExcitation(Measurement&);

}  // namespace excursion
