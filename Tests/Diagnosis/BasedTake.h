// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Bench/Bench.h"
#include "Engine/Estimate/MakeRecord.h"
#include "Engine/Loudspeaker/Fit.h"
#include "Engine/Loudspeaker/OutputError.h"

namespace excursion {

/// The record of a loudspeaker of the bench, and its linear model.
struct BasedTake {
    Record record;
    Model base;
    FitSummary run;

    BasedTake(const bench::Loudspeaker& truth, const bench::BenchSetup& setup)
        : record(makeRecord(bench::measure(truth, setup))), base(startModel(record))
    {
        adapt(record, base);
        run = fit(base, record, estimationSections(record));
    }
};

}  // namespace excursion
