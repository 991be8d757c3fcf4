// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/Destination.h"
#include "Cli/Terminal.h"
#include "Cli/Verbs.h"
#include "Engine/Document/DocumentFormat.h"
#include "Engine/Import/ReadTake.h"

#include "Bench/Bench.h"
#include "Bench/Draw.h"
#include "Bench/Truth.h"
#include "Engine/Document/DraftFile.h"
#include "Engine/Document/Words.h"
#include "Engine/Error.h"
#include "Engine/Signal/Level.h"
#include "Engine/Take/SweepTake.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <charconv>
#include <memory>

namespace excursion::cli {
namespace {

struct VirtualArguments {
    std::uint64_t seed = 1;
    std::vector<std::string> hidden, channels;
    std::string driver, plan, out, truth;
    double noise = 0.0, rate = 0.0, seconds = 12.0;
    bool hasHidden = false, hasNoise = false;
};

// "stiffness", "stiffness:0.3", or "none"
std::vector<bench::HiddenEffect> effectsOf(const std::vector<std::string>& texts)
{
    std::vector<bench::HiddenEffect> effects;
    for (const auto& text : texts) {
        if (text == "none" && texts.size() == 1)
            return {};
        bench::HiddenEffect effect {text.substr(0, text.find(':')), 0.0};
        if (const auto colon = text.find(':'); colon != std::string::npos) {
            const char *first = text.data() + colon + 1, *last = text.data() + text.size();
            const auto [end, error] = std::from_chars(first, last, effect.strength);
            if (error != std::errc() || end != last || !(effect.strength >= 0.01 && effect.strength <= 0.8))
                throw Error(Error::Kind::usage,
                            "\"" + text
                                + "\" does not name an effect and a strength between 0.01 and 0.8, such as "
                                  "stiffness:0.3.");
        }
        effects.push_back(effect);
    }
    return effects;
}

std::vector<Quantity> channelsOf(const std::vector<std::string>& names)
{
    std::vector<Quantity> channels;
    for (const auto& text : names) {
        const auto quantity = quantityNamed(text);
        if (!quantity || *quantity == Quantity::force)
            throw Error(Error::Kind::usage,
                        "The virtual bench has no channel \"" + text
                            + "\"; choose from voltage, current, displacement, velocity, acceleration and pressure.");
        if (std::find(channels.begin(), channels.end(), *quantity) == channels.end())
            channels.push_back(*quantity);
    }
    if (std::find(channels.begin(), channels.end(), Quantity::voltage) == channels.end())
        channels.insert(channels.begin(), Quantity::voltage);
    return channels;
}

bench::DrawOptions drawOptions(const VirtualArguments& options)
{
    bench::DrawOptions draw;
    if (!options.driver.empty())
        draw.driver = options.driver;
    if (options.hasHidden)
        draw.hidden = effectsOf(options.hidden);
    if (!options.channels.empty())
        draw.channels = channelsOf(options.channels);
    if (options.hasNoise)
        draw.noiseDb = options.noise;
    if (options.rate != 0.0) {
        if (!(options.rate >= 32000.0 && options.rate <= 192000.0))
            throw Error(Error::Kind::usage, "--rate must lie between 32000 and 192000 Hz.");
        draw.sampleRate = options.rate;
    }
    draw.seconds = options.seconds;
    return draw;
}

/// What the loudspeaker does with a plan, whatever it is, in its own volts: the drawn excitation is left aside.
SweepTake played(const VirtualArguments& options, const bench::Draw& drawn, Terminal& terminal)
{
    const auto plan = readSweepTake(options.plan);
    if (plan.take.input().quantity != Quantity::voltage)
        throw Error(Error::Kind::data, "The virtual loudspeaker plays a voltage, but the plan holds none.");
    SweepTake result;
    result.sweep = plan.sweep;
    result.take = bench::play(drawn.speaker, plan.take.input().samples, plan.take.sampleRate, drawn.setup.channels,
                              drawn.setup.microphoneDistance, terminal.progress());
    result.take.excitation = plan.take.excitation;
    // The noise goes by the loudest level, as the bench's own does.
    const auto& levels = plan.sweep             ? plan.sweep->levels
                         : plan.take.excitation ? plan.take.excitation->levels
                                                : std::vector<double> {1.0};
    const auto part = result.take.length() / levels.size();
    for (auto& channel : result.take.channels) {
        const double rms = rmsOf(std::span(channel.samples).subspan((levels.size() - 1) * part, part));
        bench::Random hiss(options.seed, 1000 + static_cast<std::uint64_t>(channel.quantity));
        bench::sense(channel, result.take.sampleRate, rms, drawn.setup.noiseDb, drawn.setup.noiseColour, {}, hiss);
    }
    return result;
}

void run(const VirtualArguments& options, Terminal& terminal)
{
    requireFolderPlace(options.out);
    if (!options.truth.empty())
        requireFilePlace(options.truth);
    const auto drawn = bench::draw(options.seed, drawOptions(options));
    const auto measured = options.plan.empty()
                              ? SweepTake {bench::measure(drawn.speaker, drawn.setup, terminal.progress()), {}}
                              : played(options, drawn, terminal);
    const auto& take = measured.take;
    writeSweepTake(measured, options.out);
    if (!options.truth.empty())
        publish(options.truth, bench::truthOf(drawn).dump(2) + "\n");

    nlohmann::ordered_json document = DocumentFormat {"excursion-virtual"}.with(
        {{"take", options.out},
         {"seed", options.seed},
         {"driver", drawn.driver},
         {"sampleRate", take.sampleRate},
         {"seconds", static_cast<double>(take.length()) / take.sampleRate}});
    if (options.plan.empty())
        document["period"] = take.excitation->period;
    else
        document["plan"] = options.plan;
    const auto levels = measured.sweep    ? measured.sweep->levels
                        : take.excitation ? take.excitation->levels
                                          : std::vector<double> {rmsOf(take.input().samples)};
    document["levels"] = levels;
    for (const auto& channel : take.channels)
        document["channels"].push_back(name(channel.quantity));
    terminal.document(document);

    const auto channels = joined(take.channels,
                                 [&](const auto& channel) { return std::string(name(channel.quantity)); });
    terminal.say(options.out + ": " + fixed(static_cast<double>(take.length()) / take.sampleRate, 1)
                 + " s of a virtual " + drawn.driver + " at " + fixed(take.sampleRate, 0) + " Hz (" + channels
                 + "), up to " + significant(levels.back(), 3) + " V rms.");
    if (!options.truth.empty())
        terminal.say("What was hidden is in " + options.truth + ".");
}

}  // namespace

void addVirtual(CLI::App& app, Terminal& terminal)
{
    auto options = std::make_shared<VirtualArguments>();
    auto* verb = app.add_subcommand("virtual", "Measure a virtual loudspeaker that has something hidden in it")
                     ->group(step::measure);
    verb->add_option("--seed", options->seed, "seed of all that is drawn, noise included")->required();
    auto* hidden = verb->add_option("--hidden", options->hidden,
                                    "effects to hide, each with an optional strength (stiffness:0.3), or none; by "
                                    "default one is drawn and not revealed")
                       ->delimiter(',');
    verb->add_option("--driver", options->driver, "micro, midrange, midbass, woofer, subwoofer or seed");
    auto* noise = verb->add_option("--noise", options->noise, "sensor noise in dB against the loudest level")
                      ->check(CLI::Range(-200.0, 0.0));
    auto* plan = verb->add_option("--plan", options->plan,
                                  "the plan to play, at its own voltages, in place of multisines that suit the "
                                  "loudspeaker: a folder from excursion excite")
                     ->type_name("DIR");
    verb->add_option("--rate", options->rate, "sample rate in Hz")->excludes(plan);
    verb->add_option("--seconds", options->seconds,
                     "length of the take, about; at least what three realizations at each level need")
        ->check(CLI::Range(1.0, 120.0))
        ->excludes(plan);
    verb->add_option("--channels", options->channels, "what is recorded besides the voltage")->delimiter(',');
    verb->add_option("--out", options->out, "folder of the take")->required()->type_name("DIR");
    verb->add_option("--truth", options->truth, "JSON file that tells what was hidden")->type_name("FILE");
    verb->callback([options, hidden, noise, &terminal] {
        options->hasHidden = hidden->count() > 0;
        options->hasNoise = noise->count() > 0;
        run(*options, terminal);
    });
}

}  // namespace excursion::cli
