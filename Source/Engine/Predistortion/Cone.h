// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/ExponentialAdams.h"
#include "Engine/Loudspeaker/Plausible.h"
#include "Engine/Loudspeaker/Radiator.h"
#include "Engine/Predistortion/Glide.h"
#include "Engine/Predistortion/RealTime.h"
#include "Engine/Predistortion/Reference.h"
#include "Engine/Predistortion/Warmth.h"

#include <array>

namespace excursion {

/// The driver with its effects, sample by sample: from the voltage to the acceleration that is heard. This is the
/// acceleration of the cone and of everything else that an effect makes radiate (Emission), minus a share of that of a
/// linear driver (Reference). With a share of 1 only the distortion is left. All parts are heard without delay: a delay
/// that varies is not played. The laws set the number of steps, which does not adapt. Between samples the input is a
/// cubic through the latest four (ExponentialAdams).
///
/// Thread: after construction nothing allocates, locks or throws.
class Cone {
public:
    /// @param sampleRate  Hz, of step()
    Cone(const Model&, double sampleRate);

    int substeps() const { return substeps_; }  ///< steps per sample
    void rest();                                ///< at rest from now on
    void reset();                               ///< at rest, and the share at its target

    void warm(const Warmth&);  ///< its coil is as warm as that

    /// @param share  how much of the linear driver's output is subtracted, 0 to 1; followed smoothly. The linear driver
    ///               runs only while a share is removed: switched on in the middle of a sound, it first settles, for a
    ///               second at most, and nothing is subtracted until then
    void setLinearShareRemoved(double share);

    /// @param sample  V (or N); becomes m/s^2
    /// @returns false when the motion is not finite or beyond any loudspeaker: then the cone is at rest and the sample
    /// 0
    bool step(double& sample);

    double displacement() const { return motion_.displacement(); }  ///< m
    double current() const { return motion_.current(); }            ///< A

private:
    double linearShare(double u);

    bool corrected_;  ///< the laws are so fast that they are evaluated twice per step; see ExponentialAdams
    int substeps_;
    ExponentialAdams motion_;
    Plausible plausible_;
    Reference reference_;
    Radiator radiator_;
    double area_;             ///< m^2, reference area of the sound
    Eigen::VectorXd linear_;  ///< the part of the reference's state that is heard, m/s^2
    double linearInput_;      ///< and of the input
    Glide share_;
    double asked_ = 0.0;             ///< share; none is taken off until the reference has settled
    int settling_ = 0;               ///< samples that this takes
    int left_ = 0;                   ///< of these; settling_ + 1: the reference does not run
    std::array<double, 3> past_ {};  ///< u(n-1), u(n-2), u(n-3)
};

}  // namespace excursion
