// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <complex>

namespace excursion {

/// Where a pole or zero lies beside the points that a response is taken at: an arc of the unit circle and its
/// conjugate, or (+-j w)^alpha, which lie on the two rays at angles +-alpha pi/2 [B figure 6.9] and for alpha = 1 on
/// one axis. Roots are lambda, see PoleZero.h; frequencies are in Hz.

/// The least and the largest distance to the points of a band.
struct RootDistance {
    double least = 0.0, most = 0.0;
};
RootDistance distanceToBand(std::complex<double> root, double sampleRate, double low, double high, double alpha = 1.0);

/// Where the response bends most: at the angle of a root, or at the foot of its perpendicular on a ray; 0 where that
/// lies behind the origin.
double nearestFrequency(std::complex<double> root, double sampleRate, double alpha = 1.0);

}  // namespace excursion
