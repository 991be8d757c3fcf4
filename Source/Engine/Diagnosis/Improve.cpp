// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/Improve.h"

#include "Engine/Diagnosis/Withdraw.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/FitResponse.h"

#include <utility>

namespace excursion {

Ladder improve(const PreparedTake& take, const ImproveOptions& options, const Progress& progress)
{
    Improvement work(take, options, progress.part(0.0, 0.02));
    if (work.ladder().verdict == Verdict::badMeasurement)
        return work.ladder();
    std::size_t told = 0;
    double behind = 0.0;  // the coupling of the rungs that were told
    const auto tell = [&] {
        if (std::exchange(behind, work.coupling()) != work.coupling())
            told = 0;
        for (; told < work.ladder().rungs.size(); ++told)
            if (options.finished)
                options.finished(work.ladder().rungs[told]);
    };
    constexpr double begun = 0.15, done = 0.99;
    work.begin(progress.part(0.02, begun));
    const bool inTime = take.inTime() != nullptr;
    const auto verdict = [&] { return work.ladder().verdict; };
    const auto climb = [&] {
        // What no effect explains by itself several may explain together: those of a frequency response at once, and
        // where the last one came in by itself.
        bool mayBeTogether = !inTime || verdict() == Verdict::unknownEffect;
        const double searched = mayBeTogether ? 0.7 : begun;
        if (std::exchange(mayBeTogether, false) && work.addTogether(progress.part(begun, searched)))
            tell();
        // of a rung: none has an effect twice
        const double share = (done - searched) / static_cast<double>(catalogue().size());
        while (verdict() == Verdict::missingEffect || (mayBeTogether && verdict() == Verdict::unknownEffect)) {
            const double at = searched + share * static_cast<double>(work.ladder().rungs.size() - 1);
            const auto part = progress.part(at, at + share);
            mayBeTogether = false;
            if ((!inTime || !work.addTogether(part.part(0.0, 0.7))) && verdict() == Verdict::missingEffect) {
                tell();  // its diagnosis stands
                work.add(work.ladder().rungs.back().diagnosis.ranking.front().effect, part.part(0.7, 1.0));
                mayBeTogether = inTime;
            }
        }
        tell();
    };
    climb();
    if (verdict() == Verdict::unknownEffect) {
        const auto before = work;
        const auto leaves = [](const Improvement& one) {
            return one.ladder().rungs.back().comparison.chiSquaredPerValue;
        };
        if (work.beginUncoupled(progress.part(done, done))) {
            climb();
            if (!(leaves(work) < leaves(before))) {
                work = before;
                tell();
            }
        }
    }
    auto ladder = work.ladder();
    withdrawDoubtful(ladder);
    if (inTime)  // the diagnosis of a frequency response has told them
        ladder.sentence += caveatsOf(ladder.model());
    progress.at(1.0, "done");
    return ladder;
}

}  // namespace excursion
