// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Diagnosis/BasedTake.h"
#include "SmallSetup.h"

namespace excursion {

/// The record of a suspension that creeps, as a chain of relaxations does, and its linear model.
struct CreepingTake : BasedTake {
    CreepingTake() : BasedTake(creeping(), smallSetup()) {}

private:
    static bench::Loudspeaker creeping()
    {
        bench::Loudspeaker truth;
        bench::Creep creep;
        creep.family = bench::Creep::Family::chain;
        creep.cells = {{0.014, 10.0}, {0.034, 23.0}, {0.037, 119.0}, {0.022, 666.0}, {0.010, 3320.0}};
        truth.creep = creep;
        return truth;
    }
};

}  // namespace excursion
