// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Check/PreparedTake.h"
#include "Engine/Diagnosis/Ladder.h"

#include <functional>
#include <string>
#include <variant>
#include <vector>

namespace excursion {

struct ImproveOptions {
    DiagnoseOptions diagnose;
    std::vector<std::string> with;  ///< effects that the first model has already
    /// called by improve() with each rung once its diagnosis is known; may be empty
    std::function<void(const Rung&)> finished;
};

/// A take and the ladder that grows on it a rung at a time: what `improve` climbs by itself, and a person by hand. Long
/// work reports and may be cancelled; the ladder then is what it was before.
class Improvement {
public:
    /// Cuts the take into what a model is compared with. Throws Error (data) when it has no channel to compare.
    explicit Improvement(PreparedTake, const ImproveOptions& = {}, const Progress& = {});

    const PreparedTake& take() const { return take_; }
    const Ladder& ladder() const { return ladder_; }

    /// The first rung: the base, with the effects asked for in ImproveOptions::with. Not for a take that is unfit for
    /// use.
    void begin(const Progress& = {});

    /// Puts in at once what the catalogue explains together, where the last rung's diagnosis speaks for several
    /// effects, or knows none to begin with: the rungs from there to all of them, the largest fall of the error first.
    /// False, and nothing done, where it speaks for one, where nothing is found, and of a take without periods.
    bool addTogether(const Progress& = {});

    /// Another rung: the effect is put into the last model, everything is refitted. Throws Error (data) when the model
    /// has the effect already or can't have it.
    void add(const std::string& effect, const Progress& = {});

    /// Takes the last rung back, unless it is the first.
    void undo();

    /// A validation section of a level under the last model, in time: a period, or a window of an aperiodic take. Empty
    /// for a frequency response.
    std::vector<Waveform> waveforms(int level) const;

private:
    std::vector<Rung> rungsTogether(const Spectra&, const Progress&) const;
    std::vector<Rung> rungsTogether(const Record&, const Progress&) const;
    Rung judged(Rung, const Progress&) const;
    void keep(Rung);
    void concludeFromLast();  ///< verdict and sentence, as the last rung's diagnosis says

    PreparedTake take_;
    ImproveOptions options_;
    std::variant<Record, Spectra> data_;
    Ladder ladder_;
};

}  // namespace excursion
