// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Bench/Loudspeaker.h"
#include "Engine/Loudspeaker/Model.h"

#include <utility>

namespace excursion {

/// Gives the bench's loudspeaker the base of a model.
inline void takeBase(bench::Loudspeaker& speaker, const Model& model)
{
    for (auto [to, name] : {std::pair {&speaker.Re, "Re"},
                            {&speaker.Le, "Le"},
                            {&speaker.Bl, "Bl"},
                            {&speaker.m, "m"},
                            {&speaker.Rms, "Rms"},
                            {&speaker.K, "K"}})
        *to = model.baseParameter(name).value;
}

}  // namespace excursion
