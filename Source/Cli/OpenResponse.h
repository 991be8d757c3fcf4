// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Document/DocumentFormat.h"
#include "Engine/Estimate/Frf.h"
#include "Engine/Take/Measurement.h"

#include <optional>
#include <string>
#include <vector>

namespace excursion::cli {

/// Which frequency response of a file or take is meant.
struct ResponseChoice {
    std::string path;
    /// quantities; empty: the first beside the input; what the file is a response to, else the voltage or the force
    std::string output, input;
    int level = -1;  ///< of a take with levels; below 0: the loudest
};

/// Of the document of `bla`.
inline constexpr DocumentFormat blaFormat {"excursion-bla"};

struct OpenResponse {
    Frf frf;
    std::string output, input;                 ///< quantities
    double sampleRate = 0.0;                   ///< of the take; 0 for a frequency response
    std::optional<double> microphoneDistance;  ///< m, where the take tells it
    std::vector<std::string> remarks;          ///< what the file's reader had to assume
};

/// The frequency response output / input of a take (its best linear approximation, or Welch's estimate without
/// periods), of spectra (a file of responses, as a .zma or what other programs export), or of the document of `bla`
/// (.json). Throws Error (usage) for channels that are not there, (input, data) for files that cannot be read or used.
OpenResponse openResponse(const ResponseChoice&);

/// The lines from band[0] to band[1], in Hz; all of them where it is empty.
Frf within(const Frf&, const std::vector<double>& band);

}  // namespace excursion::cli
