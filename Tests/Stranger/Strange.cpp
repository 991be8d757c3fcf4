// SPDX-License-Identifier: GPL-3.0-or-later
#include "Strange.h"
#include <cmath>

namespace sim {

Strange::Strange(const Setup& s)
    : contact(s.number("on.contact") != 0),
      wander(s.number("on.wander") != 0),
      bowTie(s.number("on.bow-tie") != 0),
      jump(s.number("on.jump") != 0),
      rub(s.number("on.rub") != 0),
      contactAt(s.number("contact.at")),
      contactK(s.number("contact.stiffness")),
      contactSoft(s.number("contact.soft", 1)),
      wanderDepth(s.list("wander.depth")),
      wanderHz(s.list("wander.hz")),
      wanderPhase(s.list("wander.phase")),
      bowLimit(s.number("bow.limit")),
      bowReach(s.number("bow.reach", 1)),
      bowWidth(s.number("bow.width", 1)),
      jumpTimes(s.list("jump.times")),
      jumpBy(s.number("jump.by")),
      jumpSeconds(s.number("jump.seconds", 1)),
      rubAt(s.number("rub.at")),
      rubForce(s.number("rub.force")),
      rubWidth(s.number("rub.width", 1)),
      rubSpeed(s.number("rub.speed", 1))
{
}

// The stiffness moves like a sum of slow tones that have nothing to do with the period of the signal.
double Strange::stiffnessScale(double t) const
{
    double sum = 1;
    if (wander)
        for (std::size_t k = 0; k < wanderDepth.size(); ++k)
            sum += wanderDepth[k] * std::sin(2 * M_PI * wanderHz[k] * t + wanderPhase[k]);
    return sum;
}

// The rest position snaps between two places at the given times, each within a few milliseconds.
double Strange::restShift(double t) const
{
    if (!jump)
        return 0;
    double sum = 0, sign = 1;
    for (double at : jumpTimes) {
        sum += sign * (1 + std::tanh((t - at) / jumpSeconds)) / 2;
        sign = -sign;
    }
    return jumpBy * sum;
}

double Strange::force(double x, double v, const double* y, double* dy) const
{
    double sum = 0;
    if (contact) {  // a spring that is met at contactAt (negative: inward), its edge rounded over contactSoft
        double depth = (contactAt > 0 ? x - contactAt : contactAt - x) / contactSoft;
        double soft = depth > 30 ? depth : std::log1p(std::exp(depth));
        sum += (contactAt > 0 ? 1 : -1) * contactK * contactSoft * soft;
    }
    if (bowTie) {  // hysteresis whose width grows with the square of the excursion
        dy[0] = (v - std::abs(v) * y[0]) / bowReach;
        double z = x / bowWidth;
        sum += bowLimit * y[0] * z * z;
    }
    if (rub) {  // dry friction on one side only
        double z = (x - rubAt) / rubWidth;
        sum += rubForce * (1 + std::tanh(z)) / 2 * std::tanh(v / rubSpeed);
    }
    return sum;
}

}  // namespace sim
