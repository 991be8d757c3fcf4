// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Predistortion/AmplifierCoupling.h"

#include <array>
#include <cstddef>

namespace excursion {

/// What an amplifier's high-pass withholds, sample by sample: exact for the cubic through the latest four samples.
///
/// Thread: after construction nothing allocates, locks or throws.
class CouplingFilter {
public:
    /// @param sampleRate  Hz, of take()
    CouplingFilter(const AmplifierCoupling&, double sampleRate);

    void reset();
    /// What it holds of what was played, V: a constant u fills the first to u. The other is the fast state of order 2.
    std::array<double, 2> charge() const;
    void charge(const std::array<double, 2>&);  ///< as if new, but for this
    void take(double u);                        ///< the next sample, V

    /// Of the next sample u, what is withheld is coming() + direct() u.
    double coming() const { return coming_; }
    double direct() const { return direct_; }
    double latest() const { return past_[0]; }  ///< V, the latest sample
    /// Takes the next sample. @returns what of it reaches the loudspeaker, V
    double pass(double u)
    {
        const double passed = u - (coming_ + direct_ * u);
        take(u);
        return passed;
    }

    std::size_t order() const { return order_; }
    double state(std::size_t k) const { return state_[k]; }  ///< V, m of Withheld, at the latest sample

private:
    void foresee();

    std::size_t order_;
    std::array<std::array<double, 2>, 2> decay_ {};
    std::array<std::array<double, 4>, 2> input_ {};      ///< of u(n) .. u(n-3)
    std::array<double, 2> out_ {}, state_ {}, next_ {};  ///< next_: without the next sample
    std::array<double, 3> past_ {};                      ///< the latest samples, V
    double coming_ = 0.0, direct_ = 0.0;
};

}  // namespace excursion
