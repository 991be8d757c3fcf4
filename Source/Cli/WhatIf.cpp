// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/KnownMotion.h"
#include "Cli/ModelTables.h"
#include "Cli/OpenTake.h"
#include "Cli/Terminal.h"
#include "Cli/Verbs.h"

#include "Engine/Design/WhatIfFile.h"
#include "Engine/Document/DocumentFormat.h"
#include "Engine/Document/Engineering.h"
#include "Engine/Error.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/ModelFile.h"
#include "Engine/Loudspeaker/Seen.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <memory>

namespace excursion::cli {
namespace {

struct WhatIfArguments {
    std::string model, take;
    KnownScale known;
};

/// "-31.2", or "<-100" where there is none to speak of.
std::string levelText(double db)
{
    constexpr double least = -100.0;
    return !std::isfinite(db) ? "-" : db < least ? "<" + fixed(least, 0) : fixed(db, 1);
}

/// A channel of each variant: even, odd, and what is gone without the effect.
void printChannel(const DistortionByEffect& distortion, std::size_t channel, Terminal& terminal)
{
    const auto& whole = distortion.whole[channel];
    std::vector<std::vector<std::string>> rows {
        {"as it is", levelText(whole.evenDb), levelText(whole.oddDb), fixed(whole.gainDb, 2), "", "", ""}};
    for (const auto& effect : distortion.effects) {
        const auto* without = effect.without.empty() ? nullptr : &effect.without[channel];
        const auto* alone = effect.alone.empty() ? nullptr : &effect.alone[channel];
        rows.push_back({"without " + effect.effect, without ? levelText(without->evenDb) : "-",
                        without ? levelText(without->oddDb) : "-", without ? fixed(without->gainDb, 2) : "-",
                        without ? fixed(fallWithout(distortion, effect, whole.quantity), 1) : "-",
                        alone ? levelText(alone->evenDb) : "", alone ? levelText(alone->oddDb) : ""});
    }
    terminal.say("");
    terminal.say(std::string(name(whole.quantity)) + ", distortion in dB of its power");
    terminal.table({"", "even dB", "odd dB", "gain dB", "falls by dB", "alone: even dB", "odd dB"}, rows);
}

void run(const WhatIfArguments& options, Terminal& terminal)
{
    const auto [model, motionIsGuessed, areaIsGuessed] = withKnown(readModel(options.model), options.known);
    const auto open = openTake(options.take);
    requireSameKind(model, seenIn(open.take.either()));
    if (open.take.asResponses())
        throw Error(Error::Kind::data,
                    "'" + options.take
                        + "' is a frequency response: it has no stimulus that could be played. Give a take or a plan.");
    const auto result = whatIf(model, recordFor(model, open), terminal.progress());
    terminal.say("Stimulus: the loudest of the take, " + significant(result.distortion.level, 3) + " "
                 + open.take.measurement().input().unit + " rms.");
    for (std::size_t c = 0; c < result.distortion.whole.size(); ++c)
        printChannel(result.distortion, c, terminal);
    terminal.say("Gain: the level against that of the linear part. Alone: the effect beside the linear ones only.");
    terminal.say("");
    terminal.say("Stroke, within the measured " + significant(1e3 * result.stroke.range, 3)
                 + " mm either way; impedance and Doppler shift at " + significant(result.stroke.tone, 3)
                 + " Hz, 8.5 times the resonance");
    printLimits(result.stroke, terminal);
    terminal.say("");
    terminal.say(wrapped(advice(result)));
    if (motionIsGuessed)
        terminal.say(wrapped(guessedMotion("Every length above")));
    nlohmann::ordered_json document = DocumentFormat {"excursion-whatif"}.with(
        {{"model", options.model}, {"take", options.take}});
    document.update(toJson(result));
    document["motionIsGuessed"] = motionIsGuessed;
    terminal.document(document);
}

}  // namespace

void addWhatIf(CLI::App& app, Terminal& terminal)
{
    const auto [verb, o] = addVerb<WhatIfArguments>(
        app, terminal, step::use, "whatif",
        "Which effect makes which distortion, how far the coil may go, and what to change", run);
    verb->add_option("MODEL", o->model, "the model, a .json")->required();
    verb->add_option("TAKE", o->take, "the loudest part of this take is played")->required();
    addMotionOptions(*verb, o->known);
}

}  // namespace excursion::cli
