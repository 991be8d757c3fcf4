// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/FitEffects.h"

#include "Engine/Diagnosis/Compare.h"
#include "Engine/Diagnosis/Refine.h"
#include "Engine/Diagnosis/Trial.h"
#include "Engine/Error.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/FitResponse.h"
#include "Engine/Loudspeaker/OutputError.h"
#include "Engine/Loudspeaker/Seen.h"

#include <algorithm>

namespace excursion {
namespace {

/// Refuses unknown names and repeated ones before any work.
void requireOnce(const std::vector<std::string>& effects)
{
    for (const auto& id : effects)
        if (effectNamed(id); std::count(effects.begin(), effects.end(), id) > 1)
            throw Error(Error::Kind::usage, "The effect \"" + id + "\" is named twice.");
}

}  // namespace

Model fitEffects(Record& record, const std::vector<std::string>& effects, const FitOptions& options,
                 FitSummary* summary, const Progress& progress)
{
    requireOnce(effects);
    for (const auto& id : effects)
        if (const auto why = whyUnseen(effectNamed(id), seenIn(record)); !why.empty())
            throw Error(Error::Kind::usage, why);
    progress.at(0.0, "finding start values");
    Model model = startModel(record);
    adapt(record, model);
    const double step = 0.8 / (static_cast<double>(effects.size()) + 1.0);
    FitOptions quick = options;
    quick.search = {12, 1e-3};
    quick.fed = true;
    auto last = fit(model, record, effects.empty() ? estimationSections(record) : trialSections(record, 2),
                    effects.empty() ? options : quick, progress.part(0.0, step));
    double done = step;
    for (const auto& id : effects) {
        if (const auto why = whyHostMissing(effectNamed(id), model); !why.empty())
            throw Error(Error::Kind::usage, why);
        tryEffect(model, record, effectNamed(id), options, progress.part(done, done + step));
        done += step;
    }
    if (!effects.empty() || followsDrift(model, record))
        last = refineByNoise(model, record, options, progress.part(0.8, 1.0));
    if (!last.usable())
        throw Error(Error::Kind::numerical, "The fit failed: " + last.message + ".");
    if (summary)
        *summary = last;
    return model;
}

Model fitEffects(const Spectra& spectra, const std::vector<std::string>& effects, FitSummary* summary)
{
    requireOnce(effects);
    const auto targets = responsesOf(spectra);
    Model model = startModel(targets, spectra.find(Quantity::voltage) != nullptr, spectra.driver);
    for (const auto& id : effects) {
        const auto& effect = effectNamed(id);
        if (const auto why = whyUnseen(effect, seenIn(spectra)); !why.empty())
            throw Error(Error::Kind::usage, why);
        if (!addByResponse(model, effect, targets).usable())
            throw Error(Error::Kind::numerical,
                        "The effect \"" + id + "\" could not be fitted to the frequency response.");
    }
    const auto run = refineByResponse(model, targets);
    if (summary)
        static_cast<SearchSummary&>(*summary) = run;
    return model;
}

}  // namespace excursion
