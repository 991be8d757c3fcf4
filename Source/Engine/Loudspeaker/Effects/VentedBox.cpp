// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/Effects/Effects.h"
#include "Engine/Loudspeaker/Effects/SharedAir.h"

#include "Engine/Loudspeaker/Network.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace excursion {
namespace {

/// The air spring that cone and port share (SharedAir.h). At rest, without a leak, x, y and the radiator share the
/// spring's pull, so that the box adds Ka r/(1 + r) to the stiffness, and far above the tuning Ka, of which Kb = Ka/(1
/// + r) is the difference. The base's K stays the stiffness at rest, with the box in it:
///     force:  -Ka pull + Kb r x
/// For then the cone without leak and absorption does not depend on r, which the sound alone shows: the radiator's
/// notch is at fB sqrt(r/(1 + r)). The microphone hears the cone, and the port as much as its place lets it: `port` is
/// 1 far away, less close to the cone. The memory does not depend on Kb, which is a strength. A closed box adds to K
/// alone, until its air gets out through a leak, which is a port that does not ring: what is left below its tuning is
/// the suspension alone.
class VentedBox final : public EffectOf<VentedBox>, public NetworkParts {
public:
    VentedBox()
        : EffectOf(
            {.id = "vented-box",
             .title = "Box with a port, a passive radiator or a leak",
             .physics =
                 "The air in the box is a spring between the cone and the air in the port, or a passive radiator: a "
                 "second resonance. Through a leak a closed box loses its spring at the lowest frequencies.",
             .symptoms = "two humps in the impedance with a dip between them, where the cone stands nearly still and "
                         "the port moves; of a leak, motion that grows far below the resonance",
             .remedy = "It is no fault; box volume and port length set where the dip is, a leak or stuffing lowers the "
                       "humps. Where the box should be closed, seal it.",
             .electrical = false,
             .linear = true})
    {
    }

    std::vector<Parameter> parameters(const OperatingRange& e) const override
    {
        auto stiffness = positiveParameter("Kb", "N/m", 0.0),
             tuning = positiveParameter("fB", "Hz", 4.0 * e.lowFrequency),
             port = positiveParameter("1/QP", "1", someLoss), leak = positiveParameter("1/QL", "1", someLoss),
             absorption = positiveParameter("1/QA", "1", 0.0), radiator = positiveParameter("Kp/Ka", "1", 0.0),
             share = positiveParameter("port", "1", 0.0);
        stiffness.strength = share.strength = true;
        // Losses are small and an open port has no spring: without better knowledge they stay near zero.
        for (auto* p : {&port, &leak, &absorption, &radiator})
            p->prior = 0.3;
        radiator.heard = share.heard = true;
        return {stiffness, tuning, port, leak, absorption, radiator, share};
    }
    std::vector<std::vector<double>> starts(const OperatingRange& e) const override
    {
        std::vector<std::vector<double>> starts;
        for (const double octaves : {0.5, 1.5})  // a leak
            starts.push_back({0.0, std::exp2(octaves) * e.lowFrequency, 1.0, someLoss, 0.0, 0.0, 0.0});
        const auto leaks = starts.size();
        for (double f = 1.5 * e.lowFrequency;
             f < 100.0 * e.lowFrequency && (starts.size() == leaks || f < 0.1 * e.highFrequency); f *= 1.5)
            starts.push_back({0.0, f, someLoss, someLoss, 0.0, 0.0, 0.0});
        return starts;
    }
    /// Without a port the cone would resonate at the tuning or above, where a fit of one hump to two does not look;
    /// without the air of a closed box well above its leak. That air is most of the stiffness that the base has found.
    std::vector<Restart> restarts(const OperatingRange&, const std::vector<double>& start,
                                  const std::vector<Parameter>& base) const override
    {
        if (start[2] <= someLoss)
            return {{start[1], start}, {1.5 * start[1], start}};
        std::vector<Restart> restarts;
        for (const double above : {2.0, 6.0}) {
            Restart restart {above * start[1], start};
            const double suspension = std::pow(restart.resonance / resonanceOf(base), 2);  // of the stiffness
            restart.own[0] = std::max(0.0, 1.0 - suspension) * parameterNamed(base, "K").value;
            restarts.push_back(std::move(restart));
        }
        return restarts;
    }
    /// A port rings, at a frequency that was measured and no more than two octaves above the cone's resonance. Its air
    /// or the radiator is not much lighter than the cone, heavier the higher it is tuned, and the air in the box is
    /// not much softer than the suspension: what is found in real boxes lies well inside. Something lighter is a part
    /// that swings by itself. A leak does not ring, far below the resonance of cone and box, whose air is stiffer than
    /// the suspension, but does not leave it without a part: a weaker relaxation is rather one of the suspension, a
    /// total one of a liquid in the gap.
    bool plausible(const OperatingRange& e, const std::vector<Parameter>& own,
                   const std::vector<Parameter>& base) const override
    {
        constexpr double leastQuality = 2.0, leastStiffness = 0.1, leastMass = 0.08, highestTuning = 4.0;
        constexpr double leastLeakQuality = 0.4, lowestLeak = 0.5, highestLeak = 0.125;
        constexpr double leastLeakStiffness = 2.0, mostLeakStiffness = 100.0;
        const double K = parameterNamed(base, "K").value, m = parameterNamed(base, "m").value, tuning = own[1].value;
        const double turn = 2.0 * std::numbers::pi,
                     mass = own[0].value * std::pow((1.0 + own[5].value) / (turn * tuning), 2);
        const double losses = own[2].value + own[3].value + own[4].value;
        if (tuning > e.highFrequency || mass < leastMass * m * tuning / resonanceOf(base))
            return false;
        if (losses < 1.0 / leastQuality)
            return tuning > e.lowFrequency && tuning < highestTuning * resonanceOf(base)
                   && own[0].value > leastStiffness * K;
        return losses < 1.0 / leastLeakQuality && tuning > lowestLeak * e.lowFrequency
               && tuning < highestLeak * std::sqrt((K + own[0].value) / m) / turn
               && own[0].value > leastLeakStiffness * K && own[0].value < mostLeakStiffness * K;
    }

    int memorySize(const OperatingRange&) const override { return sharedair::states; }
    int coefficientCount(const OperatingRange&) const override { return sharedair::coefficients; }

    template <class T>
    void prepareFor(const OperatingRange& e, const T* p, T* c) const
    {
        sharedair::prepare(e, p, c);
    }

    template <class T>
    void addTo(const OperatingRange& e, const T* c, const Motion<T>& at, const T* memory, T* rate,
               Balance<T>& sum) const
    {
        const T pull = sharedair::pull(e, c, at.v, T(0.0), memory, rate);
        sum.force += c[sharedair::springAtRest] * at.x - c[sharedair::Ka] * pull;
    }

    /// The air spring, with its absorption, between the cone and what leaks, from there to the port, which moves inward
    /// as the cone moves outward; the port's mass, losses and, of a radiator, its spring with what it yields.
    void draw(const OperatingRange& e, const double* c, NetworkDrawing& into) const override
    {
        const double Ka = c[sharedair::Ka];
        if (Ka == 0.0)
            return;
        const double portMass = Ka / c[sharedair::byPull], leak = c[sharedair::leak] / Ka;  // velocity over force
        const std::string air = leak > 0.0 ? "air" : "port";
        into.spring(Network::cone, Network::ground, -c[sharedair::springAtRest]);
        into.spring(Network::cone, air, Ka);
        into.damper(Network::cone, air, Ka * c[sharedair::absorption]);
        if (leak > 0.0)
            into.damper(air, "port", 1.0 / leak);
        into.mass("port", portMass);
        into.damper("port", Network::ground, portMass * c[sharedair::portLoss]);
        if (const double spring = portMass * c[sharedair::radiator]; spring > 0.0) {
            into.spring("port", "radiator", spring);
            into.damper("radiator", Network::ground, spring / (sharedair::yield * e.lowFrequency));
        }
    }
    bool ofEnclosure() const override { return true; }

    template <class T>
    void radiate(const OperatingRange&, const T* c, const Motion<T>&, const T&, const T*, const T* rate,
                 Emission<T>& sum) const
    {
        sum.acceleration += c[sharedair::share] * rate[sharedair::portVelocity];
    }

private:
    static constexpr double someLoss = 0.1;
};

}  // namespace

const Effect& ventedBox()
{
    static const VentedBox effect;
    return effect;
}

}  // namespace excursion
