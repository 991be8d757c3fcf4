// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Predistortion/Equalizer.h"
#include "Engine/Predistortion/Glide.h"
#include "Engine/Predistortion/Target.h"

#include <complex>

namespace excursion {

/// A target, sample by sample: T(s) of Target.h in the trapezoidal form, in which its states are those of the two
/// integrators (Zavalishin, The Art of VA Filter Design, 2012, section 4),
///     y = u + (w0/(wt Q0) - 1/Qt) v1 + ((w0/wt)^2 - 1) v2,   v1 = (s/wt) v2,   v2 = u wt^2/(s^2 + (wt/Qt) s + wt^2),
/// with s = (wt/tan(wt T/2)) (z - 1)/(z + 1). So it is exact at 0 and at ft, and at half the sample rate it is 1, as
/// T(s) is at infinity. Elsewhere the relative frequency error is (w T)^2/12, 2e-5 at 120 Hz and 48 kHz. With the
/// driver's own resonance both factors are zero, and y equals u bit for bit. A new target is followed along the
/// logarithms of ft and Qt within some 50 ms, and the states do not jump. The equalizer follows this filter.
///
/// Thread: after construction nothing allocates, locks or throws.
class TargetFilter {
public:
    /// @param sampleRate  Hz, of step()
    TargetFilter(const OwnLinearPart&, double sampleRate);

    const OwnLinearPart& own() const { return own_; }
    void aim(const Target&);  ///< an invalid target is ignored
    void jump();              ///< to the target
    void reset();             ///< as jump(), and as after silence
    double step(double u);

    /// V per V, the response of the target, including the effect of the trapezoidal form. For any thread but the audio
    /// thread.
    std::complex<double> at(double frequency) const;

private:
    void set(const Resonance&);
    Resonance within(Resonance) const;

    OwnLinearPart own_;
    Equalizer equalizer_;
    double sampleRate_;
    Resonance target_;
    Glide frequency_, quality_;  ///< logarithms
    bool settled_ = true;
    double a1_ = 0.0, a2_ = 0.0, a3_ = 0.0, byFirst_ = 0.0, bySecond_ = 0.0;
    double first_ = 0.0, second_ = 0.0;  ///< states of the integrators
};

}  // namespace excursion
