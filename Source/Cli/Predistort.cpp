// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/Destination.h"
#include "Cli/KnownMotion.h"
#include "Cli/Predistorting.h"
#include "Cli/Verbs.h"

#include "Engine/BlackBox/ModelDocument.h"
#include "Engine/Document/DocumentFormat.h"
#include "Engine/Document/DraftFile.h"
#include "Engine/Document/Engineering.h"
#include "Engine/Document/JsonText.h"
#include "Engine/Error.h"
#include "Engine/Import/ChannelMap.h"
#include "Engine/Loudspeaker/ModelFile.h"
#include "Engine/Predistortion/Predistorter.h"
#include "Engine/Signal/Level.h"

#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>

namespace excursion::cli {

void publish(const Wav& bent, const std::string& out)
{
    DraftFile draft(out);
    writeWav(draft.path(), bent.sampleRate, bent.channels, SampleFormat::float32);
    draft.publish();
}

nlohmann::ordered_json documentOf(const PredistortArguments& options, const Wav& wav)
{
    return DocumentFormat {"excursion-predistort"}.with({{"model", options.model},
                                                         {"input", options.input},
                                                         {"output", options.out},
                                                         {"sampleRate", wav.sampleRate},
                                                         {"samples", wav.channels.front().size()},
                                                         {"fullScale", options.fullScale},
                                                         {"amount", options.amount},
                                                         {"coupling", options.coupling.corner},
                                                         {"couplingOrder", options.coupling.order}});
}

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

Wav readPlayable(const std::string& file, const std::string& out)
{
    auto wav = readWav(file);
    requireApart(file, out);
    for (std::size_t c = 0; c < wav.channels.size(); ++c)
        requireFinite(wav, c, file);
    return wav;
}

void requireValid(const PredistortionControls& controls)
{
    if (std::string reason; !controls.isValid(&reason))
        throw Error(Error::Kind::usage, "The predistortion cannot run: " + reason + ".");
}

void requireValid(const AmplifierCoupling& coupling)
{
    if (std::string reason; !coupling.isValid(&reason))
        throw Error(Error::Kind::usage, "--coupling: " + reason + ".");
}

std::string turnedDown(double decibels, bool limited)
{
    return limited ? "by " + fixed(decibels, 1) + " dB" : "no limit";
}

namespace {

PredistortionControls controlsFrom(const PredistortArguments& options, const Model& model)
{
    PredistortionControls controls;
    controls.amount = options.amount;
    controls.displacementLimit = options.displacementLimit.value_or(measuredDisplacement(model));
    controls.voltageLimit = options.voltageLimit.value_or(std::numeric_limits<double>::infinity());
    controls.powerLimit = options.powerLimit.value_or(std::numeric_limits<double>::infinity());
    controls.margin = options.margin;
    controls.target = targetFrom(options.target, OwnLinearPart(model));
    return controls;
}

void run(const PredistortArguments& options, Terminal& terminal)
{
    for (const auto& [name, value] : {std::pair {"--full-scale", options.fullScale},
                                      {"--limit-x", options.displacementLimit.value_or(1.0)},
                                      {"--limit-u", options.voltageLimit.value_or(1.0)},
                                      {"--limit-p", options.powerLimit.value_or(1.0)},
                                      {"--coil-resistance", options.coilResistance.value_or(1.0)}})
        if (!(value > 0.0 && std::isfinite(value)))
            throw Error(Error::Kind::usage, std::string(name) + " must be a positive number.");
    requireValid(options.coupling);
    requireFilePlace(options.out);
    const auto document = readJson(options.model);
    const JsonField field(document, "", options.model);
    if (isModelDocument(field))
        return runBlackBox(options, blackBoxOf(modelDocumentFrom(field)), terminal);
    const auto known = withKnown(modelFromJson(field), options.known);
    const auto& model = known.model;
    const bool motionIsGuessed = known.motionIsGuessed;
    if (motionIsGuessed && options.displacementLimit)
        throw Error(Error::Kind::usage, guessedMotion("The motion of this model")
                                            + " Without --limit-x the cone is kept to where the model was measured, "
                                              "which needs neither.");
    const auto wav = readPlayable(options.input, options.out);
    if (options.coilResistance)
        throw Error(Error::Kind::usage, "--coil-resistance is of models without physics; a driver knows its own.");
    if (options.powerLimit && !model.electrical())
        throw Error(Error::Kind::usage, "--limit-p is of the heat of a coil, and this model has none; leave it out.");
    const RealTimeOptions realTime {static_cast<double>(wav.sampleRate), options.oversampling, options.coupling};
    const auto controls = controlsFrom(options, model);
    requireValid(controls);
    nlohmann::ordered_json target;
    if (options.target.asked()) {
        auto told = forecastTarget(model, controls, options.fullScale);
        if (motionIsGuessed)
            told = withoutLengths(std::move(told));
        target = tellTarget(told, controls.target.kind, options.fullScale, model.electrical() ? "V" : "N", terminal);
    }

    auto bent = wav;
    const auto progress = terminal.progress();
    const std::string unit = model.electrical() ? "V" : "N";
    nlohmann::ordered_json channels = nlohmann::ordered_json::array();
    std::vector<std::vector<std::string>> rows;
    bool limited = false;
    int faults = 0;
    const double measured = measuredDisplacement(model);
    const auto motion = [&, guessed = motionIsGuessed](double x) {
        return !guessed                  ? significant(1e3 * x) + " mm"
               : std::isfinite(measured) ? significant(100.0 * x / measured, 3) + " % of the measured motion"
                                         : std::string("-");
    };
    double farthest = 0.0;
    const auto make = [&] { return std::make_unique<Predistorter>(model, realTime, controls); };
    const auto told = [&](double before, double after, const Predistorter::Meters& meters) {
        faults += meters.faults;
        farthest = std::max(farthest, meters.displacement);
        limited = limited || wasLimited(meters);
        channels.push_back({{"peakIn", before},
                            {"peakOut", after},
                            {"displacement", meters.displacement},
                            {"power", meters.power},
                            {"displacementReduction", meters.displacementReduction},
                            {"voltageReduction", meters.voltageReduction},
                            {"powerReduction", meters.powerReduction},
                            {"faults", meters.faults}});
        rows.push_back({std::to_string(channels.size()), significant(before) + " " + unit,
                        significant(after) + " " + unit, motion(meters.displacement),
                        turnedDown(meters.displacementReduction,
                                   options.displacementLimit || std::isfinite(controls.displacementLimit)),
                        turnedDown(meters.voltageReduction, options.voltageLimit.has_value())});
        addPower(rows.back(), options, meters);
    };
    const double loudest = bendAll(bent, options.fullScale, progress, make, told);
    publish(bent, options.out);
    auto report = documentOf(options, wav);
    report.update({{"oversampling", options.oversampling},
                   {"displacementLimit", numberOrNull(controls.displacementLimit)},
                   {"voltageLimit", numberOrNull(controls.voltageLimit)},
                   {"powerLimit", numberOrNull(controls.powerLimit)},
                   {"margin", controls.margin},
                   {"target", target},
                   {"channels", channels},
                   {"limited", limited}});
    terminal.document(report);
    std::vector<std::string> heads {
        "channel", "peak in", "out", "the cone moves", "motion turned down", "voltage turned down"};
    if (options.powerLimit)
        heads.insert(heads.end(), {"heat at most", "current turned down"});
    terminal.table(heads, rows);
    if (limited)
        terminal.say("A limit was reached ("
                     + (std::isfinite(controls.displacementLimit) ? motion(controls.displacementLimit)
                                                                  : "no limit of the excursion")
                     + ", "
                     + (std::isfinite(controls.voltageLimit) ? significant(controls.voltageLimit, 3) + " " + unit
                                                             : "no limit of the voltage")
                     + (options.powerLimit ? ", " + significant(*options.powerLimit, 3) + " W" : "")
                     + "): there the signal was turned down, the lowest notes first.");
    if (farthest > 1.05 * measured)
        terminal.say("The cone moves " + motion(farthest)
                     + (motionIsGuessed ? std::string() : ", but the model was measured to " + motion(measured))
                     + ": beyond that its laws are a guess.");
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
    const auto [verb, o] = addVerb<PredistortArguments>(
        app, terminal, step::use, "predistort", "Bend a WAV so that the loudspeaker plays it as if it were linear",
        run);
    verb->add_option("MODEL", o->model,
                     "the model of a driver, or one without physics from pnlss or rank --keep, a .json")
        ->required();
    verb->add_option("IN.wav", o->input, "the signal to play; each channel is predistorted by itself")->required();
    verb->add_option("OUT.wav", o->out, "the predistorted signal, of the same length and level")->required();
    verb->add_option("--full-scale", o->fullScale,
                     "V at the loudspeaker for a WAV sample of 1.0 (N for a model without a coil)")
        ->required();
    verb->add_option("--limit-x", o->displacementLimit,
                     "limit of the cone's motion, such as 2.4mm; without a unit in m (default: as far as the model was "
                     "measured)")
        ->transform(CLI::Validator(
            [](std::string& text) {
                const auto metres = amountOf(Quantity::displacement, text);
                if (!metres)
                    return "'" + text + "' is no length, such as 2.4mm";
                text = significant(*metres, 15);
                return std::string();
            },
            "LENGTH"));
    addMotionOptions(*verb, o->known);
    verb->add_option("--limit-u", o->voltageLimit, "limit of the output voltage, V (default: no limit)");
    verb->add_option("--limit-p", o->powerLimit,
                     "limit of the heat in the voice coil, W: R i^2 averaged over 1 s (default: no limit)");
    verb->add_option("--coil-resistance", o->coilResistance,
                     "resistance of the coil, ohm: --limit-p needs it for a model without physics");
    verb->add_option("--margin", o->margin,
                     "keep the limits for every loudspeaker whose parameters differ from the model's by at most this "
                     "share, 0 to 0.3")
        ->check(CLI::Range(0.0, 0.3))
        ->capture_default_str();
    auto* const coupling = verb->add_option(
        "--coupling", o->coupling.corner,
        "Hz, the corner of the high-pass between the output and the loudspeaker: the coupling capacitors of "
        "sound card and amplifier. The limit of the motion holds behind it. 0: a constant voltage passes");
    coupling->capture_default_str();
    verb->add_option("--coupling-order", o->coupling.order, "1 or 2, the order of that high-pass")
        ->check(CLI::IsMember({1, 2}))
        ->needs(coupling)
        ->capture_default_str();
    addTargetOptions(*verb, o->target);
    verb->add_option("--amount", o->amount, "0: the signal as it is, 1: fully linearized")
        ->check(CLI::Range(0.0, 1.0))
        ->capture_default_str();
    verb->add_option("--oversampling", o->oversampling, "1, 2 or 4")
        ->check(CLI::IsMember({1, 2, 4}))
        ->capture_default_str();
    verb->footer("Exit code 1: the WAV was written, but a limit was reached or the predistorter had to restart.");
}

}  // namespace excursion::cli
