// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Import/ImportedRecording.h"
#include "Engine/Import/RecordingOptions.h"
#include "Engine/Progress.h"

namespace excursion {

/// Makes a take of recordings of a plan. Each file is laid beside the plan by itself (alignRecording) and read on the
/// plan's clock; all its channels are shifted and resampled alike. Where only what a loudspeaker has passed tells the
/// time, the delay that physics allows no loudspeaker (PhysicalDelay) is taken off. A loopback is the time of its file,
/// and its response, where it is not flat, is taken off the file's other channels; a microphone's curve off its
/// channel. A voltage that nothing recorded is the plan's, at `gain`, and marked as assumed.
///
/// Where a recording ends early the take ends with the last level of which all realizations are complete, or, when that
/// is none, with the last complete realization of the first. The levels of the take are those of the recorded voltage.
///
/// Throws Error: usage for maps that do not fit the files, input for files that cannot be used, data for what
/// alignRecording refuses, and for a channel that clips.
ImportedRecording importRecording(const RecordingOptions&, const Progress& = {});

}  // namespace excursion
