// SPDX-License-Identifier: GPL-3.0-or-later
// The physical driver among the other classes.
#include "Engine/Ranking/ModelClasses.h"

#include "Engine/Diagnosis/FitEffects.h"
#include "Engine/Diagnosis/Improve.h"
#include "Engine/Error.h"
#include "Engine/Loudspeaker/ModelFile.h"
#include "Engine/Loudspeaker/Simulate.h"
#include "Engine/Loudspeaker/SmallSignal.h"

namespace excursion {
namespace {

FittedClass driverClass(const Model& model, const RankedTake& data)
{
    std::string description;
    int parameters = 0;
    for (const auto* parameter : parametersOf(model))
        parameters += parameter->free ? 1 : 0;
    for (const auto& component : model.components)
        if (&component != &model.components.front())
            description += (description.empty() ? "" : ", ") + component.effect->title();
    const auto play = [model, rate = data.take.measurement().sampleRate,
                       output = data.output.quantity](const InputOutputRecord& record) -> Eigen::MatrixXd {
        const Eigen::VectorXd u = record.input.col(0);
        const auto played = simulate(model, std::span<const double>(u.data(), static_cast<std::size_t>(u.size())), rate,
                                     {});
        const auto* channel = played.find(output);
        if (!channel)
            throw Error(Error::Kind::data, "The physical driver does not know this channel.");
        return Eigen::Map<const Eigen::VectorXd>(channel->samples.data(), u.size());
    };
    return {play, description.empty() ? "base alone" : description, parameters, isStable(model), toJson(model)};
}

}  // namespace

FittedClass fitDriverClass(const RankedTake& data, const Progress& progress)
{
    auto record = data.take.record();
    return driverClass(fitEffects(record, {}, {}, nullptr, progress), data);
}

FittedClass fitDriverWithEffectsClass(const RankedTake& data, const Progress& progress)
{
    const auto ladder = improve(data.take, {}, progress);
    if (ladder.rungs.empty())
        throw Error(Error::Kind::data, ladder.sentence);
    return driverClass(ladder.model(), data);
}

}  // namespace excursion
