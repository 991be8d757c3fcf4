// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

namespace excursion::bench {

/// The dependence of a loudspeaker parameter on one quantity q (position, current or velocity):
///     parameter(q) = parameter(0) * value(q),   value(q) = shape(y) / shape(y at q = 0),   y = (q - centre) / width
/// None of the shapes is a polynomial; e stands for `extra`, a for `amount`.
struct Curve {
    enum class Shape {
        erfGap,          ///< erf(y + e) - erf(y - e): a coil in a gap with Gaussian fringe field
        logisticGap,     ///< 1 / ((1 + exp(y - e)) (1 + exp(-y - e)))
        quarticGap,      ///< 1 / (1 + y^4)
        gaussianGap,     ///< exp(-y^2)
        coshSpring,      ///< cosh y
        expSpring,       ///< exp(sqrt(y^2 + e^2)): nearly linear stiffening, rounded in the middle
        rationalSpring,  ///< (1 + y^2) / (1 + e y^2)
        skewedSpring,    ///< (exp(y) + exp(-e y)) / 2
        tanhStep,        ///< 1 - a tanh y
        arctanStep,      ///< 1 - a (2/pi) arctan y
        rootStep,        ///< 1 - a y / sqrt(1 + y^2)
        saturation,      ///< 1 / sqrt(1 + y^2)
        rootDrag,        ///< 1 + a (sqrt(1 + y^2) - 1)
        powerDrag,       ///< 1 + a |y|^e / (1 + |y|^e), e >= 1.5
        tanhDrag         ///< 1 + a tanh(y^2)
    };

    Shape shape = Shape::coshSpring;
    double centre = 0.0;  ///< in the unit of q
    double width = 1.0;   ///< in the unit of q, positive
    double amount = 0.0;  ///< a
    double extra = 0.0;   ///< e

    struct Point {
        double value, slope;
    };
    Point at(double y) const;  ///< shape(y) and d shape / dy, not normalized

    double value(double q) const;  ///< 1 at q = 0
    double slope(double q) const;  ///< d value / dq, 1/unit of q

    /// The largest |value - 1| for q within [-range, range].
    double change(double range) const;

    /// A copy whose change over [-range, range] is `strength` (0.01 .. 0.9). Springs, gaps and the saturation become
    /// narrower or wider; steps and drags get their amount (its sign is kept). `centre` is kept, so an off-centre curve
    /// stays off centre.
    Curve scaledTo(double strength, double range) const;
};

std::string_view name(Curve::Shape);

}  // namespace excursion::bench
