// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <random>

namespace excursion::bench {

/// Random numbers that are the same on every machine. The standard fixes the raw 64-bit words of std::mt19937_64, but
/// not the distributions of <random>, so they are implemented here. Streams of one seed are independent (the pair is
/// mixed by SplitMix64).
class Random {
public:
    explicit Random(std::uint64_t seed, std::uint64_t stream = 0);

    double uniform();  ///< in (0, 1), 53 bits
    double uniform(double low, double high);
    double logUniform(double low, double high);  ///< 0 < low <= high
    double normal();                             ///< mean 0, variance 1 (Box-Muller)
    int index(int count);                        ///< 0 .. count - 1
    bool chance(double probability) { return uniform() < probability; }

private:
    std::mt19937_64 words_;
    double spare_ = 0.0;
    bool hasSpare_ = false;
};

}  // namespace excursion::bench
