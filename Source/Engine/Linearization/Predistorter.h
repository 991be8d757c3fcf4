// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Linearization/Inverse.h"
#include "Engine/Linearization/Oversampling.h"
#include "Engine/Linearization/Peak.h"
#include "Engine/Linearization/RealTime.h"
#include "Engine/Linearization/Recovery.h"
#include "Engine/Linearization/Reference.h"

#include <array>
#include <atomic>
#include <cstddef>
#include <vector>

namespace excursion {

/// Bends the voltage so that the driver moves as if it were linear, sample by sample and without looking ahead:
///     u -> up -> Reference (x, v, a, j of the linear driver) -> limit of the excursion -> Inverse -> u' -> limit of the voltage -> down
/// The output is u + amount (u' - u). From 60 % of the limit of the excursion on it becomes u', at 80 % it is u' whatever the amount, as a
/// protection that can be turned down is none.
///
/// It is prepared by its construction, which allocates; reset(), set() and process() are for the audio thread: no allocation, no
/// lock, no system call, no exception. Blocks may have any length, and the output does not depend on how a signal is cut
/// into blocks. A sample that is not a finite number counts as silence. When anything inside is not finite, or beyond any loudspeaker,
/// the predistorter starts anew, the signal goes through as it is (delayed as ever, within the limit of the voltage) and, once
/// the filters have run full, is faded back. No subnormal number comes out.
class Predistorter {
public:
    /// Throws Error, see requireRunnable.
    Predistorter(const Model&, const RealTimeOptions&, const LinearizationControls& = {});

    int latency() const { return oversampling_.latency(); }   ///< samples; fixed

    /// As if new, but for the controls, which are at their targets at once.
    void reset();

    /// Where the controls are to go, within some 20 ms. A control that is not valid is left as it was.
    void set(const LinearizationControls&);

    /// @param in, out  V (or N); n samples, may be the same place
    void process(const double* in, double* out, std::size_t n);

    /// Since the last call of take(); may be read from another thread.
    struct Meters {
        double displacement = 0.0;   ///< peak of a cone that was given the output, m
        double voltage = 0.0;        ///< peak that came out, V
        double power = 0.0;          ///< W, largest running mean of the coil's heat
        double displacementReduction = 0.0, voltageReduction = 0.0, powerReduction = 0.0;   ///< dB by which each limit has turned the signal down at most; 0: not at all
        int faults = 0;              ///< since construction
    };
    Meters take();

private:
    double advance(double u);
    void fault();
    void publish();

    Oversampling oversampling_;
    Reference reference_;
    Inverse inverse_;
    Recovery recovery_;
    double smoothing_, release_;
    struct Levels {
        double amount, displacement, voltage;   ///< the limits as reciprocals: 0: none
    } now_ {}, target_ {};
    std::array<double, Oversampling::longestBlock> block_ {};
    std::array<double, 4 * Oversampling::longestBlock> fine_ {};
    std::vector<double> dry_;   ///< a ring, as long as the latency
    std::size_t dryPlace_ = 0;
    double lastOut_ = 0.0, step_ = 0.0;   ///< the output; what is left of the step that a fault makes
    bool faulty_ = false;
    Meters peak_;
    Peak displacement_, voltage_, power_, displacementReduction_, voltageReduction_, powerReduction_;
    std::atomic<int> faults_ {0};
};

} // namespace excursion
