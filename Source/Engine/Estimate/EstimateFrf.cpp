// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Estimate/EstimateFrf.h"

#include "Engine/Estimate/Bla.h"

namespace excursion {

Frf estimateFrf(const Measurement& take, Quantity output, Quantity input, int level, const WelchOptions& record)
{
    if (take.hasPeriods())
        return bla(take, output, take.excitation->levelOf(level), input).frf;
    return welch(take.channel(input).samples, take.channel(output).samples, take.sampleRate, record).frf;
}

}  // namespace excursion
