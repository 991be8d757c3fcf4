// SPDX-License-Identifier: GPL-3.0-or-later
#include "Study/Case.h"

#include "Bench/Draw.h"
#include "Engine/Diagnosis/FitEffects.h"
#include "Engine/Diagnosis/Improve.h"
#include "Engine/Document/JsonText.h"
#include "Engine/Estimate/MakeRecord.h"
#include "Engine/Loudspeaker/Laws.h"
#include "Engine/Take/TakeFile.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <complex>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>

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
    if (effect == "inductance-current")
        return speaker.inductanceAt(0.0, q);
    return std::numeric_limits<double>::quiet_NaN();
}

/// The same for a law that is told at a frequency, of coil and loops or of suspension and damper.
double truth(const bench::Loudspeaker& speaker, const LawCurve& law, double q)
{
    const double alone = truth(speaker, law.effectId, q);
    if (law.frequency == 0.0)
        return alone;
    const double omega = 2.0 * std::numbers::pi * law.frequency;
    const std::complex<double> s {0.0, omega};
    if (law.info.base == "K")
        return alone + speaker.suspensionStiffness(s).real() - speaker.K;
    if (law.info.base == "Rms")
        return alone + speaker.suspensionStiffness(s).imag() / omega;
    const bool move = speaker.eddyCurrents && speaker.eddyCurrents->moves && law.info.argument == "x";
    return alone + (move ? speaker.inductanceAt(q) / speaker.Le : 1.0) * speaker.eddyImpedance(s).imag() / omega;
}

std::vector<LawCoverage> coverage(const Model& model, const bench::Loudspeaker& speaker, const Outcome& outcome)
{
    std::vector<LawCoverage> result;
    for (const auto& law : laws(model)) {
        LawCoverage covered {law.effectId, outcome.hides(law.effectId)};
        for (std::size_t n = 0; n < law.argument.size(); ++n) {
            if (std::abs(law.argument[n]) > 0.9 * law.argument.back())
                continue;
            ++covered.points;
            const double error = std::abs(law.value[n] - truth(speaker, law, law.argument[n]));
            if (error <= law.halfWidth[n])
                ++covered.inside;
            covered.spread += std::pow(1.96 * error / law.halfWidth[n], 2);
        }
        covered.spread = std::sqrt(covered.spread / std::max(1, covered.points));
        result.push_back(covered);
    }
    return result;
}

/// Error over noise floor, dB, in the worst channel.
double overNoise(const Comparison& comparison)
{
    double worst = -std::numeric_limits<double>::infinity();
    for (const auto& channel : comparison.channels)
        worst = std::max(worst, channel.total.db
                                    - channel.total.noiseFloorDb.value_or(std::numeric_limits<double>::infinity()));
    return worst;
}

/// Of a take that was refused: how large the effect is, all the same.
double baseOverNoise(const Measurement& take, const FitOptions& options)
{
    auto record = makeRecord(take);
    const auto model = fitEffects(record, {}, options);
    return overNoise(compare(model, record));
}

/// What a loudspeaker plays without noise, by channel.
std::map<Quantity, std::vector<double>> played(const bench::Loudspeaker& speaker, bench::BenchSetup setup)
{
    setup.noiseDb = -std::numeric_limits<double>::infinity();
    setup.channelNoiseDb.clear();
    std::map<Quantity, std::vector<double>> result;
    for (const auto& channel : bench::measure(speaker, setup).channels)
        if (channel.quantity != Quantity::voltage)
            result[channel.quantity] = channel.samples;
    return result;
}

double power(const std::vector<double>& samples)
{
    return std::inner_product(samples.begin(), samples.end(), samples.begin(), 0.0);
}

/// What is missing without a part of the loudspeaker, in the channel that shows it best, over the noise.
double shownBy(const bench::Loudspeaker& lesser, const bench::Draw& drawn,
               const std::map<Quantity, std::vector<double>>& whole)
{
    const auto without = played(lesser, drawn.setup);
    double most = -std::numeric_limits<double>::infinity();
    for (const auto& [quantity, samples] : whole) {
        auto difference = without.at(quantity);
        for (std::size_t n = 0; n < samples.size(); ++n)
            difference[n] -= samples[n];
        most = std::max(most, 10.0 * std::log10(power(difference) / power(samples)) - drawn.setup.noiseDb);
    }
    return most;
}

/// The take, and what it hides.
void keep(const Outcome& outcome, const Measurement& take)
{
    const auto folder = outcome.what.keep / std::to_string(outcome.what.seed);
    std::filesystem::create_directories(folder);
    writeMeasurement(take, folder / "take");
    writeJson({{"hidden", outcome.what.hidden},
               {"strengths", outcome.strengths},
               {"showDb", outcome.showDb},
               {"driver", outcome.driver},
               {"noiseDb", outcome.noiseDb},
               {"oddity", outcome.what.oddity}},
              folder / "truth.json");
}

void improveAndJudge(Outcome& outcome)
{
    bench::DrawOptions options;
    options.seconds = outcome.what.seconds;
    options.channels = outcome.what.channels;
    options.oddity = outcome.what.oddity;
    options.hidden.emplace();
    for (const auto& id : outcome.what.hidden)
        options.hidden->push_back({id, 0.0});
    const auto drawn = bench::draw(outcome.what.seed, options);
    outcome.driver = drawn.driver;
    outcome.sampleRate = drawn.setup.sampleRate;
    outcome.noiseDb = drawn.setup.noiseDb;
    for (const auto& hidden : drawn.hidden)
        outcome.strengths.push_back(hidden.strength);
    if (!outcome.control()) {
        const auto whole = played(drawn.speaker, drawn.setup);
        for (const auto& id : outcome.what.hidden) {
            auto fewer = options;
            std::erase_if(*fewer.hidden, [&](const bench::HiddenEffect& h) { return h.id == id; });
            outcome.showDb.push_back(shownBy(bench::draw(outcome.what.seed, fewer).speaker, drawn, whole));
        }
    }
    if (outcome.odd()) {
        auto sane = drawn.speaker;
        sane.oddity.reset();
        outcome.oddityDb = shownBy(sane, drawn, played(drawn.speaker, drawn.setup));
    }
    const auto take = bench::measure(drawn.speaker, drawn.setup);
    for (const auto& channel : take.channels)
        if (channel.quantity != Quantity::voltage)
            outcome.channels.emplace_back(name(channel.quantity));
    if (!outcome.what.keep.empty())
        keep(outcome, take);
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
    for (std::size_t n = 1; n < ladder.rungs.size(); ++n) {
        const auto& added = ladder.rungs[n].added;
        outcome.added.push_back(added);
        const auto* named = ladder.rungs[n - 1].diagnosis.find(added);
        outcome.confidence.push_back(named ? named->confidence : 0.0);
    }
    const auto& base = ladder.rungs.front();
    if (base.diagnosis.verdict == Verdict::missingEffect)
        outcome.first = base.diagnosis.ranking.front().effect;
    outcome.standsDb = overNoise(base.comparison);
    outcome.finalDb = overNoise(ladder.rungs.back().comparison);
    outcome.laws = coverage(ladder.model(), drawn.speaker, outcome);
}

}  // namespace

bool Outcome::nothingAdded() const
{
    return failure.empty() && added.empty() && withdrawn.empty() && verdict != name(Verdict::badMeasurement);
}

std::string Outcome::kin() const
{
    return what.oddity == "contact" ? "stiffness" : what.oddity == "hysteresis" ? "friction" : "";
}

int Outcome::falselyAdded() const
{
    return static_cast<int>(std::count_if(added.begin(), added.end(), [&](const auto& id) { return !isThere(id); }));
}

bool Outcome::isThere(const std::string& effect) const { return hides(effect) || effect == kin(); }

bool Outcome::honest() const
{
    return failure.empty()
           && (verdict != name(Verdict::complete) || std::find(added.begin(), added.end(), kin()) != added.end());
}

bool Outcome::hides(const std::string& effect) const
{
    return std::find(what.hidden.begin(), what.hidden.end(), effect) != what.hidden.end();
}

bool Outcome::shows(std::size_t n) const { return showDb[n] >= standsOutDb; }

bool Outcome::explained() const
{
    if (control() && !odd())
        return nothingAdded();
    if (!failure.empty() || falselyAdded() > 0)
        return false;
    if (odd() && oddityDb >= standsOutDb && !honest())
        return false;
    for (std::size_t n = 0; n < what.hidden.size(); ++n)
        if ((!whole() || shows(n)) && std::find(added.begin(), added.end(), what.hidden[n]) == added.end())
            return false;
    return true;
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

}  // namespace excursion::study
