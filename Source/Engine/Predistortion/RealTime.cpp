// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Predistortion/RealTime.h"

#include "Engine/Error.h"
#include "Engine/Loudspeaker/SmallSignal.h"
#include "Engine/Validity.h"

#include <algorithm>

namespace excursion {

bool RealTimeOptions::isValid(std::string* reason) const
{
    if (!(sampleRate >= 8000.0 && sampleRate <= 768000.0))
        return refuse(reason, "the sample rate must lie between 8000 and 768000 Hz");
    if (oversampling != 1 && oversampling != 2 && oversampling != 4)
        return refuse(reason, "oversampling can be 1, 2 or 4");
    return coupling.isValid(reason);
}

bool PredistortionControls::isValid(std::string* reason) const
{
    if (!(amount >= 0.0 && amount <= 1.0))
        return refuse(reason, "the amount must lie between 0 and 1");
    if (!(displacementLimit > 0.0 && voltageLimit > 0.0 && powerLimit > 0.0))
        return refuse(reason, "a limit must be positive");
    if (!(margin >= 0.0 && margin <= 0.3))
        return refuse(reason, "the margin must lie between 0 and 0.3");
    if (!(coilResistance >= 0.0 && coilResistance < 1e6))
        return refuse(reason, "the resistance of a coil must lie between 0 and 1e6 ohm");
    return target.isValid(reason);
}

void requireRunnable(const Model& model, const RealTimeOptions& options)
{
    std::string reason;
    if (!options.isValid(&reason))
        throw Error(Error::Kind::usage, "The model cannot be run in real time: " + reason + ".");
    const auto refuse = [&model](const std::string& why) {
        throw Error(Error::Kind::data,
                    "The model" + (model.name.empty() ? "" : " '" + model.name + "'") + " cannot be run: " + why);
    };
    if (!(model.baseParameter("m").value > 0.0))
        refuse("its mass is not positive.");
    if (model.electrical()) {
        if (!(model.baseParameter("Bl").value > 0.0))
            refuse("its force factor Bl is not positive, so no voltage moves it.");
    }
    if (!isStable(model))
        refuse("it is not stable at rest, or its equations there are not finite: fit it again.");
}

double measuredDisplacement(const Model& model)
{
    double range = 0.0;
    for (const auto& component : model.components)
        if (const auto law = component.effect->law(); law && law->argument == "x")
            range = std::max(range, component.operatingRange.displacement);
    return range > 0.0 ? range : std::numeric_limits<double>::infinity();
}

}  // namespace excursion
