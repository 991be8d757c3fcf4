// SPDX-License-Identifier: GPL-3.0-or-later
// Slopes of laws along a motion: on every second sample, against all of them.
#include "Engine/Loudspeaker/LawDrive.h"
#include "EffectBench.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

using namespace excursion;

namespace {

constexpr double fedRate = 48000.0;
constexpr std::size_t samples = 4800, lines = 300;  // of 10 Hz: room for every second sample

/// Bass and a tone at the upper end of the compared lines.
ShownMotion someMotion(const OperatingRange& e)
{
    ShownMotion motion;
    for (std::size_t n = 0; n < ShownMotion::fine * samples; ++n) {
        const double t = static_cast<double>(n) / (ShownMotion::fine * fedRate), bass = 2.0 * std::numbers::pi * 40.0,
                     treble = 2.0 * std::numbers::pi * 1310.0;
        motion.x.push_back(0.8 * e.displacement * std::sin(bass * t));
        motion.v.push_back(0.8 * e.displacement * bass * std::cos(bass * t));
        motion.a.push_back(-0.8 * e.displacement * bass * bass * std::sin(bass * t));
        motion.i.push_back(e.current * (0.5 * std::cos(bass * t) + 0.3 * std::sin(treble * t)));
        motion.slope.push_back(e.current * (-0.5 * bass * std::sin(bass * t) + 0.3 * treble * std::cos(treble * t)));
    }
    return motion;
}

}  // namespace

TEST_CASE("Slopes on every second sample are those of all samples", "[law-drive]")
{
    for (const auto* effect : catalogue()) {
        if (effect->linear() || effect->emits() || effect->slow())
            continue;
        for (const bool relaxed : {false, true}) {
            INFO(effect->id() << (relaxed ? ", beside relaxations" : ""));
            auto range = someOperatingRange(someScale(*effect));
            range.lowFrequency = 40.0;
            range.highFrequency = 1500.0;
            range.relaxed = relaxed;
            auto model = withEffect(makeModel("electrodynamic"), *effect, range);
            auto& law = model.components.back();
            double sign = 1.0;
            for (auto& p : law.parameters)
                if (p.strength)
                    p.value = strengthOf(*effect, p, range, p.lower == 0.0 ? 0.3 : 0.1 * (sign *= -1.0));
            const auto motion = someMotion(range);
            MemoryStart rest;
            const auto size = effect->memorySize(law.operatingRange);
            rest.value = Eigen::VectorXd::Zero(size);
            rest.gradient = Eigen::MatrixXd::Zero(size, static_cast<Eigen::Index>(law.parameters.size()));
            const std::vector<bool> all(law.parameters.size(), true);
            const auto few = driveOf(law, motion, rest, fedRate, all, lines).slopes,
                       every = driveOf(law, motion, rest, fedRate, all, samples / 2 + 1).slopes;
            REQUIRE((few && every));
            int compared = 0;
            for (std::size_t k = 0; k < all.size(); ++k)
                for (const auto part : {&LawSlopes::voltage, &LawSlopes::force}) {
                    const auto &a = ((*few).*part)[k], &b = ((*every).*part)[k];
                    REQUIRE(a.empty() == b.empty());
                    if (a.empty())
                        continue;
                    REQUIRE(a.size() == lines);
                    double apart = 0.0, total = 0.0;
                    for (std::size_t n = 0; n < lines; ++n) {
                        apart += std::norm(a[n] - b[n]);
                        total += std::norm(b[n]);
                    }
                    INFO("parameter " << law.parameters[k].name);
                    CHECK(apart <= 1e-4 * total);  // 1 %
                    ++compared;
                }
            CHECK(compared > 0);
        }
    }
}
