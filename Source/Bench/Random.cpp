// SPDX-License-Identifier: GPL-3.0-or-later
#include "Bench/Random.h"

#include <cmath>
#include <numbers>

namespace excursion::bench {
namespace {

std::uint64_t splitMix(std::uint64_t z)
{
    z += 0x9E3779B97F4A7C15ull;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
    return z ^ (z >> 31);
}

}  // namespace

Random::Random(std::uint64_t seed, std::uint64_t stream) : words_(splitMix(splitMix(seed) + stream)) {}

double Random::uniform() { return (static_cast<double>(words_() >> 11) + 0.5) * 0x1p-53; }

double Random::uniform(double low, double high) { return low + (high - low) * uniform(); }

double Random::logUniform(double low, double high) { return low * std::exp(std::log(high / low) * uniform()); }

double Random::normal()
{
    if (hasSpare_) {
        hasSpare_ = false;
        return spare_;
    }
    const double radius = std::sqrt(-2.0 * std::log(uniform()));
    const double angle = 2.0 * std::numbers::pi * uniform();
    spare_ = radius * std::sin(angle);
    hasSpare_ = true;
    return radius * std::cos(angle);
}

int Random::index(int count) { return static_cast<int>(uniform() * count); }

}  // namespace excursion::bench
