// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/ImportRecording.h"

#include "Cli/Destination.h"
#include "Cli/Terminal.h"
#include "Engine/Document/DocumentFormat.h"
#include "Engine/Document/JsonText.h"
#include "Engine/Document/TextFile.h"
#include "Engine/Error.h"
#include "Engine/Import/Export.h"
#include "Engine/Import/ImportRecording.h"
#include "Engine/Import/ReadTake.h"
#include "Engine/Signal/Level.h"
#include "Engine/Take/SweepTake.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>

namespace excursion::cli {

RecordingOptions recordingOptions(const RecordingArguments& arguments)
{
    RecordingOptions options;
    options.files.assign(arguments.files.begin(), arguments.files.end());
    for (const auto& mapping : arguments.map)
        options.map.push_back(parseChannelMapping(mapping));
    if (!arguments.plan.empty()) {
        const auto header = planHeaderOf(arguments.plan);
        auto plan = header.empty() ? readSweepTake(arguments.plan) : readOwnTake(header);
        options.plan = std::move(plan.take);
        options.sweep = std::move(plan.sweep);
    }
    if (!arguments.calibration.empty()) {
        options.calibration = readCalibration(arguments.calibration);
        options.calibrationFile = arguments.calibration;
    }
    if (options.plan && (arguments.from > 0 || arguments.to > 0))
        throw Error(Error::Kind::usage, "--from and --to cut a recording by hand; with a --plan its place is found.");
    options.gain = arguments.gain;
    options.from = arguments.from;
    if (arguments.to > 0)
        options.to = arguments.to;
    return options;
}

namespace {

/// "starts at 1.234567 s, clock +12.34 ppm (+-0.02)": what was found out about the time of a file.
std::string timeOf(const ImportedFile& file)
{
    const auto& a = file.alignment;
    const double start = a.clock.start / file.sampleRate;
    std::string text = file.name + ": the plan begins at " + fixed(start, 4) + " s (sample " + fixed(a.clock.start, 3)
                       + ", known to " + significant(std::max(a.startError, 0.0005), 1) + "), told by " + file.witness
                       + ". ";
    if (a.driftUnknown)
        text += "Its clock was taken for the player's.";
    else if (a.synchronous)
        text += "Its clock is the player's (within " + significant(std::max(3 * a.driftError, 0.01), 1) + " ppm).";
    else
        text += "Its clock is " + fixed(std::abs(a.driftPpm), 2) + " ppm (+-"
                + significant(std::max(a.driftError, 0.001), 1) + ") " + (a.driftPpm > 0 ? "fast" : "slow")
                + " against the player's, which was taken out.";
    return text;
}

std::string loopbackText(const InterfaceResponse& loopback)
{
    const auto size = fixed(loopback.mostDb, 3) + " dB and " + fixed(loopback.mostDegrees, 2) + " degrees";
    return "Loopback: the delay of the interface was taken off; its response "
           + (loopback.flat ? "is flat within " + size + ", no more than its uncertainty, and was left."
                            : "departs from flat by up to " + size + " (+-" + significant(loopback.errorDb, 1)
                                  + " dB) and was taken off, too.");
}

nlohmann::ordered_json documentOf(const ImportedFile& file, bool aligned)
{
    nlohmann::ordered_json document {{"file", file.name}, {"sampleRate", file.sampleRate}, {"seconds", file.seconds}};
    if (!aligned)
        return document;
    const auto& a = file.alignment;
    document["start"] = a.clock.start;
    document["step"] = a.clock.step;
    document["startError"] = numberOrNull(a.startError);
    document["driftPpm"] = a.synchronous ? 0.0 : a.driftPpm;
    document["driftErrorPpm"] = numberOrNull(a.driftError);
    document["scatter"] = numberOrNull(a.scatter);
    document["realizations"] = a.realizations;
    document["toldBy"] = file.witness;
    document["likeness"] = a.likeness;
    if (const auto& l = file.loopback)
        document["loopback"] = {{"flat", l->flat},
                                {"mostDb", l->mostDb},
                                {"mostDegrees", l->mostDegrees},
                                {"errorDb", numberOrNull(l->errorDb)}};
    return document;
}

}  // namespace

void sayImported(const ImportedRecording& imported, bool aligned, const std::string& out, Terminal& terminal)
{
    const auto& take = imported.take;
    std::vector<std::vector<std::string>> rows;
    for (const auto& channel : take.channels)
        rows.push_back({std::string(name(channel.quantity)) + (channel.assumed ? " (assumed)" : ""), channel.unit,
                        significant(rmsOf(channel.samples)), significant(peakOf(channel.samples)),
                        significant(channel.fullScale)});
    for (const auto& file : imported.files) {
        if (aligned)
            terminal.say(wrapped(timeOf(file)));
        if (file.loopback)
            terminal.say(wrapped(loopbackText(*file.loopback)));
    }
    for (const auto& remark : imported.remarks)
        terminal.say(wrapped("remark  " + remark, 8));
    terminal.table({"channel", "unit", "rms", "peak", "full scale"}, rows);
    terminal.say("Wrote the take " + out + ": " + fixed(static_cast<double>(take.length()) / take.sampleRate, 2)
                 + " s at " + significant(take.sampleRate, 8) + " Hz.");
}

nlohmann::ordered_json importJson(const ImportedRecording& imported, bool aligned, const std::string& out)
{
    const auto& take = imported.take;
    nlohmann::ordered_json channels = nlohmann::ordered_json::array(), files = nlohmann::ordered_json::array();
    for (const auto& channel : take.channels)
        channels.push_back({{"quantity", name(channel.quantity)},
                            {"unit", channel.unit},
                            {"peak", peakOf(channel.samples)},
                            {"fullScale", channel.fullScale},
                            {"assumed", channel.assumed}});
    for (const auto& file : imported.files)
        files.push_back(documentOf(file, aligned));
    return DocumentFormat {"excursion-import"}.with({{"take", out},
                                                     {"kind", "recording"},
                                                     {"sampleRate", take.sampleRate},
                                                     {"samples", take.length()},
                                                     {"channels", channels},
                                                     {"files", files},
                                                     {"remarks", imported.remarks}});
}

bool isRecording(const std::string& file)
{
    static constexpr std::array<std::string_view, 8> known {".wav",  ".wave", ".rf64", ".aif",
                                                            ".aiff", ".aifc", ".caf",  ".flac"};
    return std::find(known.begin(), known.end(), endingOf(file)) != known.end();
}

void addRecordingOptions(CLI::App& verb, RecordingArguments& arguments)
{
    verb.add_option("--plan", arguments.plan,
                    "for recordings: the folder that 'excursion excite' wrote and whose excitation.wav was played; "
                    "start, clock and rate of each recording are found from it")
        ->type_name("DIR");
    verb.add_option("--gain", arguments.gain,
                    "for recordings without a voltage: V at the loudspeaker for a played sample of 1.0; the voltage is "
                    "then assumed")
        ->check(CLI::PositiveNumber);
    verb.add_option("--calibration", arguments.calibration,
                    "for recordings: what 'excursion calibrate' wrote, for channels without a full scale in --map, or "
                    "for all channels without --map")
        ->type_name("FILE.json");
}

void requireApart(const RecordingArguments& arguments)
{
    if (!arguments.plan.empty())
        requireApart(planHeaderOf(arguments.plan).string(), arguments.out);
    if (!arguments.calibration.empty())
        requireApart(arguments.calibration, arguments.out);
}

void importRecordings(const RecordingArguments& arguments, Terminal& terminal)
{
    const bool text = endingOf(arguments.out) == ".csv";
    text ? requireFilePlace(arguments.out) : requireFolderPlace(arguments.out);
    requireApart(arguments);
    const auto options = recordingOptions(arguments);
    auto imported = importRecording(options, terminal.progress());
    if (!arguments.name.empty())
        imported.take.driver.name = arguments.name;
    imported.take.remarks = imported.remarks;
    text ? writeCsv(imported.take, arguments.out) : writeSweepTake({imported.take, imported.sweep}, arguments.out);
    sayImported(imported, options.plan.has_value(), arguments.out, terminal);
    terminal.document(importJson(imported, options.plan.has_value(), arguments.out));
}

}  // namespace excursion::cli
