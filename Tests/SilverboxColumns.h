// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Import/ImportOptions.h"

namespace excursion::test {

/// How the files of the Silverbox are read: an electrical analogue, force and displacement in volts.
inline ImportOptions silverboxColumns()
{
    ImportOptions o;
    o.columns = {parseColumnQuantity("V1=force:V"), parseColumnQuantity("V2=displacement:V")};
    o.sampleRate = 1e7 / 16384;
    o.removeMean = true;
    return o;
}

}  // namespace excursion::test
