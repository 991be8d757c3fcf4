// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Fractional/FractionalReduction.h"

#include "Engine/Error.h"

#include <cmath>
#include <numbers>

namespace excursion {

FractionalReduction reduceByPolesAndZeros(const FractionalStateSpace& model, PoleZeroReductionOptions options)
{
    std::string reason;
    if (!model.isValid(&reason))
        throw Error(Error::Kind::usage, "The model cannot be reduced: " + reason + ".");
    options.alpha = model.alpha;
    auto reduced = reduceByPolesAndZeros(model.form, options);
    return {{model.alpha, std::move(reduced.model)}, std::move(reduced.steps), std::move(reduced.reason)};
}

FractionalPruning prune(const FractionalStateSpace& model, const FrequencyData& data, const PruningOptions& options,
                        const Progress& progress)
{
    std::string reason;
    if (!model.isValid(&reason))
        throw Error(Error::Kind::usage, "The model cannot be pruned: " + reason + ".");
    if (!data.isValid(&reason))
        throw Error(Error::Kind::data, "The model cannot be pruned: " + reason + ".");
    if (data.inputs != model.form.inputs() || data.outputs != model.form.outputs())
        throw Error(Error::Kind::data, "The frequency response is not one of the input and outputs of the model.");
    if (!isStable(model))
        throw Error(Error::Kind::data, "Only stable models are pruned; stabilize it first.");
    const double scale = std::pow(2.0 * std::numbers::pi * data.frequency.back(), model.alpha);
    auto pruned = prune(fitPartialFractions(sectionsOf(poles(model.form), 0.0, scale, model.alpha), data), data,
                        options, progress);
    return {{model.alpha, realize(pruned.fit.sections, pruned.fit.C, pruned.fit.D)},
            std::move(pruned.steps),
            std::move(pruned.reason)};
}

}  // namespace excursion
