// SPDX-License-Identifier: GPL-3.0-or-later
// From the fine grid of the integrator to the samples of a converter, and from the cone to the microphone.
#pragma once
#include <vector>

namespace sim {

// A linear-phase low-pass, flat to 0.44 of the output's rate; no delay.
std::vector<double> decimate(const std::vector<double>& fine, int factor);

// Sound of a small piston in a half space at a distance on axis. With Doppler the sound leaves from where the
// cone is at that moment: t = t_e + (distance - x(t_e))/c.
std::vector<double> radiate(const std::vector<double>& cone, const std::vector<double>& port,
                            const std::vector<double>& x, double rate, double distance, bool doppler);

}  // namespace sim
