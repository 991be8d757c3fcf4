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
    /// begins again (Improvement::coupling()); may be empty
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

    /// Of the recorder's inputs (FindCoupling.h), Hz; 0 while none was found. Where one is found in what a model
    /// leaves, the take is corrected by it, a problem tells it, and the ladder begins again. That happens once at most,
    /// and not to a take that states its coupling.
    double coupling() const { return coupling_; }

    /// Makes the first rung: the base, with the effects in ImproveOptions::with. Not for a take that is unfit for use.
    /// Looks for a coupling if the best candidate comes near the noise.
    void begin(const Progress& = {});

    /// Looks for a coupling in what the last rung leaves, or its best candidate near the noise.
    /// @returns whether the ladder began again
    bool beginUncoupled(const Progress& = {});

    /// Adds all effects at once that together explain the take, if the last rung's diagnosis indicates several effects,
    /// or none to begin with. It makes the rungs from there to all of them, the largest fall of the error first. Where
    /// a coupling is found on the way it does so from a new beginning. Returns false and does nothing if the diagnosis
    /// indicates one effect, if nothing is found, or if the take has no periods.
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

    /// The last rung and those that follow from it together, or the coupling that is to be taken off first.
    struct Together {
        std::vector<Rung> rungs;  ///< the last of them is not diagnosed yet; none where nothing is to be added
        double coupling = 0.0;    ///< Hz
    };

    void beginBehind(double coupling, const Progress&);
    bool mayBeCoupled() const;
    Together together(const Spectra&, const Progress&) const;
    Together together(Record&, const Progress&) const;
    Rung judged(Rung, Data&, const Progress&) const;
    /// Goes on with other data; the first `kept` rungs stay, judged by them.
    void use(Data, std::size_t kept, const Progress& silent);
    void keep(Rung);
    void concludeFromLast();  ///< verdict and sentence from the last rung's diagnosis

    PreparedTake take_;
    ImproveOptions options_;
    Data data_;  ///< what the rungs are compared with
    double coupling_ = 0.0;
    Ladder ladder_;
};

}  // namespace excursion
