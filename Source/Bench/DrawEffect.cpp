// SPDX-License-Identifier: GPL-3.0-or-later
#include "Bench/Draw.h"

#include "Bench/Random.h"
#include "Bench/Relaxation.h"
#include "Engine/Document/Words.h"
#include "Engine/Error.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <optional>
#include <string_view>

namespace excursion::bench {
namespace {

using Shape = Curve::Shape;
constexpr double turn = 2.0 * std::numbers::pi;

Shape oneOf(Random& random, std::initializer_list<Shape> shapes)
{
    return shapes.begin()[random.index(static_cast<int>(shapes.size()))];
}

double either(Random& random) { return random.chance(0.5) ? 1.0 : -1.0; }

// The amount of a step or drag is kept where the parameter stays positive everywhere.
Curve bounded(Curve curve, double low, double high)
{
    curve.amount = std::clamp(curve.amount, low, high);
    return curve;
}

Curve drawForceFactor(double strength, double range, Random& random)
{
    const auto shape = oneOf(random, {Shape::erfGap, Shape::logisticGap, Shape::quarticGap, Shape::gaussianGap});
    const double edge = shape == Shape::logisticGap ? random.uniform(2.0, 5.0) : random.uniform(0.7, 1.8);
    return Curve {shape, random.uniform(-0.3, 0.3) * range, range, 0.0, edge}.scaledTo(strength, range);
}

Curve drawStiffness(double strength, double range, Random& random)
{
    const auto shape = oneOf(random, {Shape::coshSpring, Shape::expSpring, Shape::rationalSpring, Shape::skewedSpring});
    const double extra = shape == Shape::rationalSpring ? random.uniform(0.1, 0.4) : random.uniform(0.3, 0.9);
    return Curve {shape, random.uniform(-0.3, 0.3) * range, range, 0.0, extra}.scaledTo(strength, range);
}

Curve drawInductancePosition(double strength, double range, Random& random)
{
    const auto shape = oneOf(random, {Shape::tanhStep, Shape::arctanStep, Shape::rootStep});
    const double centre = random.uniform(-0.3, 0.3) * range, width = random.uniform(0.3, 0.8) * range;
    return bounded(Curve {shape, centre, width, 0.5, 0.0}.scaledTo(strength, range), 0.0, 0.85);
}

Curve drawInductanceCurrent(double strength, double range, Random& random)
{
    if (random.chance(0.5))  // off centre by so little that the flux grows with the current everywhere
        return Curve {Shape::saturation, random.uniform(-0.08, 0.08) * range, range, 0.0, 0.0}.scaledTo(strength,
                                                                                                        range);
    const double width = random.uniform(0.5, 1.5) * range, sign = either(random);
    return bounded(Curve {Shape::tanhStep, 0.0, width, sign * 0.5, 0.0}.scaledTo(strength, range), -0.6, 0.6);
}

Curve drawDamping(double strength, double range, Random& random)
{
    const auto shape = oneOf(random, {Shape::rootDrag, Shape::powerDrag, Shape::tanhDrag});
    const double sign = shape == Shape::rootDrag ? 1.0 : either(random);
    const double centre = random.uniform(-0.2, 0.2) * range, width = random.uniform(0.3, 1.0) * range;
    return bounded(Curve {shape, centre, width, sign, random.uniform(1.5, 2.5)}.scaledTo(strength, range), -0.8, 20.0);
}

Creep drawCreep(double strength, double f0, double lowEdge, Random& random)
{
    Creep creep;
    const std::complex<double> s {0.0, turn * lowEdge};
    switch (random.index(3)) {
    case 0:
        creep.family = Creep::Family::logarithmic;
        creep.low = turn * lowEdge * random.logUniform(0.03, 0.3);
        creep.high = turn * f0 * random.logUniform(1.0, 20.0);
        creep.amount = strength / std::abs(std::log((s + creep.high) / (s + creep.low)));
        break;
    case 1:
        creep.family = Creep::Family::standard;
        creep.low = turn * lowEdge * random.logUniform(0.5, 2.0);
        creep.amount = strength * std::abs(1.0 + s / creep.low);
        break;
    default:
        creep.family = Creep::Family::fractional;
        creep.low = turn * f0;
        creep.exponent = random.uniform(0.1, 0.4);
        creep.amount = strength;
    }
    return creep;
}

/// The ends of a chain of loops, rad/s: well below the band and above it.
double slowestLoop(double lowEdge) { return turn * lowEdge / 30.0; }
double fastestLoop(double highEdge) { return turn * highEdge * 10.0; }

/// A chain as irons have it: one to three cells a decade at random places from well below the band to above it, each up
/// to several times off the power law that they follow on the whole.
EddyCurrents drawEddyChain(double exponent, double lowEdge, double highEdge, Random& random)
{
    EddyCurrents eddy;
    const double low = slowestLoop(lowEdge), high = fastestLoop(highEdge);
    const int count = static_cast<int>(std::ceil(std::log10(high / low) * random.uniform(1.0, 3.0)));
    const double scatter = random.uniform(0.2, 0.7);
    for (int n = 0; n < count; ++n) {
        const double rate = low * std::pow(high / low, (n + random.uniform()) / count);
        eddy.cells.push_back({std::pow(rate, exponent) * std::exp(scatter * random.normal()), rate});
    }
    return eddy;
}

/// Three to seven Kelvin-Voigt cells of random yields, from well below the band to above the resonance.
Creep drawCreepChain(double strength, double f0, double lowEdge, Random& random)
{
    Creep creep;
    creep.family = Creep::Family::chain;
    const double low = turn * lowEdge * 0.05, high = turn * f0 * 10.0;
    const int count = 3 + random.index(5);
    const std::complex<double> s {0.0, turn * lowEdge};
    std::complex<double> give = 0.0;
    for (int n = 0; n < count; ++n) {
        const double rate = low * std::pow(high / low, (n + random.uniform()) / count);
        creep.cells.push_back({std::exp(0.5 * random.normal()), rate});
        give += creep.cells.back().yield / (1.0 + s / rate);
    }
    for (auto& cell : creep.cells)
        cell.yield *= strength / std::abs(give);
    return creep;
}

Friction drawFriction(double strength, double springForce, double range, Random& random)
{
    // Up to a quarter of the spring's peak force, reached within 3 to 20 % of the way
    const double total = 0.4 * strength * springForce;
    const double reach = range * random.logUniform(0.03, 0.2);
    const int count = random.chance(0.5) ? 1 : 4;
    Friction friction;
    for (int n = 0; n < count; ++n) {
        const double spread = std::exp2(n - 0.5 * (count - 1));
        friction.elements.push_back({total / count / (reach * spread), total / count});
    }
    return friction;
}

CoilHeating drawHeating(double strength, double power, Random& random)
{
    CoilHeating heating;
    heating.coilResistance = strength / (heating.alpha * power);
    heating.coilCapacity = random.logUniform(0.5, 4.0) / heating.coilResistance;  // seconds
    heating.magnetResistance = 0.3 * heating.coilResistance;
    heating.magnetCapacity = 100.0 * heating.coilCapacity;
    return heating;
}

VentedBox drawBox(double strength, const Loudspeaker& speaker, double f0, Random& random)
{
    VentedBox box;
    box.stiffness = 4.0 * strength * speaker.K;
    const double tuning = turn * f0 * random.uniform(0.7, 1.3);
    box.mass = box.stiffness / (tuning * tuning);
    box.resistance = box.mass * tuning / random.uniform(5.0, 15.0);
    const double impedance = box.mass * tuning;  // of air and port at the tuning
    if (random.chance(0.7))
        box.leak = impedance * random.logUniform(5.0, 30.0);
    if (random.chance(0.5))
        box.absorption = impedance / random.logUniform(20.0, 100.0);
    return box;
}

/// Up to as much loss at the cone's highest speed as the tuning's impedance would give times the strength, and air that
/// stiffens by up to that.
BoxFlow drawFlow(double strength, const VentedBox& box, const Visited& visited, Random& random)
{
    BoxFlow flow;
    flow.power = random.uniform(1.8, 2.0);
    const double loss = strength * std::sqrt(box.stiffness * box.mass) / std::pow(visited.velocity, flow.power - 1.0);
    flow.outward = loss * random.uniform(0.5, 1.0);
    flow.inward = loss * random.uniform(0.5, 1.0);
    flow.length = visited.displacement / (0.3 * strength * random.uniform(0.3, 1.0));
    return flow;
}

bool isChain(const HiddenEffect& effect, Random& random)
{
    constexpr double share = 0.4;
    const bool drawn = random.chance(share);
    return effect.chain.value_or(drawn);
}

std::vector<ConeMode> drawBreakup(double strength, double highEdge, Random& random)
{
    std::vector<ConeMode> modes(static_cast<std::size_t>(1 + random.index(3)));
    for (auto& mode : modes) {
        mode.frequency = highEdge * random.logUniform(0.3, 0.95);
        mode.quality = random.logUniform(4.0, 15.0);
        mode.gain = either(random) * strength / mode.quality;  // |r''/x''| is Q at the resonance
    }
    return modes;
}

std::vector<HungPart> drawParts(double strength, const Loudspeaker& speaker, double f0, double highEdge, Random& random)
{
    constexpr double heaviest = 0.3;  // of the cone's mass
    std::vector<HungPart> parts(static_cast<std::size_t>(1 + random.index(2)));
    for (auto& part : parts) {
        part.frequency = random.logUniform(2.0 * f0, std::min(10.0 * f0, 0.7 * highEdge));
        part.quality = random.logUniform(3.0, 12.0);
        part.mass = heaviest * strength * speaker.m;
    }
    return parts;
}

/// The effects that bend one parameter along what the loudspeaker visits.
struct DrawnLaw {
    std::string_view id;
    std::optional<Curve> Loudspeaker::*curve;
    Curve (*draw)(double strength, double range, Random&);
    double Visited::*range;
};
constexpr DrawnLaw drawnLaws[] = {
    {"force-factor", &Loudspeaker::forceFactor, drawForceFactor, &Visited::displacement},
    {"stiffness", &Loudspeaker::stiffness, drawStiffness, &Visited::displacement},
    {"inductance-position", &Loudspeaker::inductancePosition, drawInductancePosition, &Visited::displacement},
    {"inductance-current", &Loudspeaker::inductanceCurrent, drawInductanceCurrent, &Visited::current},
    {"damping-velocity", &Loudspeaker::dampingVelocity, drawDamping, &Visited::velocity},
};

}  // namespace

double addEffect(Loudspeaker& speaker, const HiddenEffect& effect, const Visited& visited, const BenchSetup& setup,
                 Random& random)
{
    const double drawn = random.logUniform(0.05, 0.6), strength = effect.strength > 0.0 ? effect.strength : drawn;
    const double f0 = std::sqrt(speaker.K / speaker.m) / turn;
    const auto& plan = setup.excitation;

    for (const auto& law : drawnLaws)
        if (effect.id == law.id) {
            auto& curve = speaker.*law.curve;
            curve = law.draw(strength, visited.*law.range, random);
            return curve->change(visited.*law.range);
        }
    if (effect.id == "eddy-currents") {  // strength: its impedance against the coil's at the high edge
        const double w = turn * plan.bandHigh, exponent = random.uniform(0.45, 0.9);
        const double size = strength * std::hypot(speaker.Re, w * speaker.Le);
        speaker.eddyCurrents = EddyCurrents {size / std::pow(w, exponent), exponent};
        if (isChain(effect, random)) {
            speaker.eddyCurrents = drawEddyChain(exponent, plan.bandLow, plan.bandHigh, random);
            const double now = std::abs(speaker.eddyImpedance({0.0, w}));
            for (auto& cell : speaker.eddyCurrents->cells)
                cell.resistance *= size / now;
        }
    } else if (effect.id == "creep") {  // strength: change of compliance over the band
        speaker.creep = drawCreep(strength, f0, plan.bandLow, random);
        if (isChain(effect, random))
            speaker.creep = drawCreepChain(strength, f0, plan.bandLow, random);
    } else if (effect.id == "friction")
        speaker.friction = drawFriction(strength, speaker.K * visited.displacement, visited.displacement, random);
    else if (effect.id == "coil-heating")  // strength: rise of Re in the end at the loudest level
        speaker.coilHeating = drawHeating(strength, visited.power, random);
    else if (effect.id == "vented-box") {
        auto box = drawBox(strength, speaker, f0, random);
        if (speaker.ventedBox)
            box.flow = speaker.ventedBox->flow;
        speaker.ventedBox = box;
    } else if (effect.id == "port-and-air") {
        if (!speaker.ventedBox)
            speaker.ventedBox = drawBox(0.3, speaker, f0, random);
        speaker.ventedBox->flow = drawFlow(strength, *speaker.ventedBox, visited, random);
    } else if (effect.id == "doppler") {
        speaker.doppler = true;
        return visited.velocity / 343.0;
    } else if (effect.id == "cone-breakup")  // strength: change of the pressure at the resonance
        speaker.coneBreakup = drawBreakup(strength, plan.bandHigh, random);
    else if (effect.id == "side-resonance")
        speaker.sideResonance = drawParts(strength, speaker, f0, plan.bandHigh, random);
    else {
        const auto known = joined(effectIds());
        throw Error(Error::Kind::usage, "There is no effect \"" + effect.id + "\" to hide; choose from " + known + ".");
    }
    return strength;
}

void setMoving(Loudspeaker& speaker, const Excitation& plan)
{
    auto& eddy = *speaker.eddyCurrents;
    eddy.moves = true;
    if (!eddy.cells.empty())
        return;
    const double slowest = slowestLoop(plan.bandLow);
    const auto loops = fractionalIntegral(1.0 - eddy.exponent, slowest, fastestLoop(plan.bandHigh));
    for (std::size_t n = 0; n < loops.rate.size(); ++n)
        if (loops.rate[n] >= slowest)
            eddy.cells.push_back({eddy.coefficient * loops.weight[n], loops.rate[n]});
}

}  // namespace excursion::bench
