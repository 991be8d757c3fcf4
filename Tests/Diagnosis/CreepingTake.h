// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "SmallSetup.h"

#include "Bench/Bench.h"
#include "Engine/Estimate/MakeRecord.h"
#include "Engine/Loudspeaker/Fit.h"
#include "Engine/Loudspeaker/OutputError.h"

namespace excursion {

/// The record of a suspension that creeps, as a chain of relaxations does, and its linear model.
struct CreepingTake {
    Record record;
    Model base;

    CreepingTake()
    {
        bench::Loudspeaker truth;
        bench::Creep creep;
        creep.family = bench::Creep::Family::chain;
        creep.cells = {{0.014, 10.0}, {0.034, 23.0}, {0.037, 119.0}, {0.022, 666.0}, {0.010, 3320.0}};
        truth.creep = creep;
        record = makeRecord(bench::measure(truth, smallSetup()));
        base = startModel(record);
        adapt(record, base);
        fit(base, record, estimationSections(record));
    }
};

}  // namespace excursion
