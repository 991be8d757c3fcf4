// SPDX-License-Identifier: GPL-3.0-or-later
#include "Study/Case.h"

#include "Bench/Draw.h"
#include "Engine/Diagnosis/FitEffects.h"
#include "Engine/Diagnosis/Improve.h"

#include <chrono>
#include <cmath>
#include <limits>

namespace excursion::study {
namespace {

double truth(const bench::Loudspeaker& speaker, const std::string& effect, double q)
{
    if (effect == "force-factor")
        return speaker.forceFactorAt(q);
    if (effect == "stiffness")
        return speaker.stiffnessAt(q);
    if (effect == "inductance-position")
        return speaker.inductanceAt(q);
    if (effect == "damping-velocity")
        return speaker.dampingAt(q);
    return std::numeric_limits<double>::quiet_NaN();
}

std::vector<LawCoverage> coverage(const Model& model, const bench::Loudspeaker& speaker, const std::string& hidden)
{
    std::vector<LawCoverage> result;
    for (const auto& law : laws(model)) {
        LawCoverage covered {law.effectId, law.effectId == hidden, 0, 0};
        for (std::size_t n = 0; n < law.argument.size(); ++n) {
            if (std::abs(law.argument[n]) > 0.9 * law.argument.back())
                continue;
            ++covered.points;
            if (std::abs(law.value[n] - truth(speaker, law.effectId, law.argument[n])) <= law.halfWidth[n])
                ++covered.inside;
        }
        result.push_back(covered);
    }
    return result;
}

/// Error over noise floor, dB, in the worst channel.
double overNoise(const Comparison& comparison)
{
    double worst = -std::numeric_limits<double>::infinity();
    for (const auto& channel : comparison.channels)
        worst = std::max(worst, channel.total.db - channel.total.noiseFloorDb.value_or(std::numeric_limits<double>::infinity()));
    return worst;
}

/// Of a take that was refused: how large the effect is, all the same.
double baseOverNoise(const Measurement& take, const FitOptions& options)
{
    auto record = makeRecord(take);
    const auto model = fitEffects(record, {}, options);
    return overNoise(compare(model, record));
}

void improveAndJudge(Outcome& outcome)
{
    bench::DrawOptions options;
    options.seconds = outcome.what.seconds;
    options.hidden.emplace();
    if (!outcome.control())
        options.hidden->push_back({outcome.what.hidden, 0.0});
    const auto drawn = bench::draw(outcome.what.seed, options);
    outcome.driver = drawn.driver;
    outcome.sampleRate = drawn.setup.sampleRate;
    outcome.noiseDb = drawn.setup.noiseDb;
    outcome.strength = drawn.hidden.empty() ? 0.0 : drawn.hidden.front().strength;
    const auto take = bench::measure(drawn.speaker, drawn.setup);
    outcome.takeSeconds = static_cast<double>(take.length()) / take.sampleRate;

    ImproveOptions improvement;
    improvement.diagnose.fit.threads = outcome.what.threads;
    const auto begin = std::chrono::steady_clock::now();
    const auto ladder = improve(take, improvement);
    outcome.improveSeconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();

    outcome.verdict = name(ladder.verdict);
    outcome.withdrawn = ladder.withdrawn;
    if (ladder.rungs.empty()) {
        outcome.standsDb = outcome.finalDb = baseOverNoise(take, improvement.diagnose.fit);
        return;
    }
    for (const auto& rung : ladder.rungs)
        if (!rung.added.empty())
            outcome.added.push_back(rung.added);
    const auto& base = ladder.rungs.front();
    if (base.diagnosis.verdict == Verdict::missingEffect)
        outcome.first = base.diagnosis.ranking.front().effect;
    outcome.standsDb = overNoise(base.comparison);
    outcome.finalDb = overNoise(ladder.rungs.back().comparison);
    outcome.laws = coverage(ladder.model(), drawn.speaker, outcome.what.hidden);
}

} // namespace

bool Outcome::nothingAdded() const
{
    return failure.empty() && added.empty() && withdrawn.empty() && verdict != name(Verdict::badMeasurement);
}

bool Outcome::explained() const
{
    return control() ? nothingAdded() : failure.empty() && added == std::vector {what.hidden};
}

Outcome run(const Case& what)
{
    Outcome outcome;
    outcome.what = what;
    outcome.standsDb = outcome.finalDb = std::numeric_limits<double>::infinity();
    try {
        improveAndJudge(outcome);
    } catch (const std::exception& error) {
        outcome.failure = error.what();
    }
    return outcome;
}

} // namespace excursion::study
