// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/OutputError.h"

#include <optional>
#include <vector>

namespace excursion {

/// A step of the rest position of the cone between two sections of a take. Comparisons leave 0 Hz out, as a sensor's
/// zero is arbitrary; but it is the same in all sections. So what the mean displacement of a section has beside the
/// model's,
///     e_n = mean x_n - mean x_model,n,
/// steps by what the suspension, or the sensor, has moved.
struct RestShift {
    double moved = 0.0;                ///< m
    double after = 0.0, before = 0.0;  ///< s in the take: the middles of the sections on either side
};

/// The largest step of e_n, where it is one: above the noise, far above the other steps (a sensor's zero drifts), above
/// whatever the model explains at 0 Hz (a suspension gives way there by more than in the band), above a hundredth of
/// the largest rms displacement, and seen in the measured means themselves (a sensor may hold back what is constant).
/// None without a displacement channel, periods, or three sections.
/// @param fits  of all sections of the record, with spectra
std::optional<RestShift> restShift(const Record&, const std::vector<SectionFit>& fits);

}  // namespace excursion
