// SPDX-License-Identifier: GPL-3.0-or-later
// Recordings with random faults become takes whose time is right, or are refused for the right reason.
#include "Engine/Check/TakeCheck.h"
#include "Import/PlayedRecording.h"

#include <algorithm>
#include <cmath>
#include <iostream>

using namespace excursion;
using namespace excursion::test;
using Kind = Error::Kind;

namespace {

/// What one random recording came to.
struct Outcome {
    std::string fault, told;
    double error = -1.0;  ///< samples; below 0: refused
    bool right = false;
};

Outcome randomRecording(std::uint64_t seed, const std::vector<const Played*>& plays, const Scratch& scratch)
{
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    const auto& played = *plays[random() % plays.size()];
    const bool swapped = uniform(random) < 0.2, inverted = uniform(random) < 0.2;
    auto r = recorder(swapped ? std::vector<std::size_t> {1, 0, 2, 3} : std::vector<std::size_t> {0, 1, 2, 3});
    r.fullScale = {20.0, 10.0, 0.01, 20.0};
    if (swapped)
        std::swap(r.fullScale[0], r.fullScale[1]);
    static constexpr double rates[] {44100, 48000, 48000, 88200, 96000};
    r.sampleRate = rates[random() % 5];
    r.ppm = uniform(random) < 0.2 ? 0.0 : 400 * uniform(random) - 200;
    r.lead = 0.05 + 29.95 * uniform(random) * uniform(random);
    r.tail = 0.02 + 5 * uniform(random) * uniform(random);
    r.noise = std::pow(10.0, -5 + 2 * uniform(random));
    r.bits = uniform(random) < 0.4 ? 16 : 24;
    r.seed = seed;
    for (auto& scale : r.fullScale)
        scale *= 1 + 0.1 * (uniform(random) - 0.5);
    if (inverted)
        r.fullScale[random() % 4] *= -1;
    Outcome outcome;
    std::string expected;
    const double length = static_cast<double>(played.plan.length()) / played.plan.sampleRate;
    switch (random() % 12) {
    case 0:
        outcome.fault = "block lost";
        r.drop = 1 << (random() % 11);
        r.dropAt = r.lead + length * (0.2 + 0.6 * uniform(random));
        expected = "samples near";
        break;
    case 1:
        outcome.fault = "begins late";
        r.lead = -length * (0.1 + 0.4 * uniform(random));
        expected = "start the recorder before the player";
        break;
    case 2:
        outcome.fault = "ends early";
        r.tail = -length * (0.05 + 0.5 * uniform(random));
        break;
    default: break;
    }
    auto recorded = record(played, r);
    const auto file = save(scratch, "random.wav", recorded);
    try {
        const auto imported = importRecording(
            optionsFor(played, {file}, {"1=voltage:20", "2=current:10", "3=displacement:10mm", "4=pressure:20"}));
        outcome.error = clockError(imported.files[0].alignment, recorded, imported.take);
        outcome.told = imported.remarks.empty() ? "" : imported.remarks.front();
        outcome.right = expected.empty() && outcome.error < 0.02
                        && (outcome.fault.empty() || imported.take.length() < played.plan.length());
    } catch (const Error& e) {
        outcome.told = e.what();
        outcome.right = !expected.empty() && outcome.told.find(expected) != std::string::npos;
    }
    outcome.fault += (swapped ? " swapped" : "") + std::string(inverted ? " inverted" : "") + " rate "
                     + std::to_string(r.sampleRate) + " ppm " + std::to_string(r.ppm) + " bits "
                     + std::to_string(r.bits) + " lead " + std::to_string(r.lead);
    return outcome;
}

void randomRecordings(std::uint64_t from, std::uint64_t to, const std::vector<const Played*>& plays, bool tell)
{
    const Scratch scratch;
    double worst = 0.0;
    int aligned = 0, refusals = 0;
    for (auto seed = from; seed < to; ++seed) {
        const auto outcome = randomRecording(seed, plays, scratch);
        INFO("seed " << seed << ": " << outcome.fault << "; error " << outcome.error << " samples; " << outcome.told);
        CHECK(outcome.right);
        if (tell)
            std::cout << seed << (outcome.right ? " right " : " WRONG ") << outcome.error << " | " << outcome.fault
                      << " | " << outcome.told << "\n";
        worst = std::max(worst, outcome.error);
        (outcome.error >= 0 ? aligned : refusals) += 1;
    }
    if (tell)
        std::cout << aligned << " aligned, the worst within " << worst << " samples; " << refusals << " refused\n";
}

}  // namespace

TEST_CASE("Random faults: a few", "[import][slow]") { randomRecordings(1, 6, {&smallPlay()}, false); }

TEST_CASE("Random faults: sixty, on plans of several lengths", "[.recordings]")
{
    PlayedOptions wide, bass;
    wide.bandHigh = 20000;
    wide.period = 16384;
    wide.realizations = 3;
    wide.seed = 5;
    bass.bandLow = 10;
    bass.bandHigh = 500;
    bass.period = 32768;
    bass.levels = {0.5, 1.5};
    bass.seed = 8;
    const auto second = play(wide), third = play(bass);
    randomRecordings(100, 160, {&smallPlay(), &second, &third}, true);
}
