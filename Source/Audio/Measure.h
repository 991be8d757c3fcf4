// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Audio/Procedure.h"
#include "Audio/Stream.h"

#include <functional>
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

/// Plays and records through a device, and once more, without the rise, where samples were lost on the way. The device
/// is closed when it returns, or throws
///     Error (cancelled) when it was told to stop, after the fade;
///     Error (data) when a limit was reached, an input clipped or nothing was heard;
///     Error (input) when the device does not open, is gone, all inputs froze, or samples are lost at every attempt.
Measured measure(System&, const Device&, const MeasureOptions&);

/// What ended a procedure before its end, in a sentence; for all kinds but `complete` and `stopped`.
std::string sentenceOf(const Ending&, const ProcedureOptions&);

/// The loudest of the periods that an excitation plays, for the rise: where its largest peak is.
/// @return the first sample of that period
std::size_t loudestPeriod(const Excitation&, const std::vector<double>& samples);

}  // namespace excursion::audio
