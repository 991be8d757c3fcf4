// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>

namespace excursion {

class Effect;

/// How warm a loudspeaker is, and how charged the amplifier before it: what is left of what they were played when all
/// that swings has come to rest. It outlives an engine, since they do.
struct Warmth {
    double heat = 0.0;                ///< W, running mean of the coil's heat
    std::array<double, 2> charge {};  ///< V, see CouplingFilter::charge()

    /// The memory of an effect that is slow (Effect::slow), by which a coil's resistance rises.
    struct Memory {
        const Effect* effect = nullptr;
        std::array<double, 4> value {};
    };
    std::array<Memory, 2> slow {};  ///< in the order of the model; more than the catalogue has

    /// The values of an effect; none if nothing is known of it.
    const Memory* of(const Effect& effect) const
    {
        for (const auto& memory : slow)
            if (memory.effect == &effect)
                return &memory;
        return nullptr;
    }
};

}  // namespace excursion
