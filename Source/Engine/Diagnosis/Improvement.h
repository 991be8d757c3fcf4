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
    std::vector<std::string> with;  ///< effects that the first model already has
    /// improve() calls it with each rung once its diagnosis is known, and again from the first one on where the ladder
    /// begins again (Improvement::beginUncoupled()); may be empty
    std::function<void(const Rung&)> finished;
};

/// A take and its ladder, which grows one rung at a time. `improve` climbs it automatically, the user by hand. Long
/// work reports its progress and may be cancelled; the ladder is then unchanged.
class Improvement {
public:
    /// Cuts the take into sections for comparison with a model. Throws Error (data) if it has no channel to compare.
    explicit Improvement(PreparedTake, const ImproveOptions& = {}, const Progress& = {});

    const PreparedTake& take() const { return take_; }
    const Ladder& ladder() const { return ladder_; }

    /// Makes the first rung: the base, with the effects in ImproveOptions::with. Not for a take that is unfit for use.
    void begin(const Progress& = {});

    /// Looks for a coupling of the recorder's inputs (FindCoupling.h) in what the last rung leaves, or its best
    /// candidate near the noise. Where there is one the take is corrected by it, a problem tells it, and the ladder
    /// begins again.
    /// @returns whether it does; never a second time, and not for a take that states its coupling
    bool beginUncoupled(const Progress& = {});

    /// Adds all effects at once that together explain the take, if the last rung's diagnosis indicates several effects,
    /// or none to begin with. It makes the rungs from there to all of them, the largest fall of the error first.
    /// Returns false and does nothing if the diagnosis indicates one effect, if nothing is found, or if the take has no
    /// periods.
    bool addTogether(const Progress& = {});

    /// Makes another rung: the effect is added to the last model, and everything is refitted. Throws Error (data) if
    /// the model already has the effect or cannot have it.
    void add(const std::string& effect, const Progress& = {});

    /// Removes the last rung, unless it is the first.
    void undo();

    /// A validation section of a level with the last model, over time: a period, or a window of an aperiodic take.
    /// Empty for a frequency response.
    std::vector<Waveform> waveforms(int level) const;

private:
    using Data = std::variant<Record, Spectra>;

    void beginBehind(double coupling, const Progress&);
    std::vector<Rung> rungsTogether(const Spectra&, const Progress&) const;
    std::vector<Rung> rungsTogether(Record&, const Progress&) const;
    Rung judged(Rung, const Data&, const Progress&) const;
    void use(Data);
    void keep(Rung);
    void concludeFromLast();  ///< verdict and sentence from the last rung's diagnosis

    PreparedTake take_;
    ImproveOptions options_;
    Data data_;              ///< what the rungs are compared with
    double coupling_ = 0.0;  ///< Hz, found
    Ladder ladder_;
};

}  // namespace excursion
