// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/OutputError.h"

#include <optional>
#include <vector>

namespace excursion {

/// A step of the rest position of the cone between two sections of a take. Comparisons leave 0 Hz out, as a sensor's
/// zero is arbitrary; but it is the same in all sections. So the mean displacement d_n of the sections, in their order
/// in time, is
///     d_n = m_n + c + b m_n   (+ s after the step),
/// m_n the model's, c the sensor's zero, and b by how much softer the suspension is at 0 Hz than in the band.
struct RestShift {
    double moved = 0.0;                ///< m
    double after = 0.0, before = 0.0;  ///< s in the take: the middles of the sections on either side
};

/// The step that leaves least, with two sections at least on either side, where it leaves hardly anything: a
/// twentieth of the step (a sensor's zero that drifts, or a suspension that creeps, leaves more). It stands above the
/// noise, above all that the model explains at 0 Hz, above a hundredth of the largest rms displacement, and is seen in
/// the measured means themselves (a sensor may hold back what is constant). None without a displacement channel,
/// periods, or four sections, nor where the levels change at the same time, so that b explains it.
/// @param fits  of all sections of the record, with spectra
std::optional<RestShift> restShift(const Record&, const std::vector<SectionFit>& fits);

}  // namespace excursion
