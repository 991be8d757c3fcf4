// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Bench/Bench.h"

namespace excursion {

/// Two realizations at one level, of two short periods: enough to fit the bench's default driver.
inline bench::BenchSetup smallSetup()
{
    bench::BenchSetup setup;
    setup.excitation.period = 4096;
    setup.excitation.periods = 2;
    setup.excitation.realizations = 2;
    setup.excitation.levels = {2.0};
    setup.excitation.bandLow = 20.0;
    setup.excitation.bandHigh = 6000.0;
    setup.noiseDb = -70.0;
    return setup;
}

}  // namespace excursion
