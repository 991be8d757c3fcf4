// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Diagnosis/Ladder.h"

namespace excursion {

/// When a ladder ends with something unknown and the noise is known, effects that removed little more than that may
/// have explained a symptom of it. They are taken back, from the last one on, until one is convincing: it stood alone
/// when it was proposed and the held-out sections show anything of it, or it removed three times what is left in the
/// end, of the error of a channel or of the power on its odd or even lines that were not played.
void withdrawDoubtful(Ladder&);

}  // namespace excursion
