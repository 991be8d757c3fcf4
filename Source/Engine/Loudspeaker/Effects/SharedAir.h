// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Effect.h"

#include <numbers>

namespace excursion::sharedair {

/// An air spring that cone and port share [Small, Vented-Box Loudspeaker Systems, J. Audio Eng. Soc. 21, 1973]. All
/// displacements are volumes over the cone's area, positive outward: x of the cone, y of the port, l of what leaks; w =
/// x + y + l expands the air, which pulls with Ka (w + s), s what its spring departs from a line. A passive radiator of
/// mass mp has a spring Kp besides, r = Kp/Ka; an open port has none.
///     pull    = w + s + dA/wB dw/dt
///     port:   mp d2y/dt2 = -Ka pull - Kp y - mp wB dP dy/dt,     wB^2 = (Ka + Kp)/mp,   dP = 1/QP
///     leak:   dl/dt = -wB dL pull,                               dL = 1/QL; dA = 1/QA is absorption
/// The memory is w, dy/dt and y.
/// Parameters: Kb = Ka/(1 + r) in N/m, fB in Hz, 1/QP, 1/QL, 1/QA, r, share of the port that is heard.
constexpr std::size_t parameters = 7;

/// Places of the coefficients.
enum : std::size_t { Ka, springAtRest, byPull, portLoss, radiator, leak, absorption, share, coefficients };
enum : std::size_t { w, portVelocity, portDisplacement, states };

/// The radiator's spring yields below a thousandth of the lowest frequency of interest, so that nothing integrates for
/// ever.
constexpr double yield = 2.0 * std::numbers::pi * 0.001;

/// Coefficients: Ka, Kb r, wB^2/(1 + r), wB dP, wB^2 r/(1 + r), wB dL, dA/wB, share heard. The tuning stays at the end
/// of what was measured where a search that finds nothing runs away with it.
template <class T>
void prepare(const OperatingRange& e, const T* p, T* c)
{
    const T tuning = 2.0 * std::numbers::pi * atMost(e.highFrequency, p[1]), &r = p[5];
    c[Ka] = p[0] * (1.0 + r);
    c[springAtRest] = p[0] * r;
    c[byPull] = tuning * tuning / (1.0 + r);
    c[portLoss] = tuning * p[2];
    c[radiator] = c[byPull] * r;
    c[leak] = tuning * p[3];
    c[absorption] = p[4] / tuning;
    c[share] = p[6];
}

/// Writes the rates of the memory; the pull.
/// @param v       m/s, of the cone
/// @param spring  s, m
template <class T>
T pull(const OperatingRange& e, const T* c, const T& v, const T& spring, const T* memory, T* rate)
{
    const T sprung = memory[w] + spring;
    rate[w] = (v + memory[portVelocity] - c[leak] * sprung) / (1.0 + c[leak] * c[absorption]);  // solved for dw/dt
    const T pulls = sprung + c[absorption] * rate[w];
    rate[portVelocity] = -c[byPull] * pulls - c[portLoss] * memory[portVelocity]
                         - c[radiator] * memory[portDisplacement];
    rate[portDisplacement] = memory[portVelocity] - yield * e.lowFrequency * memory[portDisplacement];
    return pulls;
}

}  // namespace excursion::sharedair
