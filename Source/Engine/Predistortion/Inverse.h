// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"
#include "Engine/Predistortion/LinearForm.h"
#include "Engine/Predistortion/LinearMemory.h"
#include "Engine/Predistortion/Memory.h"
#include "Engine/Predistortion/Reference.h"

#include <array>
#include <limits>
#include <optional>
#include <vector>

namespace excursion {

/// The input with which a driver, with all its effects, moves as it is told: inversion by flatness (Fliess, Levine,
/// Martin & Rouchon, Int. J. Control 61, 1995; for loudspeakers Schurer, Slump & Herrmann, 1998). Position is a flat
/// output: from x, v, a and j follow the current, by the force balance, and the voltage, by the electrical loop,
///     F(i, x, v, m) = M a,
///     di/dt = (M j - F_t)/F_i,        F_t = F_x v + F_v a + F_m dm/dt,
///     u = drop + L di/dt + fluxSlope v.
/// Every effect contributes through the lines that simulate it (Effect::contribute), run on numbers that carry the
/// derivatives by time and by current, and its memory is carried along (LinearMemory.h, Memory.h). What is linear is
/// asked once and summed up (LinearForm.h).
///
/// The current is extrapolated by its difference to the linear driver's, which is small and slow, to i_p, and
/// one Newton step, i = i_p + (M a - F)/F_i, is exact but for the square of what the extrapolation missed (reluctance
/// force alone is not linear in i); where that is much, as at an edge, a second one follows. F_i, at rest Bl, is kept
/// from falling below a tenth of its value at rest, where a driver can no longer be made to follow; the current is
/// bounded by ten times what its effects were measured at. A driver without a coil has u = M a - F.
class Inverse {
public:
    /// @param sampleRate  Hz, of step()
    Inverse(const Model&, double sampleRate);

    void reset();

    /// The input (V, or N of a driver without a coil) at this point of the motion; call it for every sample of it.
    double step(const MotionPoint&);

    /// The input at another end of the latest step, which is taken back.
    double again(const MotionPoint&);

    double current() const { return now_.current; }  ///< A, at the latest point
    /// By how much of the input the force at the latest point goes with the input that it takes at rest: Bl(0)/Bl(x),
    /// and the like.
    double ease() const { return ease_; }

private:
    double solve(const MotionPoint&, double guess);  ///< one Newton step from this current, A
    void takeBack();

    /// An effect that is asked at every sample.
    struct Curved {
        const Effect* effect;
        OperatingRange operatingRange;
        std::vector<Tangent> coefficients;
        std::optional<std::size_t> block;  ///< of together_, where its memory is
        std::optional<Memory> memory;      ///< or by itself
        std::vector<Tangent> state, rate;
    };
    /// The memory of a linear one that is not among together_.
    struct Lagging {
        Memory memory;
        std::vector<double> drop, force;  ///< what each state adds
    };

    bool electrical_;
    double period_;
    double largestCurrent_ = std::numeric_limits<double>::infinity();  ///< A
    LinearForm linear_;                                                ///< of all that is linear, without the memories
    /// of all that is linear, with what the current does to the memories
    double dropByCurrent_ = 0.0, forceByCurrent_ = 0.0;
    LinearMemory together_;
    std::vector<Lagging> lagging_;
    std::vector<Curved> curved_;
    double forcePerCurrent_ = 0.0;  ///< N/A, at rest
    double ease_ = 1.0;
    struct Instant {
        MotionPoint motion;
        double current = 0.0, before = 0.0, slope = 0.0;  ///< i(n-1), i(n-2), A; di/dt, A/s
        /// the latest differences to the linear driver's current, A
        std::array<double, 3> ahead {};
    } now_, past_;  ///< past_: before the latest step
};

}  // namespace excursion
