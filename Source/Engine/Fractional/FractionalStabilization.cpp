// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Fractional/FractionalStabilization.h"

#include "Engine/Error.h"
#include "Engine/Linear/Response.h"

namespace excursion {

FractionalStabilization stabilized(const FractionalStateSpace& model, const FrequencyData& data,
                                   StabilizeOptions options, const Progress& progress)
{
    std::string reason;
    if (!model.isValid(&reason))
        throw Error(Error::Kind::usage, "The model cannot be stabilized: " + reason + ".");
    if (options.method == StabilizingMethod::delay)
        throw Error(Error::Kind::usage,
                    "No delay is fitted with a model of fractional order; mirror, project or decompose it.");
    options.alpha = model.alpha;
    auto found = stabilized(model.form, data, options, progress);
    FractionalStabilization result;
    result.model = {model.alpha, std::move(found.model)};
    result.sectorMargin = sectorMargin(result.model);
    if (found.parts) {
        result.unstable = FractionalStateSpace {model.alpha, std::move(found.parts->unstable)};
        result.coupling = found.parts->coupling;
    }
    result.steps = std::move(found.steps);
    result.reason = std::move(found.reason);
    return result;
}

FrequencyData sampled(const FractionalStateSpace& model, int lines) { return sampled(model.form, lines, model.alpha); }

}  // namespace excursion
