// SPDX-License-Identifier: GPL-3.0-or-later
#include "Audio/ChooseDevice.h"
#include "Audio/Measure.h"
#include "Cli/CheckTables.h"
#include "Cli/Destination.h"
#include "Cli/ImportRecording.h"
#include "Cli/Terminal.h"
#include "Cli/Verbs.h"

#include "Engine/Check/TakeCheck.h"
#include "Engine/Document/DocumentFormat.h"
#include "Engine/Document/DraftFile.h"
#include "Engine/Document/JsonText.h"
#include "Engine/Error.h"
#include "Engine/Import/AssignChannels.h"
#include "Engine/Import/PlanPeriods.h"
#include "Engine/Take/TakeFile.h"
#include "Engine/Take/WavFile.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>

namespace excursion::cli {
namespace {

struct MeasureArguments {
    RecordingArguments recording;  ///< its files are empty
    std::string device, keep;
    std::vector<std::string> limits;
    std::vector<int> outputs {1};
    double rise = 4.0, latency = 0.1;
    bool list = false;
};

void listDevices(Terminal& terminal)
{
    const auto system = audio::openSystem();
    const auto devices = system->devices();
    auto document = DocumentFormat {"excursion-devices"}.with();
    document["devices"] = nlohmann::ordered_json::array();
    std::vector<std::vector<std::string>> rows;
    for (std::size_t k = 0; k < devices.size(); ++k) {
        const auto& d = devices[k];
        rows.push_back({std::to_string(k + 1), d.backend + ":" + d.name, std::to_string(d.inputs),
                        std::to_string(d.outputs), d.rates.empty() ? "-" : audio::ratesText(d.rates)});
        document["devices"].push_back({{"number", k + 1},
                                       {"backend", d.backend},
                                       {"name", d.name},
                                       {"inputs", d.inputs},
                                       {"outputs", d.outputs},
                                       {"rates", d.rates}});
    }
    if (rows.empty())
        terminal.say("There is no audio device (" + system->description()
                     + "); connect one, or start the JACK server.");
    else
        terminal.table({"number", "device", "inputs", "outputs", "rates"}, rows);
    terminal.document(document);
}

void setLimit(std::vector<audio::WatchedInput>& inputs, const std::string& text)
{
    const auto equals = text.find('=');
    const auto quantity = quantityNamed(text.substr(0, equals));
    const auto amount = quantity && equals != std::string::npos ? amountOf(*quantity, text.substr(equals + 1))
                                                                : std::optional<double>();
    if (!amount || *amount < 0)
        throw Error(Error::Kind::usage, "--limit " + text
                                            + " is no quantity and its largest value; write for example voltage=20, "
                                              "current=2A or displacement=3mm.");
    const auto input = std::find_if(inputs.begin(), inputs.end(),
                                    [&](const auto& i) { return i.quantity == quantity; });
    if (input == inputs.end())
        throw Error(Error::Kind::usage, "--limit " + text + ": no input is the " + std::string(name(*quantity))
                                            + ", so it cannot be watched; map it, or leave the limit out.");
    input->limit = *amount;
}

/// What the inputs hold, as import will take them.
std::vector<AssignedChannel> inputsOf(const RecordingOptions& options)
{
    int inputs = 1;
    for (const auto& mapping : options.map) {
        if (!mapping.file.empty())
            throw Error(Error::Kind::usage,
                        "--map " + mapping.text + " names a file; the inputs of a device are counted from 1.");
        inputs = std::max(inputs, mapping.channel);
    }
    if (options.map.empty() && options.calibration)
        for (const auto& channel : options.calibration->channels)
            if (channel.quantity)
                inputs = std::max(inputs, channel.channel);
    auto assigned = assignChannels(options, {{"the recording", static_cast<std::size_t>(inputs)}});
    requireInput(assigned, options.gain);
    for (const auto& channel : assigned)
        if (!channel.curve.empty())
            readMicrophoneCurve(channel.curve, channel.referenceFrequency);  // refused now rather than afterwards
    return assigned;
}

audio::ProcedureOptions procedureOf(const MeasureArguments& arguments, const RecordingOptions& options)
{
    const auto& plan = *options.plan;
    if (!options.sweep)
        periodsOf(plan);  // refuses what is no plan
    auto procedure = audio::procedureFor(plan, options.sweep, plan.input().fullScale);
    procedure.rise = std::max(arguments.rise, options.sweep ? procedure.rise : 0.0);
    procedure.recorded = 1;
    for (const auto& channel : inputsOf(options)) {
        audio::WatchedInput watched;
        watched.input = static_cast<int>(channel.channel);
        watched.quantity = channel.quantity;
        watched.factor = channel.factor;
        procedure.inputs.push_back(watched);
        procedure.recorded = std::max(procedure.recorded, watched.input + 1);
    }
    for (const auto& limit : arguments.limits)
        setLimit(procedure.inputs, limit);
    procedure.outputs.clear();
    for (const int output : arguments.outputs)
        procedure.outputs.push_back(output - 1);
    return procedure;
}

/// "voltage [======    ] -12": a meter an input, in dB of the converter's full scale.
class Meters {
public:
    Meters(const audio::ProcedureOptions& options, Terminal& terminal) : options_(options), terminal_(terminal) {}

    void show(const audio::Status& status)
    {
        held_.resize(status.meters.size());
        std::string levels, bars;
        for (std::size_t k = 0; k < status.meters.size(); ++k) {
            const auto& meter = status.meters[k];
            held_[k] = std::max(held_[k], meter.peak);
            const auto& quantity = options_.inputs[k].quantity;
            const auto what = quantity ? std::string(name(*quantity)) : std::string("loopback");
            const double db = 20.0 * std::log10(std::max(held_[k], 1e-6f));
            const auto level = fixed(db, 1) + " dB" + (meter.clipped ? " CLIP" : "");
            levels += (k == 0 ? "" : ", ") + what + " " + level;
            constexpr double floorDb = -60.0, cells = 10;
            const auto full = static_cast<std::size_t>(std::lround(cells * std::clamp(1.0 - db / floorDb, 0.0, 1.0)));
            bars += "  " + what + " [" + std::string(full, '=')
                    + std::string(static_cast<std::size_t>(cells) - full, ' ') + "] " + level;
        }
        const auto stage = std::string(audio::name(status.stage))
                           + (status.attempt > 1 ? ", attempt " + std::to_string(status.attempt) : "");
        if (const auto progress = terminal_.progress(); terminal_.progressLines && progress.report) {
            progress.report(0.9 * status.fraction, stage + ", " + levels);
            held_.clear();
        } else if (terminal_.livesInPlace()) {
            terminal_.live(fixed(100.0 * status.fraction, 0) + " %  " + stage + bars);
            held_.clear();
        } else if (status.seconds >= nextLine_ || stage != stage_) {
            nextLine_ = std::floor(status.seconds) + 1.0;
            terminal_.live(fixed(status.seconds, 1) + " s  " + stage + "  " + levels);
            held_.clear();
        }
        stage_ = stage;
    }

private:
    const audio::ProcedureOptions& options_;
    Terminal& terminal_;
    std::vector<float> held_;  ///< peaks since the last line
    std::string stage_;
    double nextLine_ = 0.0;
};

Wav soundOf(std::vector<std::vector<float>>& channels, double sampleRate)
{
    Wav sound;
    sound.sampleRate = static_cast<int>(std::lround(sampleRate));
    for (auto& channel : channels) {
        sound.channels.emplace_back(channel.begin(), channel.end());
        channel = {};
    }
    return sound;
}

void requireComplete(const MeasureArguments& a)
{
    const auto missing = [](const char* option) {
        throw Error(Error::Kind::usage, std::string(option)
                                            + " is missing; a measurement needs --device, --plan, --map or "
                                              "--calibration, and --out (--list shows the devices).");
    };
    if (a.recording.plan.empty())
        missing("--plan");
    if (a.recording.out.empty())
        missing("--out");
    requireFolderPlace(a.recording.out);
    requireApart(a.recording);
    if (!a.keep.empty())
        requireFilePlace(a.keep);
}

void run(const MeasureArguments& a, Terminal& terminal)
{
    if (a.list)
        return listDevices(terminal);
    requireComplete(a);
    auto options = recordingOptions(a.recording);
    audio::MeasureOptions measuring;
    measuring.procedure = procedureOf(a, options);
    measuring.stream.latency = a.latency;
    const auto& procedure = measuring.procedure;

    const auto system = audio::openSystem();
    const auto devices = system->devices();
    const auto& device = audio::chooseDevice(devices, a.device);
    audio::requireFit(device, procedure.recorded, *std::max_element(a.outputs.begin(), a.outputs.end()),
                      procedure.sampleRate, a.recording.plan);
    const auto where = device.backend + ":" + device.name;
    terminal.say("Plays " + fixed(static_cast<double>(procedure.sound.size()) / procedure.sampleRate, 2) + " s through "
                 + where + " at " + significant(procedure.sampleRate, 8) + " Hz, after a rise of "
                 + significant(procedure.rise) + " s to full level. Ctrl-C fades out.");
    Meters meters(procedure, terminal);
    measuring.report = [&meters](const audio::Status& status) { meters.show(status); };
    measuring.stop = terminal.stop();
    auto measured = audio::measure(*system, device, measuring);

    options.sounds.push_back({"the recording", soundOf(measured.channels, procedure.sampleRate)});
    if (!a.keep.empty()) {
        DraftFile draft(a.keep);
        writeWav(draft.path(), options.sounds.front().sound.sampleRate, options.sounds.front().sound.channels,
                 SampleFormat::float32);
        draft.publish();
        terminal.say("Wrote the recording " + a.keep + ", as the inputs gave it.");
    }
    auto imported = importRecording(options, terminal.progress().part(0.9, 1.0));
    imported.remarks.insert(imported.remarks.begin(), measured.remarks.begin(), measured.remarks.end());
    if (!a.recording.name.empty())
        imported.take.driver.name = a.recording.name;
    const auto report = check(imported.take);
    const auto checked = checkJson(report, a.recording.out, imported.take.sampleRate);
    imported.take.remarks = imported.remarks;  // after the check, as they are told beside it
    writeSweepTake({imported.take, imported.sweep}, a.recording.out);
    writeJson(checked, (std::filesystem::path(a.recording.out) / "check.json").string());

    sayImported(imported, true, a.recording.out, terminal);
    terminal.say("");
    sayCheck(report, terminal);
    terminal.document(DocumentFormat {"excursion-measure"}.with(
        {{"take", a.recording.out},
         {"device", {{"backend", device.backend}, {"name", device.name}}},
         {"sampleRate", procedure.sampleRate},
         {"attempts", measured.attempts},
         {"recording", a.keep.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(a.keep)},
         {"import", importJson(imported, true, a.recording.out)},
         {"check", checked}}));
    if (!report.fitForUse())
        terminal.answer = 1;
}

}  // namespace

void addMeasure(CLI::App& app, Terminal& terminal)
{
    const auto [verb, o] = addVerb<MeasureArguments>(
        app, terminal, step::measure, "measure", "Play a plan through an audio device, record, and make a take of it",
        run);
    verb->add_flag("--list", o->list, "show the audio devices, their channels and rates, and do nothing else");
    verb->add_option("--device", o->device, "its number or name in --list, or a part of the name that is unique");
    verb->add_option("--plan", o->recording.plan, "the folder that 'excursion excite' wrote")->type_name("DIR");
    verb->add_option("--out", o->recording.out, "folder of the new take, with its check in check.json")
        ->type_name("DIR");
    verb->add_option(
            "--map", o->recording.map,
            "what an input is, INPUT=QUANTITY:FULLSCALE, the quantity at a sample of 1.0, for example "
            "1=voltage:32, 2=current:-500mA (negative: inverted), 3=loopback (an output of the device, straight "
            "into this input); inputs are counted from 1. May be repeated")
        ->expected(1)
        ->take_all();
    verb->add_option("--calibration", o->recording.calibration,
                     "what 'excursion calibrate' wrote, for inputs without a full scale in --map, or for all inputs "
                     "without --map")
        ->type_name("FILE.json");
    verb->add_option("--gain", o->recording.gain,
                     "if the voltage is not recorded: V at the loudspeaker for a played sample of 1.0; the voltage is "
                     "then assumed")
        ->check(CLI::PositiveNumber);
    verb->add_option("--output", o->outputs, "outputs that play, counted from 1")
        ->delimiter(',')
        ->check(CLI::Range(1, 4096))
        ->capture_default_str();
    verb->add_option("--limit", o->limits,
                     "fade out and end the measurement when a recorded quantity reaches this, for example voltage=20, "
                     "current=2A, displacement=3mm (from its rest position). May be repeated")
        ->expected(1)
        ->take_all();
    verb->add_option("--rise", o->rise, "s from quiet to full level, before the plan is played")
        ->check(CLI::Range(1.0, 60.0))
        ->capture_default_str();
    verb->add_option("--latency", o->latency,
                     "s of sound in the buffers; more if the computer does not keep up, less for a quicker stop")
        ->check(CLI::Range(0.001, 2.0))
        ->capture_default_str();
    verb->add_option("--recording", o->keep, "keep the raw recording, for 'excursion import'")->type_name("FILE.wav");
    verb->add_option("--name", o->recording.name, "name of the loudspeaker");
    verb->footer("Exit code 0: measured and fit for use; 1: measured, but the check found a fault; 4: ended by a limit "
                 "or a clipping input;\n6: ended by Ctrl-C, after a fade. A take is written only with 0 or 1.");
}

}  // namespace excursion::cli
