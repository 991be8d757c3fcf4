// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

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
        bench::BenchSetup setup;
        setup.excitation.period = 4096;
        setup.excitation.periods = 2;
        setup.excitation.realizations = 2;
        setup.excitation.levels = {2.0};
        setup.excitation.bandLow = 20.0;
        setup.excitation.bandHigh = 6000.0;
        setup.noiseDb = -70.0;
        bench::Loudspeaker truth;
        bench::Creep creep;
        creep.family = bench::Creep::Family::chain;
        creep.cells = {{0.014, 10.0}, {0.034, 23.0}, {0.037, 119.0}, {0.022, 666.0}, {0.010, 3320.0}};
        truth.creep = creep;
        record = makeRecord(bench::measure(truth, setup));
        base = startModel(record);
        adapt(record, base);
        fit(base, record, estimationSections(record));
    }
};

}  // namespace excursion
