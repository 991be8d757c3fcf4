// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"
#include "Engine/Estimate/Record.h"

#include <string>
#include <vector>

namespace excursion {

/// The properties of a take that decide which effects can be seen in it.
struct Seen {
    bool coil = true;                ///< a voltage drives it
    bool records = true;             ///< time records; else a frequency response
    std::vector<Quantity> channels;  ///< all that were measured
};

Seen seenIn(const Record&);
Seen seenIn(const Measurement&);
Seen seenIn(const Spectra&);
Seen seenIn(const Take&);

/// Why this effect cannot be seen in the take, as a sentence that says what to do about it; empty if it can.
std::string whyUnseen(const Effect&, const Seen&);

/// Why this effect cannot come into the model, as a sentence that says what to do about it; empty if it can.
std::string whyHostMissing(const Effect&, const Model&);

/// Throws Error (data) when one of model and take has a coil and the other has none.
void requireSameKind(const Model&, const Seen&);

}  // namespace excursion
