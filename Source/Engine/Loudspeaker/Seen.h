// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Effect.h"
#include "Engine/Loudspeaker/Record.h"

#include <string>
#include <vector>

namespace excursion {

/// What a take shows of a loudspeaker, as far as it decides which effects can be seen there.
struct Seen {
    bool coil = true;                ///< a voltage drives it
    bool records = true;             ///< in time; else a frequency response
    std::vector<Quantity> channels;  ///< all that were measured
};

Seen seenIn(const Record&);
Seen seenIn(const Measurement&);
Seen seenIn(const Spectra&);

/// Why that effect cannot be seen there, as a sentence that says what to do about it; empty when it can.
std::string whyUnseen(const Effect&, const Seen&);

}  // namespace excursion
