// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Audio/Procedure.h"
#include "Audio/Stream.h"
#include "Engine/Take/SweepExcitation.h"

#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

namespace excursion::audio {

/// How far a measurement is, a few times a second.
struct Status {
    Stage stage = Stage::listening;
    double fraction = 0.0;  ///< of this attempt
    double seconds = 0.0;   ///< since its begin
    int attempt = 1;
    std::vector<Procedure::Meter> meters;  ///< one a watched input
};

struct MeasureOptions {
    ProcedureOptions procedure;
    StreamOptions stream;   ///< rate, inputs and outputs are those of the procedure
    int attempts = 3;       ///< that many at most, where samples are lost
    double patience = 5.0;  ///< s without a block after which a device is gone
    std::function<void(const Status&)> report;
    std::stop_token stop;
};

struct Measured {
    std::vector<std::vector<float>> channels;  ///< one an input, from before what was played until after it
    int attempts = 1;
    std::vector<std::string> remarks;  ///< sentences for a person
};

/// Plays and records through a device, and again where samples were lost, with a rise only if none was completed. The
/// device is closed when it returns, or throws
///     Error (cancelled) when it was told to stop, after the fade, for which a device has half a second and its
///     latency;
///     Error (data) when a limit was reached or cannot be seen, an input clipped or nothing was heard;
///     Error (input) when the device does not open, is gone, gives no inputs, all inputs froze, or samples are lost at
///     every attempt.
Measured measure(System&, const Device&, const MeasureOptions&);

/// What ended a procedure before its end, in a sentence; for all kinds but `complete` and `stopped`.
std::string sentenceOf(const Ending&, const ProcedureOptions&);

/// What a plan plays and rises by: the period with the largest peak, or a quick sweep at the highest level, ten times
/// at least, as a long one would come to its low notes once. Inputs and outputs are still to be told. Throws Error
/// (data) where nothing would sound, or more than the output can give.
/// @param plan       of planExcitation() or, with `sweep`, of planSweep()
/// @param fullScale  V at an output sample of 1.0
ProcedureOptions procedureFor(const Measurement& plan, const std::optional<SweepExcitation>& sweep, double fullScale);

}  // namespace excursion::audio
