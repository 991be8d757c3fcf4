// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace excursion {

/// A state that forgets at a steady rate r, dm/dt = a - r m, over one step: a goes along the parabola through its
/// values at the step's begin, middle and end, and the state exactly with it.
template <class T>
class Relaxation {
public:
    Relaxation(const T& rate, double step)
    {
        using std::exp;
        const T z = rate * step;
        decay_ = exp(-z);
        // integrals of exp(-z (1 - s)) s^j over the step
        T I0, I1, I2;
        if (z < T(0.1)) {
            const auto series = [&](double factor, int j) {
                T term = T(factor), total = term;
                for (int k = 1; k < 8; ++k) {
                    term *= -z / static_cast<double>(j + k + 1);
                    total += term;
                }
                return total;
            };
            I0 = series(1.0, 0);
            I1 = series(1.0 / 2.0, 1);
            I2 = series(1.0 / 3.0, 2);
        } else {
            I0 = (1.0 - decay_) / z;
            I1 = (1.0 - I0) / z;
            I2 = (1.0 - 2.0 * I1) / z;
        }
        begin_ = step * (I0 - 3.0 * I1 + 2.0 * I2);
        middle_ = step * 4.0 * (I1 - I2);
        end_ = step * (2.0 * I2 - I1);
    }

    T after(const T& m, const T& begin, const T& middle, const T& end) const
    {
        return decay_ * m + begin_ * begin + middle_ * middle + end_ * end;
    }

private:
    T decay_, begin_, middle_, end_;
};

/// A memory of such states (Pace::steady) on its way along a motion, one step after the other.
template <class T, class Rate>
class SteadyMemory {
public:
    /// @param rate      rate(place, memory, out): writes the rate of a memory where the motion is, see MotionView
    /// @param place     of the motion from which it goes
    /// @param stride    values of the motion a step
    /// @param stepRate  Hz
    SteadyMemory(Rate rate, std::vector<T> start, std::size_t place, std::size_t stride, double stepRate)
        : memory(std::move(start)),
          rate_(std::move(rate)),
          stride_(static_cast<double>(stride)),
          none_(memory.size(), T(0.0)),
          begin_(memory.size()),
          middle_(memory.size()),
          end_(memory.size())
    {
        rate_(0.0, none_.data(), begin_.data());
        for (std::size_t k = 0; k < memory.size(); ++k) {
            auto one = none_;
            one[k] = T(1.0);
            rate_(0.0, one.data(), end_.data());
            rates.push_back(begin_[k] - end_[k]);
            states_.emplace_back(rates.back(), 1.0 / stepRate);
        }
        rate_(static_cast<double>(place), none_.data(), begin_.data());
    }

    /// One step on from that place of the motion.
    void advance(std::size_t place)
    {
        const auto from = static_cast<double>(place);
        rate_(from + 0.5 * stride_, none_.data(), middle_.data());
        rate_(from + stride_, none_.data(), end_.data());
        for (std::size_t k = 0; k < memory.size(); ++k)
            memory[k] = states_[k].after(memory[k], begin_[k], middle_[k], end_[k]);
        std::swap(begin_, end_);
    }

    std::vector<T> memory, rates;  ///< the rates r in 1/s

private:
    Rate rate_;
    double stride_;
    std::vector<T> none_, begin_, middle_, end_;
    std::vector<Relaxation<T>> states_;
};

}  // namespace excursion
