// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Bench/Loudspeaker.h"
#include "Engine/Loudspeaker/Model.h"

#include <utility>

namespace excursion::test {

/// The base with the linear parameters of a loudspeaker of the bench.
inline Model baseOf(const bench::Loudspeaker& speaker)
{
    auto model = makeModel("electrodynamic");
    for (const auto& [name, value] : {std::pair {"Re", speaker.Re},
                                      {"Le", speaker.Le},
                                      {"Bl", speaker.Bl},
                                      {"m", speaker.m},
                                      {"Rms", speaker.Rms},
                                      {"K", speaker.K}})
        model.baseParameter(name).value = value;
    return model;
}

}  // namespace excursion::test
