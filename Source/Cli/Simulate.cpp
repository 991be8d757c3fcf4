// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/Destination.h"
#include "Cli/KnownMotion.h"
#include "Cli/Terminal.h"
#include "Cli/Verbs.h"
#include "Engine/Document/DocumentFormat.h"
#include "Engine/Import/ReadTake.h"

#include "Engine/BlackBox/ModelDocument.h"
#include "Engine/Document/Engineering.h"
#include "Engine/Document/TextFile.h"
#include "Engine/Error.h"
#include "Engine/Loudspeaker/ModelFile.h"
#include "Engine/Loudspeaker/Simulate.h"
#include "Engine/Signal/Level.h"
#include "Engine/Take/SweepTake.h"
#include "Engine/Take/WavFile.h"

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
    KnownScale known;
};

/// What is played: samples of a WAV, or the input channel of a take or a plan, which brings its excitation along.
struct Played {
    double sampleRate = 0.0;
    Channel channel;
    std::optional<Excitation> excitation;
    std::optional<SweepExcitation> sweep;
};

/// @param electrical  whether the model is driven by a voltage
Played fromWav(const SimulateArguments& options, bool electrical)
{
    if (options.fullScale == 0.0)
        throw Error(Error::Kind::usage, std::string("A WAV has no unit: say with --full-scale how many ")
                                            + (electrical ? "V at the loudspeaker" : "N")
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

Played fromTake(const SimulateArguments& options, bool electrical)
{
    if (options.fullScale != 0.0)
        throw Error(Error::Kind::usage, "--full-scale is for a WAV; a take has its own.");
    const auto [take, sweep] = readSweepTake(options.input);
    const auto& input = take.input();
    if ((input.quantity == Quantity::voltage) != electrical)
        throw Error(Error::Kind::data, std::string("The model is driven by a ") + (electrical ? "voltage" : "force")
                                           + ", but the take holds a " + std::string(name(input.quantity)) + ".");
    return {take.sampleRate, input, take.excitation, sweep};
}

Played played(const SimulateArguments& options, bool electrical)
{
    return endingOf(options.input) == ".wav" ? fromWav(options, electrical) : fromTake(options, electrical);
}

/// One row and one object a channel of what was simulated.
nlohmann::ordered_json tellChannels(const Measurement& take, Terminal& terminal)
{
    auto channels = nlohmann::ordered_json::array();
    std::vector<std::vector<std::string>> rows;
    for (const auto& channel : take.channels) {
        const double rms = rmsOf(channel.samples), peak = peakOf(channel.samples);
        const auto unit = displayUnit(peak, channel.unit);
        rows.push_back({std::string(name(channel.quantity)), significant(rms * unit.factor),
                        significant(peak * unit.factor), unit.unit});
        channels.push_back({{"quantity", name(channel.quantity)},
                            {"unit", channel.unit},
                            {"rms", rms},
                            {"peak", peak},
                            {"fullScale", channel.fullScale}});
    }
    terminal.table({"channel", "rms", "peak", "unit"}, rows);
    return channels;
}

void sayTake(const SimulateArguments& options, const Measurement& take, Terminal& terminal)
{
    terminal.say("Wrote the take " + options.out + ": " + fixed(static_cast<double>(take.length()) / take.sampleRate, 2)
                 + " s at " + significant(take.sampleRate, 8) + " Hz.");
}

/// A model that knows no physics: its one output for its one input, at the rate that it was identified at.
void runDocument(const SimulateArguments& options, const ModelDocument& model, Terminal& terminal)
{
    const auto input = quantityNamed(model.input), output = quantityNamed(model.output);
    if (!input || !output || (*input != Quantity::voltage && *input != Quantity::force))
        throw Error(Error::Kind::data, "'" + options.model + "' makes a " + model.output + " of a " + model.input
                                           + "; what a voltage or a force makes is played.");
    const auto given = played(options, *input == Quantity::voltage);
    if (model.sampleRate > 0.0 && std::abs(given.sampleRate - model.sampleRate) > 1e-6 * model.sampleRate)
        throw Error(Error::Kind::data, "'" + options.model + "' plays at " + significant(model.sampleRate, 8)
                                           + " Hz, but '" + options.input + "' is sampled at "
                                           + significant(given.sampleRate, 8) + " Hz; resample it, or identify the "
                                           + "model at that rate.");
    const auto& u = given.channel.samples;
    const Eigen::MatrixXd y = simulate(
        model, Eigen::Map<const Eigen::VectorXd>(u.data(), static_cast<Eigen::Index>(u.size())), given.sampleRate);
    if (!y.allFinite())
        throw Error(Error::Kind::numerical, "The model runs away with this input.");
    SweepTake result;
    auto& take = result.take;
    take.sampleRate = given.sampleRate;
    take.excitation = given.excitation;
    result.sweep = given.sweep;
    take.channels.push_back(given.channel);
    take.channels.front().fullScale = std::max(given.channel.fullScale, peakOf(u));
    Channel channel;
    channel.quantity = *output;
    channel.unit = siUnit(*output);
    channel.samples.assign(y.data(), y.data() + y.rows());
    if (const double peak = peakOf(channel.samples); peak > 0.0)
        channel.fullScale = peak;
    take.channels.push_back(std::move(channel));
    writeSweepTake(result, options.out);
    nlohmann::ordered_json document = DocumentFormat {"excursion-simulate"}.with({{"model", options.model},
                                                                                  {"input", options.input},
                                                                                  {"take", options.out},
                                                                                  {"sampleRate", take.sampleRate},
                                                                                  {"samples", take.length()}});
    document["channels"] = tellChannels(take, terminal);
    sayTake(options, take, terminal);
    terminal.document(document);
}

/// How far the model is driven beyond what it was measured at; empty where all of it was.
std::string beyond(const Model& model, bool motionIsGuessed, const Measurement& take)
{
    double range = 0.0;
    for (const auto& component : model.components)
        if (const auto law = component.effect->law(); law && law->argument == "x")
            range = std::max(range, component.operatingRange.displacement);
    const auto* x = take.find(Quantity::displacement);
    const double peak = x ? peakOf(x->samples) : 0.0;
    if (range == 0.0 || peak <= 1.05 * range)
        return "";
    if (motionIsGuessed)
        return "The cone moves " + significant(peak / range, 3)
               + " times as far as the model was measured: beyond that its laws are a guess.";
    return "The cone moves " + significant(1e3 * peak, 3) + " mm, but the model was measured to "
           + significant(1e3 * range, 3) + " mm: beyond that its laws are a guess.";
}

void run(const SimulateArguments& options, Terminal& terminal)
{
    std::string reason;
    if (!options.simulation.isValid(&reason))
        throw Error(Error::Kind::usage, "The simulation cannot run: " + reason + ".");
    requireFolderPlace(options.out);
    const auto source = readJson(options.model);
    const JsonField field(source, "", options.model);
    if (isModelDocument(field)) {
        if (options.known.mass || options.known.forceFactor)
            throw Error(Error::Kind::usage, "--mass and --bl are of a driver; this model knows no physics.");
        return runDocument(options, modelDocumentFrom(field), terminal);
    }
    const auto [model, motionIsGuessed, areaIsGuessed] = withKnown(modelFromJson(field), options.known);
    const auto given = played(options, model.electrical());
    SimulationSummary summary;
    auto take = simulate(model, given.channel.samples, given.sampleRate, options.simulation, &summary,
                         terminal.progress());
    take.channels.front().fullScale = std::max(given.channel.fullScale, peakOf(given.channel.samples));
    take.excitation = given.excitation;
    writeSweepTake({take, given.sweep}, options.out);

    nlohmann::ordered_json document = DocumentFormat {"excursion-simulate"}.with(
        {{"model", options.model},
         {"input", options.input},
         {"take", options.out},
         {"sampleRate", take.sampleRate},
         {"samples", take.length()},
         {"substeps", summary.substeps},
         {"accuracy", summary.accuracy},
         {"tolerance", options.simulation.tolerance},
         {"converged", summary.converged}});
    document["channels"] = tellChannels(take, terminal);
    terminal.say(std::to_string(summary.substeps) + (summary.substeps == 1 ? " step" : " steps")
                 + " a sample; half the step changes the result by "
                 + fixed(20.0 * std::log10(std::max(summary.accuracy, 1e-12)), 0) + " dB"
                 + (summary.converged ? "." : ", more than --tolerance allows."));
    auto warning = beyond(model, motionIsGuessed, take);
    if (motionIsGuessed)
        warning += (warning.empty() ? "" : " ") + guessedMotion("The motion");
    if (!warning.empty()) {
        terminal.say(wrapped(warning));
        document["warning"] = warning;
    }
    sayTake(options, take, terminal);
    terminal.document(document);
    if (!summary.converged)
        terminal.answer = 1;
}

}  // namespace

void addSimulate(CLI::App& app, Terminal& terminal)
{
    const auto [verb, o] = addVerb<SimulateArguments>(app, terminal, step::use, "simulate",
                                                      "Play a signal to a model: every channel of it, as a take", run);
    verb->add_option("MODEL", o->model,
                     "the model, a .json: of a driver, or one from rank --keep, harmonics --model, pnlss or identify, "
                     "which plays one channel at its own rate")
        ->required();
    verb->add_option("IN", o->input, "the signal: a .wav of one channel, or the voltage of a take or plan")->required();
    verb->add_option("--full-scale", o->fullScale,
                     "V at the loudspeaker for a WAV sample of 1.0 (N for a model without a coil)")
        ->check(CLI::PositiveNumber);
    verb->add_option("--tolerance", o->simulation.tolerance,
                     "largest relative change of any channel when the step is halved")
        ->capture_default_str();
    addMotionOptions(*verb, o->known);
    verb->add_option("--out", o->out, "folder of the take")->required()->type_name("DIR");
    verb->footer("Exit code 1: the take was written, but the tolerance was not reached.");
}

}  // namespace excursion::cli
