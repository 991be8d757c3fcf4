// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Predistortion/Cone.h"
#include "Engine/Predistortion/InputGuard.h"
#include "Engine/Predistortion/Oversampling.h"
#include "Engine/Predistortion/Peak.h"
#include "Engine/Predistortion/RealTime.h"
#include "Engine/Predistortion/Recovery.h"

#include <array>
#include <atomic>
#include <cstddef>

namespace excursion {

/// The driver with its effects, in real time: from the voltage to the acceleration of the cone, which is what one hears
/// in front of it.
///     u -> up -> Cone -> down
/// For blocks and the audio thread see Predistorter. A sample that is not finite is played as silence. After it, and if
/// the motion is not finite, the driver starts from rest and fades in from silence.
class Speaker {
public:
    /// Throws Error, see requireRunnable.
    Speaker(const Model&, const RealTimeOptions&);

    int latency() const { return oversampling_.latency(); }  ///< samples; fixed
    int substeps() const { return cone_.substeps(); }        ///< steps per sample of the higher rate
    void reset();

    /// @param share  how much of the linear driver's output is subtracted, 0 to 1; followed smoothly, see Cone
    void setLinearShareRemoved(double share) { cone_.setLinearShareRemoved(share); }

    /// @param in   V (or N); n samples
    /// @param out  m/s^2; may be the same place
    void process(const double* in, double* out, std::size_t n);

    /// Since the last call of collectMeters(); may be read from another thread.
    struct Meters {
        double displacement = 0.0;  ///< peak, m
        double current = 0.0;       ///< peak, A
        int faults = 0;             ///< since construction
    };
    Meters collectMeters();

private:
    Oversampling oversampling_;
    Cone cone_;
    InputGuard guard_;
    Recovery recovery_;
    std::array<double, Oversampling::longestBlock> block_ {};
    std::array<double, 4 * Oversampling::longestBlock> fine_ {};
    Meters peak_;
    Peak displacement_, current_;
    std::atomic<int> faults_ {0};
};

/// m/s^2 per V that a linear driver approaches well above resonance and below the influence of its inductance, Bl/(Re
/// m) (1/m for a driver without a coil). The output is divided by it, to be heard at the level of the input.
double plateau(const Model&);

}  // namespace excursion
