// SPDX-License-Identifier: GPL-3.0-or-later
#include "Bench/Loudspeaker.h"

#include <cmath>
#include <numbers>

namespace excursion::bench {
namespace {

double valueOf(const std::optional<Curve>& curve, double q) { return curve ? curve->value(q) : 1.0; }

}  // namespace

double VentedBox::pull(double w) const
{
    if (!flow)
        return stiffness * w;
    constexpr double gamma = 1.4;
    return -stiffness * flow->length / gamma * std::expm1(-gamma * std::log1p(w / flow->length));
}

double VentedBox::drag(double velocity) const
{
    const double laminar = resistance * velocity;
    if (!flow)
        return laminar;
    const double loss = velocity > 0.0 ? flow->outward : flow->inward;
    return laminar + std::copysign(loss * std::pow(std::abs(velocity), flow->power), velocity);
}

double Loudspeaker::forceFactorAt(double x) const { return Bl * valueOf(forceFactor, x); }

double Loudspeaker::stiffnessAt(double x) const { return K * valueOf(stiffness, x); }

double Loudspeaker::inductanceAt(double x, double i) const
{
    return Le * valueOf(inductancePosition, x) * valueOf(inductanceCurrent, i);
}

double Loudspeaker::inductanceSlopeAt(double x) const
{
    return inductancePosition ? Le * inductancePosition->slope(x) : 0.0;
}

double Loudspeaker::dampingAt(double v) const { return Rms * valueOf(dampingVelocity, v); }

std::complex<double> Loudspeaker::eddyImpedance(std::complex<double> s) const
{
    if (!eddyCurrents)
        return 0.0;
    if (eddyCurrents->cells.empty())
        return eddyCurrents->coefficient * std::pow(s, eddyCurrents->exponent);
    std::complex<double> sum = 0.0;
    for (const auto& cell : eddyCurrents->cells)
        sum += cell.resistance * s / (s + cell.rate);
    return sum;
}

std::complex<double> Loudspeaker::suspensionStiffness(std::complex<double> s) const
{
    if (!creep)
        return K;
    switch (creep->family) {
    case Creep::Family::logarithmic: return K / (1.0 + creep->amount * std::log((s + creep->high) / (s + creep->low)));
    case Creep::Family::standard: return K / (1.0 + creep->amount / (1.0 + s / creep->low));
    case Creep::Family::fractional: return K * (1.0 + creep->amount * std::pow(s / creep->low, creep->exponent));
    case Creep::Family::chain: {
        std::complex<double> give = 1.0;
        for (const auto& cell : creep->cells)
            give += cell.yield / (1.0 + s / cell.rate);
        return K / give;
    }
    }
    return K;
}

Loudspeaker::Response Loudspeaker::small(double frequency) const
{
    const std::complex<double> s {0.0, 2.0 * std::numbers::pi * frequency};
    std::complex<double> mechanical = s * m + Rms + suspensionStiffness(s) / s;  // N per m/s
    std::complex<double> port = 0.0;                                             // y/x
    if (friction)
        for (const auto& element : friction->elements)
            mechanical += element.stiffness / s;
    if (const auto& box = ventedBox) {
        // x = -q times what air, port and leak give way together; y/x is the port's share.
        const auto portStiffness = box->mass * s * s + box->resistance * s + box->spring;
        const auto give = 1.0 / (box->stiffness + box->absorption * s) + 1.0 / portStiffness + 1.0 / (box->leak * s);
        port = -1.0 / (give * portStiffness);
        mechanical += 1.0 / (give * s);
    }
    for (const auto& part : sideResonance) {
        const double w = 2.0 * std::numbers::pi * part.frequency;
        const auto follow = s * w / part.quality + w * w;  // y/x = follow/(s^2 + follow)
        mechanical += s * part.mass * follow / (s * s + follow);
    }
    const auto impedance = Re + s * Le + eddyImpedance(s) + Bl * Bl / mechanical;
    Response response;
    response.current = 1.0 / impedance;
    response.displacement = Bl * response.current / mechanical / s;
    response.radiated = s * s * response.displacement * (1.0 + port);
    return response;
}

std::vector<std::string> Loudspeaker::effects() const
{
    const bool present[] {forceFactor.has_value(),
                          stiffness.has_value(),
                          inductancePosition.has_value(),
                          inductanceCurrent.has_value(),
                          eddyCurrents.has_value(),
                          dampingVelocity.has_value(),
                          creep.has_value(),
                          friction.has_value(),
                          coilHeating.has_value(),
                          ventedBox.has_value(),
                          doppler,
                          !coneBreakup.empty(),
                          !sideResonance.empty(),
                          ventedBox && ventedBox->flow};
    std::vector<std::string> ids;
    for (std::size_t n = 0; n < effectIds().size(); ++n)
        if (present[n])
            ids.push_back(effectIds()[n]);
    return ids;
}

Loudspeaker Loudspeaker::linear() const
{
    Loudspeaker bare;
    bare.name = name;
    bare.Re = Re;
    bare.Le = Le;
    bare.Bl = Bl;
    bare.m = m;
    bare.Rms = Rms;
    bare.K = K;
    bare.coneArea = coneArea;
    bare.xmax = xmax;
    return bare;
}

const std::vector<std::string>& effectIds()
{
    static const std::vector<std::string> ids {"force-factor",
                                               "stiffness",
                                               "inductance-position",
                                               "inductance-current",
                                               "eddy-currents",
                                               "damping-velocity",
                                               "creep",
                                               "friction",
                                               "coil-heating",
                                               "vented-box",
                                               "doppler",
                                               "cone-breakup",
                                               "side-resonance",
                                               "port-and-air"};
    return ids;
}

}  // namespace excursion::bench
