// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Predistortion/Cubic.h"
#include "Engine/Predistortion/LinearForm.h"

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

namespace excursion {

/// Current, position and velocity on one step.
struct MotionCubic {
    Cubic i, x, v;
};

/// The memories of all effects whose rates are linear, dm/dt = A m + b (i, x, v), in modal form. They are stepped along
/// a given motion in one pass. The step is exact for cubic motions,
///     m(1) = exp(A T) m(0) + sum_q sum_k G_qk c_qk,
/// no matter how fast the fastest state is.
///
/// Thread: after construction nothing allocates, locks or throws.
class LinearMemory {
public:
    /// One state or half of a pair of modes, dy/dt = [re im; -im re] y + ...
    struct Row {
        double decay = 0.0, turn = 0.0;                     ///< factors on itself and on the other half
        std::array<double, 12> byMotion {};                 ///< G: per coefficient of i, x and v
        double drop = 0.0, force = 0.0, forceByTime = 0.0;  ///< its contribution to each, per unit
    };
    /// One effect's memory.
    struct Block {
        std::vector<Row> pairs, singles;
        std::array<double, 3> forceByTime {};  ///< the direct contribution of i, x and v
        LinearRates rates;
    };

    /// A block that gives only the memory's contribution to the drop and to the force. Nothing if its modes are too
    /// nearly parallel.
    /// @param drop, force  per unit of each state of the memory
    static std::optional<Block> summed(const LinearRates&, const std::vector<double>& drop,
                                       const std::vector<double>& force, double sampleRate);
    /// A block whose states can be read one by one. Nothing if the states are coupled.
    static std::optional<Block> readable(const LinearRates&, double sampleRate);

    LinearMemory() = default;
    explicit LinearMemory(std::vector<Block>);

    void reset();

    struct Sums {
        double drop = 0.0;         ///< V
        double force = 0.0;        ///< N
        double forceByTime = 0.0;  ///< N/s
    };
    /// One step of 1/sampleRate.
    /// @returns the total contribution at the end of the step
    Sums step(const MotionCubic&);
    /// Undoes the latest step.
    void stepBack() { value_ = before_; }
    /// Goes by a share of the way to another memory of the same effects.
    void approach(const LinearMemory& other, double share);
    /// Corrects the current at the end of the step by this difference (A).
    void correct(double current);

    /// State k of a readable block, its rate, and d m(1) / d i(1) for a current that is a Cubic::past.
    double value(std::size_t block, std::size_t k) const { return value_[places_[block] + k]; }
    double rate(std::size_t block, std::size_t k) const;
    double byCurrent(std::size_t block, std::size_t k) const { return byCurrent_[places_[block] + k]; }
    /// d(sums)/d i(1), those of the drop and of the force.
    const Sums& sumsByCurrent() const { return sumsByCurrent_; }

private:
    std::vector<Block> blocks_;
    std::vector<std::size_t> places_;  ///< place of each block's first single state
    std::vector<double> laid_, byCurrent_, value_, before_;
    std::array<double, 3> forceByTime_ {}, end_ {};
    Sums sumsByCurrent_;
};

}  // namespace excursion
