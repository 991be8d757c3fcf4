// SPDX-License-Identifier: GPL-3.0-or-later
#include "Bench/Oddity.h"

#include "Bench/Random.h"
#include "Engine/Document/Words.h"
#include "Engine/Error.h"

#include <algorithm>
#include <cmath>

namespace excursion::bench {
const std::vector<std::string>& oddityNames()
{
    static const std::vector<std::string> names {"contact", "wander", "hysteresis", "jump"};
    return names;
}

Oddity drawOddity(const std::string& name, double strength, double stiffness, double visited, Random& random)
{
    const auto place = std::find(oddityNames().begin(), oddityNames().end(), name);
    if (place == oddityNames().end())
        throw Error(Error::Kind::usage,
                    "There is no oddity \"" + name + "\"; choose from " + joined(oddityNames()) + ".");
    Oddity oddity;
    oddity.kind = static_cast<Oddity::Kind>(place - oddityNames().begin());
    oddity.seed = static_cast<std::uint64_t>(random.index(1 << 30));
    const double force = strength * stiffness * visited;
    oddity.stiffness = stiffness;
    switch (oddity.kind) {
    case Oddity::Kind::contact:
        oddity.side = random.chance(0.5) ? 1.0 : -1.0;
        oddity.gap = visited * random.uniform(0.4, 0.8);
        oddity.stiffness = force / std::pow(visited - oddity.gap, 1.5);
        break;
    case Oddity::Kind::wander: oddity.depth = strength; break;
    case Oddity::Kind::hysteresis:
        oddity.limit = visited * random.logUniform(0.05, 0.4);
        oddity.exponent = random.uniform(1.5, 4.0);
        oddity.pinch = random.uniform(0.5, 0.9);
        oddity.stiffness = force / oddity.limit;
        break;
    case Oddity::Kind::jump: oddity.depth = strength * visited; break;
    }
    return oddity;
}

}  // namespace excursion::bench
