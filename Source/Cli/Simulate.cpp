// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/Destination.h"
#include "Cli/Terminal.h"
#include "Cli/Verbs.h"

#include "Engine/Document/TextFile.h"
#include "Engine/Driver/ModelFile.h"
#include "Engine/Driver/Simulate.h"
#include "Engine/Error.h"
#include "Engine/Measurement/TakeFile.h"
#include "Engine/Measurement/WavFile.h"
#include "Engine/Signal/Level.h"
#include "Plots/Engineering.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>

namespace excursion::cli {
namespace {

struct SimulateArguments {
    std::string model, input, out;
    double fullScale = 0.0;  ///< V or N; 0: not given
    SimulationOptions simulation;
};

/// What is played: samples of a WAV, or the input channel of a take or a plan, which brings its excitation along.
struct Played {
    double sampleRate = 0.0;
    Channel channel;
    std::optional<Excitation> excitation;
};

Played fromWav(const SimulateArguments& options, const Model& model)
{
    if (options.fullScale == 0.0)
        throw Error(Error::Kind::usage, std::string("A WAV has no unit: say with --full-scale how many ")
                                            + (model.electrical() ? "V at the loudspeaker" : "N")
                                            + " a sample of 1.0 stands for.");
    auto wav = readWav(options.input);
    if (wav.channels.size() != 1)
        throw Error(Error::Kind::input, "'" + options.input + "' has " + std::to_string(wav.channels.size())
                                            + " channels, expected one; keep the one that the loudspeaker is to play.");
    requireFinite(wav, 0, options.input);
    Played played;
    played.sampleRate = wav.sampleRate;
    played.channel.samples = std::move(wav.channels.front());
    for (double& sample : played.channel.samples)
        sample *= options.fullScale;
    played.channel.fullScale = options.fullScale;
    return played;
}

Played fromTake(const SimulateArguments& options, const Model& model)
{
    if (options.fullScale != 0.0)
        throw Error(Error::Kind::usage, "--full-scale is for a WAV; a take has its own.");
    const auto take = readMeasurement(options.input);
    const auto& input = take.input();
    if ((input.quantity == Quantity::voltage) != model.electrical())
        throw Error(Error::Kind::data, std::string("The model is driven by a ")
                                           + (model.electrical() ? "voltage" : "force") + ", but the take holds a "
                                           + std::string(name(input.quantity)) + ".");
    return {take.sampleRate, input, take.excitation};
}

/// How far the model is driven beyond what it was measured at; empty where all of it was.
std::string beyond(const Model& model, const Measurement& take)
{
    double range = 0.0;
    for (const auto& component : model.components)
        if (const auto law = component.effect->law(); law && law->argument == "x")
            range = std::max(range, component.extent.displacement);
    const auto* x = take.find(Quantity::displacement);
    const double peak = x ? peakOf(x->samples) : 0.0;
    if (range == 0.0 || peak <= 1.05 * range)
        return "";
    return "The cone moves " + significant(1e3 * peak, 3) + " mm, but the model was measured to "
           + significant(1e3 * range, 3) + " mm: beyond that its laws are a guess.";
}

void run(const SimulateArguments& options, Terminal& terminal)
{
    std::string reason;
    if (!options.simulation.isValid(&reason))
        throw Error(Error::Kind::usage, "The simulation cannot run: " + reason + ".");
    requireFolderPlace(options.out);
    const auto model = readModel(options.model);
    const auto played = endingOf(options.input) == ".wav" ? fromWav(options, model) : fromTake(options, model);
    SimulationSummary summary;
    auto take = simulate(model, played.channel.samples, played.sampleRate, options.simulation, &summary,
                         terminal.progress());
    take.channels.front().fullScale = std::max(played.channel.fullScale, peakOf(played.channel.samples));
    take.excitation = played.excitation;
    writeMeasurement(take, options.out);

    nlohmann::ordered_json document {{"format", "excursion-simulate"},
                                     {"version", 1},
                                     {"model", options.model},
                                     {"input", options.input},
                                     {"take", options.out},
                                     {"sampleRate", take.sampleRate},
                                     {"samples", take.length()},
                                     {"substeps", summary.substeps},
                                     {"accuracy", summary.accuracy},
                                     {"tolerance", options.simulation.tolerance},
                                     {"converged", summary.converged}};
    document["channels"] = nlohmann::ordered_json::array();
    std::vector<std::vector<std::string>> rows;
    for (const auto& channel : take.channels) {
        const double rms = rmsOf(channel.samples), peak = peakOf(channel.samples);
        const auto unit = displayUnit(peak, channel.unit);
        rows.push_back({std::string(name(channel.quantity)), significant(rms * unit.factor),
                        significant(peak * unit.factor), unit.unit});
        document["channels"].push_back({{"quantity", name(channel.quantity)},
                                        {"unit", channel.unit},
                                        {"rms", rms},
                                        {"peak", peak},
                                        {"fullScale", channel.fullScale}});
    }
    terminal.table({"channel", "rms", "peak", "unit"}, rows);
    terminal.say(std::to_string(summary.substeps) + (summary.substeps == 1 ? " step" : " steps")
                 + " a sample; half the step changes the result by "
                 + fixed(20.0 * std::log10(std::max(summary.accuracy, 1e-12)), 0) + " dB"
                 + (summary.converged ? "." : ", more than --tolerance allows."));
    if (const auto warning = beyond(model, take); !warning.empty()) {
        terminal.say(warning);
        document["warning"] = warning;
    }
    terminal.say("Wrote the take " + options.out + ": " + fixed(static_cast<double>(take.length()) / take.sampleRate, 2)
                 + " s at " + significant(take.sampleRate, 8) + " Hz.");
    terminal.document(document);
    if (!summary.converged)
        terminal.answer = 1;
}

}  // namespace

void addSimulate(CLI::App& app, Terminal& terminal)
{
    auto o = std::make_shared<SimulateArguments>();
    auto* verb = app.add_subcommand("simulate", "What the loudspeaker will do: every channel of the model, as a take")
                     ->group(step::use);
    verb->add_option("MODEL", o->model, "the model, a .json")->required();
    verb->add_option("IN", o->input,
                     "what is played: a .wav of one channel, or a take or plan, whose voltage is played")
        ->required();
    verb->add_option("--full-scale", o->fullScale,
                     "V at the loudspeaker for a WAV sample of 1.0 (N for a model without a coil)")
        ->check(CLI::PositiveNumber);
    verb->add_option("--tolerance", o->simulation.tolerance,
                     "largest relative change of any channel when the step is halved")
        ->capture_default_str();
    verb->add_option("--out", o->out, "folder of the take")->required()->type_name("DIR");
    verb->footer("Exit code 1: the take was written, but the tolerance was not reached.");
    verb->callback([o, &terminal] { run(*o, terminal); });
}

}  // namespace excursion::cli
