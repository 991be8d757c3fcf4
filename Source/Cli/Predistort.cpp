// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/Destination.h"
#include "Cli/Terminal.h"
#include "Cli/Verbs.h"

#include "Engine/BlackBox/BlackBoxPredistorter.h"
#include "Engine/BlackBox/ModelDocument.h"
#include "Engine/Document/DraftFile.h"
#include "Engine/Document/Engineering.h"
#include "Engine/Document/JsonText.h"
#include "Engine/Error.h"
#include "Engine/Loudspeaker/ModelFile.h"
#include "Engine/Predistortion/Predistorter.h"
#include "Engine/Signal/Level.h"
#include "Engine/Take/WavFile.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>

namespace excursion::cli {
namespace {

struct PredistortArguments {
    std::string model, input, out;
    double fullScale = 0.0;                                             ///< V or N
    std::optional<double> displacementLimit, voltageLimit, powerLimit;  ///< m, V or N, W
    double amount = 1.0, margin = 0.0;
    int oversampling = 2;
};

void publish(const Wav& bent, const std::string& out)
{
    DraftFile draft(out);
    writeWav(draft.path(), bent.sampleRate, bent.channels, SampleFormat::float32);
    draft.publish();
}

/// What the documents of all classes of models begin with.
nlohmann::ordered_json documentOf(const PredistortArguments& options, const Wav& wav)
{
    return {{"format", "excursion-predistort"},
            {"version", 1},
            {"model", options.model},
            {"input", options.input},
            {"output", options.out},
            {"sampleRate", wav.sampleRate},
            {"samples", wav.channels.front().size()},
            {"fullScale", options.fullScale},
            {"amount", options.amount}};
}

/// @param loudest  peak that came out, in the input's unit
void sayLoudest(const PredistortArguments& options, double loudest, Terminal& terminal)
{
    if (loudest > options.fullScale)
        terminal.say("Samples go to " + significant(loudest / options.fullScale, 3)
                     + " times full scale, which only a WAV of floating point, as this one is, can hold.");
}

void sayWritten(const PredistortArguments& options, const std::string& unit, Terminal& terminal)
{
    terminal.say("Wrote " + options.out + ". A sample of 1.0 stands for " + significant(options.fullScale) + " " + unit
                 + ", as in " + options.input + ".");
}

/// @param out  where what comes of it goes
Wav readPlayable(const std::string& file, const std::string& out)
{
    auto wav = readWav(file);
    std::error_code none;
    if (std::filesystem::equivalent(file, out, none))
        throw Error(Error::Kind::usage,
                    "The WAV that is played would be overwritten: give another name for what comes out.");
    for (std::size_t c = 0; c < wav.channels.size(); ++c)
        requireFinite(wav, c, file);
    return wav;
}

PredistortionControls controlsFrom(const PredistortArguments& options, const Model& model)
{
    PredistortionControls controls;
    controls.amount = options.amount;
    controls.displacementLimit = options.displacementLimit.value_or(measuredDisplacement(model));
    controls.voltageLimit = options.voltageLimit.value_or(std::numeric_limits<double>::infinity());
    controls.powerLimit = options.powerLimit.value_or(std::numeric_limits<double>::infinity());
    controls.margin = options.margin;
    return controls;
}

/// One channel through a predistorter of its own, by which its delay is taken out again.
template <class AnyPredistorter>
void bend(std::vector<double>& samples, AnyPredistorter& predistorter, double fullScale, const Progress& progress,
          double from, double share)
{
    constexpr std::size_t block = 4096;
    const auto latency = static_cast<std::size_t>(predistorter.latency());
    const std::size_t length = samples.size();
    samples.resize(length + latency, 0.0);
    for (auto& sample : samples)
        sample *= fullScale;
    for (std::size_t n = 0; n < samples.size(); n += block) {
        if (n / block % 16 == 0)
            progress.at(from + share * static_cast<double>(n) / static_cast<double>(samples.size()), "predistorting");
        predistorter.process(samples.data() + n, samples.data() + n, std::min(block, samples.size() - n));
    }
    samples.erase(samples.begin(), samples.begin() + static_cast<std::ptrdiff_t>(latency));
    for (auto& sample : samples)
        sample /= fullScale;
}

/// dB from which on a limit is told to have acted.
constexpr double noticed = 1e-3;

std::string turnedDown(double decibels, bool limited)
{
    return limited ? "by " + fixed(decibels, 1) + " dB" : "no limit";
}

/// The same with a model without physics, which knows no cone: the region of its fit is the limit.
void runBlackBox(const PredistortArguments& options, const BlackBox& box, Terminal& terminal)
{
    if (options.displacementLimit || options.powerLimit || options.margin != 0.0)
        throw Error(Error::Kind::usage, "--limit-x, --limit-p and --margin are of a cone and a coil, which a model "
                                        "without physics does not know: leave them out; it keeps to where it was "
                                        "fitted.");
    const auto wav = readPlayable(options.input, options.out);
    const RehearsedBox model(box);
    const auto& gain = model.rehearsal;
    const std::string unit = box.input == "voltage" ? "V" : box.input == "force" ? "N" : "units of " + box.input;
    terminal.say("A " + box.kind + " (" + box.output + " from " + box.input + ") at "
                 + significant(box.linear.sampleRate, 6) + " Hz. As it was fitted, with "
                 + significant(box.stimulus.rms, 3) + " " + unit + " rms, its distortion is " + fixed(gain.beforeDb, 1)
                 + " dB; with the correction " + fixed(gain.afterDb, 1) + " dB are left: a gain of "
                 + fixed(gain.gainDb(), 1) + " dB, as far as the model is right.");
    if (box.output == "current")
        terminal.say(
            "What becomes linear is the current, which is not the sound: of that, a model of the displacement, "
            "the velocity, the acceleration or the pressure would take the distortion out.");
    const auto rate = static_cast<double>(wav.sampleRate);
    if (rate != box.linear.sampleRate)
        terminal.say("The WAV is at another rate, " + significant(rate, 6)
                     + " Hz: the correction passes through the model's rate, and reaches up to "
                     + significant(0.41e-3 * std::min(rate, box.linear.sampleRate), 3) + " kHz.");
    auto bent = wav;
    const auto progress = terminal.progress();
    std::vector<std::vector<std::string>> rows;
    nlohmann::ordered_json channels = nlohmann::ordered_json::array();
    bool limited = false;
    double loudest = 0.0;
    const BlackBoxControls controls {options.amount,
                                     options.voltageLimit.value_or(std::numeric_limits<double>::infinity())};
    for (std::size_t c = 0; c < bent.channels.size(); ++c) {
        BlackBoxPredistorter predistorter(model, rate, controls);
        const double before = options.fullScale * peakOf(wav.channels[c]),
                     share = 1.0 / static_cast<double>(bent.channels.size());
        bend(bent.channels[c], predistorter, options.fullScale, progress, share * static_cast<double>(c), share);
        const auto meters = predistorter.take();
        const double after = options.fullScale * peakOf(bent.channels[c]);
        loudest = std::max(loudest, after);
        limited = limited || meters.reduction > noticed;
        channels.push_back({{"peakIn", before},
                            {"peakOut", after},
                            {"correction", meters.correction},
                            {"region", meters.region},
                            {"reduction", meters.reduction}});
        rows.push_back({std::to_string(c + 1), significant(before) + " " + unit, significant(after) + " " + unit,
                        significant(meters.correction) + " " + unit, fixed(100.0 * meters.region, 0) + " %",
                        turnedDown(meters.reduction, true)});
    }
    publish(bent, options.out);
    auto told = documentOf(options, wav);
    told.update({{"voltageLimit", numberOrNull(controls.inputLimit)},
                 {"modelRate", box.linear.sampleRate},
                 {"distortionBeforeDb", gain.beforeDb},
                 {"distortionAfterDb", gain.afterDb},
                 {"gainDb", gain.gainDb()},
                 {"channels", channels},
                 {"limited", limited}});
    terminal.document(told);
    terminal.table({"channel", "peak in", "out", "the correction", "of the region", "turned down"}, rows);
    if (limited)
        terminal.say("The signal goes beyond where the model was fitted (" + significant(box.stimulus.peak, 3) + " "
                     + unit + " peak, or what its states reached): there it was turned down.");
    sayLoudest(options, loudest, terminal);
    sayWritten(options, unit, terminal);
    if (limited)
        terminal.answer = 1;
}

void run(const PredistortArguments& options, Terminal& terminal)
{
    for (const auto& [name, value] : {std::pair {"--full-scale", options.fullScale},
                                      {"--limit-x", options.displacementLimit.value_or(1.0)},
                                      {"--limit-u", options.voltageLimit.value_or(1.0)},
                                      {"--limit-p", options.powerLimit.value_or(1.0)}})
        if (!(value > 0.0 && std::isfinite(value)))
            throw Error(Error::Kind::usage, std::string(name) + " must be a positive number.");
    requireFilePlace(options.out);
    const auto document = readJson(options.model);
    const JsonField field(document, "", options.model);
    if (isModelDocument(field))
        return runBlackBox(options, blackBoxOf(modelDocumentFrom(field)), terminal);
    const auto model = modelFromJson(field);
    const auto wav = readPlayable(options.input, options.out);
    if (options.powerLimit && !model.electrical())
        throw Error(Error::Kind::usage, "--limit-p is of the heat of a coil, and this model has none; leave it out.");
    const RealTimeOptions realTime {static_cast<double>(wav.sampleRate), options.oversampling};
    const auto controls = controlsFrom(options, model);
    std::string reason;
    if (!controls.isValid(&reason))
        throw Error(Error::Kind::usage, "The predistortion cannot run: " + reason + ".");

    auto bent = wav;
    const auto progress = terminal.progress();
    const std::string unit = model.electrical() ? "V" : "N";
    nlohmann::ordered_json channels = nlohmann::ordered_json::array();
    std::vector<std::vector<std::string>> rows;
    bool limited = false;
    double loudest = 0.0;
    int faults = 0;
    for (std::size_t c = 0; c < bent.channels.size(); ++c) {
        Predistorter predistorter(model, realTime, controls);
        const double before = options.fullScale * peakOf(wav.channels[c]),
                     share = 1.0 / static_cast<double>(bent.channels.size());
        bend(bent.channels[c], predistorter, options.fullScale, progress, share * static_cast<double>(c), share);
        const auto meters = predistorter.take();
        const double after = options.fullScale * peakOf(bent.channels[c]);
        loudest = std::max(loudest, after);
        faults += meters.faults;
        limited = limited || meters.displacementReduction > noticed || meters.voltageReduction > noticed
                  || meters.powerReduction > noticed;
        channels.push_back({{"peakIn", before},
                            {"peakOut", after},
                            {"displacement", meters.displacement},
                            {"power", meters.power},
                            {"displacementReduction", meters.displacementReduction},
                            {"voltageReduction", meters.voltageReduction},
                            {"powerReduction", meters.powerReduction},
                            {"faults", meters.faults}});
        rows.push_back({std::to_string(c + 1), significant(before) + " " + unit, significant(after) + " " + unit,
                        significant(1e3 * meters.displacement) + " mm",
                        turnedDown(meters.displacementReduction,
                                   options.displacementLimit || std::isfinite(controls.displacementLimit)),
                        turnedDown(meters.voltageReduction, options.voltageLimit.has_value())});
        if (options.powerLimit) {
            rows.back().push_back(significant(meters.power) + " W");
            rows.back().push_back(turnedDown(meters.powerReduction, true));
        }
    }
    publish(bent, options.out);
    auto told = documentOf(options, wav);
    told.update({{"oversampling", options.oversampling},
                 {"displacementLimit", numberOrNull(controls.displacementLimit)},
                 {"voltageLimit", numberOrNull(controls.voltageLimit)},
                 {"powerLimit", numberOrNull(controls.powerLimit)},
                 {"margin", controls.margin},
                 {"channels", channels},
                 {"limited", limited}});
    terminal.document(told);
    std::vector<std::string> heads {
        "channel", "peak in", "out", "the cone moves", "motion turned down", "voltage turned down"};
    if (options.powerLimit)
        heads.insert(heads.end(), {"heat at most", "current turned down"});
    terminal.table(heads, rows);
    if (limited)
        terminal.say("A limit was reached ("
                     + (std::isfinite(controls.displacementLimit)
                            ? significant(1e3 * controls.displacementLimit, 3) + " mm"
                            : "no limit of the excursion")
                     + ", "
                     + (std::isfinite(controls.voltageLimit) ? significant(controls.voltageLimit, 3) + " " + unit
                                                             : "no limit of the voltage")
                     + (options.powerLimit ? ", " + significant(*options.powerLimit, 3) + " W" : "")
                     + "): there the signal was turned down, the lowest notes first.");
    sayLoudest(options, loudest, terminal);
    if (faults > 0)
        terminal.say("The predistorter had to start anew " + std::to_string(faults) + (faults == 1 ? " time" : " times")
                     + " from silence: the model is driven far beyond what it knows.");
    sayWritten(options, unit, terminal);
    if (limited || faults > 0)
        terminal.answer = 1;
}

}  // namespace

void addPredistort(CLI::App& app, Terminal& terminal)
{
    auto o = std::make_shared<PredistortArguments>();
    auto* verb = app.add_subcommand("predistort", "Bends a WAV so that the loudspeaker plays it as if it were linear")
                     ->group(step::use);
    verb->add_option("MODEL", o->model,
                     "the model of a driver, or one without physics that pnlss or rank --keep "
                     "has written, a .json")
        ->required();
    verb->add_option("IN.wav", o->input, "what is to be played; each of its channels is predistorted by itself")
        ->required();
    verb->add_option("OUT.wav", o->out, "the predistorted signal, as long and as loud")->required();
    verb->add_option("--full-scale", o->fullScale,
                     "V at the loudspeaker for a WAV sample of 1.0 (N for a model without a coil)")
        ->required();
    verb->add_option("--limit-x", o->displacementLimit,
                     "m that the cone may move at most (default: as far as the model was measured)");
    verb->add_option("--limit-u", o->voltageLimit, "V that may come out at most (default: no limit)");
    verb->add_option("--limit-p", o->powerLimit,
                     "W of heat in the voice coil, Re i^2 averaged over 1 s (default: no limit)");
    verb->add_option("--margin", o->margin,
                     "the limits hold for every loudspeaker whose parameters differ by at most this share from the "
                     "model's, 0 to 0.3")
        ->check(CLI::Range(0.0, 0.3))
        ->capture_default_str();
    verb->add_option("--amount", o->amount, "0: the signal as it is, 1: fully linearized")
        ->check(CLI::Range(0.0, 1.0))
        ->capture_default_str();
    verb->add_option("--oversampling", o->oversampling, "1, 2 or 4")
        ->check(CLI::IsMember({1, 2, 4}))
        ->capture_default_str();
    verb->footer("Exit code 1: the WAV was written, but a limit was reached or the predistorter had to start anew.");
    verb->callback([o, &terminal] { run(*o, terminal); });
}

}  // namespace excursion::cli
