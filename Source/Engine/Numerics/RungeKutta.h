// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

namespace excursion {

/// The classical fourth-order Runge-Kutta method for dm/dt = rate(time, m), for any number type. Allocates when it is
/// made only.
template <class T>
class RungeKutta {
public:
    explicit RungeKutta(std::size_t size) : stage_(size), k2_(size), k3_(size), k4_(size) {}

    /// Steps m from where its rate is k1.
    /// @param h     of the step, s
    /// @param rate  rate(share, m, out): writes the rate of m at that share of the step, 0.5 or 1
    template <class Rate>
    void step(std::vector<T>& m, const std::vector<T>& k1, double h, const Rate& rate)
    {
        rate(0.5, moved(m, k1, 0.5 * h), k2_);
        rate(0.5, moved(m, k2_, 0.5 * h), k3_);
        rate(1.0, moved(m, k3_, h), k4_);
        for (std::size_t k = 0; k < m.size(); ++k)
            m[k] += (h / 6.0) * (k1[k] + 2.0 * (k2_[k] + k3_[k]) + k4_[k]);
    }

private:
    const std::vector<T>& moved(const std::vector<T>& m, const std::vector<T>& rate, double time)
    {
        for (std::size_t k = 0; k < m.size(); ++k)
            stage_[k] = m[k] + time * rate[k];
        return stage_;
    }

    std::vector<T> stage_, k2_, k3_, k4_;
};

}  // namespace excursion
