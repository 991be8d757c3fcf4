// SPDX-License-Identifier: GPL-3.0-or-later
#include "Laws.h"
#include <cmath>

namespace sim {

static double lnCosh(double z)
{
    z = std::abs(z);
    return z + std::log1p(std::exp(-2 * z)) - M_LN2;
}

ForceFactor::ForceFactor(const Setup& s)
    : curved(s.number("on.force-factor") != 0),
      rest(s.number("Bl")),
      coil(s.number("bl.coil")),
      gap(s.number("bl.gap")),
      above(s.number("bl.above")),
      below(s.number("bl.below")),
      offset(s.number("bl.offset"))
{
    if (curved)
        scale = 1 / overlap(offset);
}

// Field: (tanh((z + gap/2)/below) - tanh((z - gap/2)/above))/2, integrated over the coil.
double ForceFactor::overlap(double x) const
{
    auto integral = [&](double z) {
        return below * lnCosh((z + gap / 2) / below) - above * lnCosh((z - gap / 2) / above);
    };
    return (integral(x + coil / 2) - integral(x - coil / 2)) / (2 * coil);
}

Suspension::Suspension(const Setup& s)
    : curved(s.number("on.stiffness") != 0),
      K(s.number("K")),
      spider(s.number("k.spider")),
      spiderWidth(s.number("k.spiderWidth", 1)),
      spiderCentre(s.number("k.spiderCentre")),
      roll(s.number("k.roll")),
      rollWidth(s.number("k.rollWidth", 1)),
      rollCentre(s.number("k.rollCentre")),
      wallOut(s.number("k.wallOut")),
      wallOutAt(s.number("k.wallOutAt")),
      wallIn(s.number("k.wallIn")),
      wallInAt(s.number("k.wallInAt")),
      wallWidth(s.number("k.wallWidth", 1))
{
    if (!curved)
        return;
    auto slope = [&] {
        double t = std::tanh(-rollCentre / rollWidth);
        return spider * std::cosh(-spiderCentre / spiderWidth) + roll * (1 - t * t)
               + wallOut * std::exp(-wallOutAt / wallWidth) + wallIn * std::exp(-wallInAt / wallWidth);
    };
    scale = K / slope();
    rawAtRest = raw(0);
}

double Suspension::raw(double x) const
{
    return spider * spiderWidth * std::sinh((x - spiderCentre) / spiderWidth)
           + roll * rollWidth * std::tanh((x - rollCentre) / rollWidth)
           + wallOut * wallWidth * std::exp((x - wallOutAt) / wallWidth)
           - wallIn * wallWidth * std::exp((-x - wallInAt) / wallWidth);
}

InductanceOverPosition::InductanceOverPosition(const Setup& s)
    : curved(s.number("on.inductance-position") != 0),
      low(s.number("lx.low")),
      centre(s.number("lx.centre")),
      width(s.number("lx.width", 1)),
      bump(s.number("lx.bump")),
      bumpAt(s.number("lx.bumpAt")),
      bumpWidth(s.number("lx.bumpWidth", 1))
{
    if (!curved)
        return;
    double value, slope;
    raw(0, value, slope);
    scale = 1 / value;
}

void InductanceOverPosition::raw(double x, double& value, double& slope) const
{
    double t = std::tanh((x - centre) / width);
    double z = (x - bumpAt) / bumpWidth, g = bump * std::exp(-z * z / 2);
    value = low + (1 - low) * (1 - t) / 2 + g;
    slope = -(1 - low) * (1 - t * t) / (2 * width) - g * z / bumpWidth;
}

void InductanceOverPosition::operator()(double x, double& value, double& slope) const
{
    if (!curved) {
        value = 1;
        slope = 0;
        return;
    }
    raw(x, value, slope);
    value *= scale;
    slope *= scale;
}

Saturation::Saturation(const Setup& s)
    : curved(s.number("on.inductance-current") != 0),
      bias(s.number("li.bias")),
      knee(s.number("li.knee", 1)),
      round(s.number("li.round", 1))
{
    if (curved)
        raw(bias, flux0, slope0, energy0);
}

void Saturation::raw(double h, double& flux, double& slope, double& energy) const
{
    double s = std::sqrt(h * h + round * round), d = 1 + s / knee;
    flux = h / d;
    slope = 1 / d - h * h / (s * knee * d * d);
    energy = knee * (s - knee * std::log(d));
}

void Saturation::operator()(double i, double& flux, double& slope, double& energy) const
{
    if (!curved) {
        flux = i;
        slope = 1;
        energy = i * i / 2;
        return;
    }
    raw(i + bias, flux, slope, energy);
    energy = (energy - energy0 - i * flux0) / slope0;
    flux = (flux - flux0) / slope0;
    slope /= slope0;
}

Damping::Damping(const Setup& s)
    : curved(s.number("on.damping-velocity") != 0),
      R(s.number("Rms")),
      turbulence(s.number("rv.turbulence")),
      uneven(s.number("rv.uneven")),
      scale(s.number("rv.scale", 1))
{
}

double Damping::force(double v) const
{
    if (!curved)
        return R * v;
    double z = v / scale;
    return R * v * (1 + turbulence * (std::sqrt(1 + z * z) - 1) + uneven * std::tanh(z));
}

}  // namespace sim
