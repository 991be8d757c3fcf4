// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Linear/LinearHold.h"

#include "Engine/Error.h"
#include "Engine/Numerics/Exponential.h"

namespace excursion {

LinearHold linearHold(const StateSpace& model, double sampleRate)
{
    std::string reason;
    if (!model.isValid(&reason))
        throw Error(Error::Kind::usage, "The model cannot be sampled: " + reason + ".");
    if (!model.continuous() || !(sampleRate > 0.0))
        throw Error(Error::Kind::usage, "A model of continuous time is sampled, at a rate above 0 Hz.");
    const auto m = model.inputs();
    const auto [decay, phi] = exponential(model.A, model.B, 1.0 / sampleRate, 2);
    if (!decay.allFinite() || !phi.allFinite())
        throw Error(Error::Kind::numerical, "The model grows beyond all numbers within one sample.");
    LinearHold hold;
    hold.late = phi.rightCols(m);
    hold.model.sampleRate = sampleRate;
    hold.model.A = decay;
    hold.model.B = phi.leftCols(m) - hold.late + hold.model.A * hold.late;
    hold.model.C = model.C;
    hold.model.D = model.D + model.C * hold.late;
    return hold;
}

}  // namespace excursion
