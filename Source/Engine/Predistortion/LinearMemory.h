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

/// The memories of all effects whose rates are linear, dm/dt = A m + b (i, x, v), side by side and as modes: they are
/// carried along a given motion in one pass. The step is exact for cubic motions,
///     m(1) = exp(A T) m(0) + sum_q sum_k G_qk c_qk,
/// however fast the fastest state.
///
/// Thread: after construction nothing allocates, locks or throws.
class LinearMemory {
public:
    /// One state or half of a pair of modes, dy/dt = [re im; -im re] y + ...
    struct Row {
        double decay = 0.0, turn = 0.0;                     ///< what it takes of itself and of the other half
        std::array<double, 12> byMotion {};                 ///< G: by the coefficients of i, x and v
        double drop = 0.0, force = 0.0, forceByTime = 0.0;  ///< what is added to each per unit of it
    };
    /// One effect's memory.
    struct Block {
        std::vector<Row> pairs, singles;
        std::array<double, 3> forceByTime {};  ///< what i, x and v add to it by themselves
        LinearRates rates;
    };

    /// What the memory adds to the drop and to the force is all that is asked of it. Nothing where its modes are too
    /// nearly parallel.
    /// @param drop, force  per unit of each state of the memory
    static std::optional<Block> summed(const LinearRates&, const std::vector<double>& drop,
                                       const std::vector<double>& force, double sampleRate);
    /// Its states are to be read one by one. Nothing where they move one another.
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
    /// @returns what all of it adds at the end of the step
    Sums step(const MotionCubic&);
    /// Takes the latest step back.
    void stepBack() { value_ = before_; }
    /// The end of the current on the step was different by that much (A).
    void correct(double current);

    /// The state k of a block that is readable, its rate, and d m(1) / d i(1) of a current that is a Cubic::past.
    double value(std::size_t block, std::size_t k) const { return value_[places_[block] + k]; }
    double rate(std::size_t block, std::size_t k) const;
    double byCurrent(std::size_t block, std::size_t k) const { return byCurrent_[places_[block] + k]; }
    /// d(sums)/d i(1), those of the drop and of the force.
    const Sums& sumsByCurrent() const { return sumsByCurrent_; }

private:
    std::vector<Block> blocks_;
    std::vector<std::size_t> places_;  ///< of each block's first single state
    std::vector<double> laid_, byCurrent_, value_, before_;
    std::array<double, 3> forceByTime_ {}, end_ {};
    Sums sumsByCurrent_;
};

}  // namespace excursion
