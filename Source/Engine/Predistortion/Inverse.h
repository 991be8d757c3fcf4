// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"
#include "Engine/Predistortion/LinearForm.h"
#include "Engine/Predistortion/LinearMemory.h"
#include "Engine/Predistortion/Memory.h"
#include "Engine/Predistortion/Reference.h"
#include "Engine/Predistortion/Warmth.h"

#include <array>
#include <limits>
#include <optional>
#include <vector>

namespace excursion {

/// The input with which a driver, with all its effects, follows a given motion: inversion by flatness (Fliess, Levine,
/// Martin & Rouchon, Int. J. Control 61, 1995; for loudspeakers Schurer, Slump & Herrmann, 1998). Position is a flat
/// output: from x, v, a and j follow the current, by the force balance, and the voltage, by the electrical loop,
///     F(i, x, v, m) = M a,
///     di/dt = (M j - F_t)/F_i,        F_t = F_x v + F_v a + F_m dm/dt,
///     u = drop + L di/dt + fluxSlope v.
/// Every effect contributes through the same code that simulates it (Effect::contribute), run on numbers that carry the
/// derivatives with respect to time and current. Its memory is stepped along (LinearMemory.h, Memory.h). Linear
/// contributions are evaluated once and summed (LinearForm.h).
///
/// The difference to the linear driver's current is small and slow, so extrapolating it gives a prediction i_p. One
/// Newton step, i = i_p + (M a - F)/F_i, is exact except for the square of the prediction's error, as only the
/// reluctance force is not linear in i. If that error is large, as at an edge, a second step follows. F_i, which is Bl
/// at rest, is kept above a tenth of its value at rest; below that, a driver can no longer be made to follow. The
/// current is limited to ten times the value that its effects were measured at. A driver without a coil has u = M a -
/// F.
class Inverse {
public:
    /// @param sampleRate  Hz, of step()
    Inverse(const Model&, double sampleRate);

    void reset();

    void keep(Warmth&) const;  ///< writes what is slow (Effect::slow)
    void warm(const Warmth&);  ///< takes what is slow from there
    /// What is slow goes on for a time by the rate that this motion gives it; nothing else does.
    void drift(const MotionPoint&, double seconds);
    /// What is slow becomes that of another inverse of the same model, all other memories go to it by a share of the
    /// way.
    void join(const Inverse& other, double share);
    /// By what the resistance of the coil has risen, ohm: the voltage that slow effects take per ampere.
    double rise();

    /// The input (V, or N for a driver without a coil) at this point of the motion. Call it for every sample of the
    /// motion.
    double step(const MotionPoint&);

    /// Undoes the latest step and repeats it with another end point.
    double again(const MotionPoint&);

    double current() const { return now_.current; }  ///< A, at the latest point
    /// The input that a force takes at the latest point, over the input that it takes at rest: Bl(0)/Bl(x), and
    /// similar.
    double ease() const { return ease_; }

private:
    double solve(const MotionPoint&, double guess);  ///< one Newton step from this current, A
    void takeBack();
    /// Every memory, of whichever kind.
    template <class Act>
    void forEachMemory(const Act& act);
    /// Every memory of an effect that is slow.
    template <class Self, class Act>
    static void forEachSlow(Self&, const Act& act);

    /// An effect that is evaluated at every sample.
    struct Curved {
        const Effect* effect;
        OperatingRange operatingRange;
        std::vector<Tangent> coefficients;
        std::optional<std::size_t> block;  ///< index of its memory in together_
        std::optional<Memory> memory;      ///< or its own memory
        std::vector<Tangent> state, rate;
    };
    /// The memory of a linear effect that is not in together_.
    struct Lagging {
        Memory memory;
        std::vector<double> drop, force;  ///< contribution of each state
    };

    bool electrical_;
    double period_;
    double largestCurrent_ = std::numeric_limits<double>::infinity();  ///< A
    LinearForm linear_;  ///< sum of all linear contributions, without the memories
    /// of all linear contributions, including the current's effect on the memories
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
