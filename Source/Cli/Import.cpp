// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/Destination.h"
#include "Cli/ImportRecording.h"
#include "Cli/Terminal.h"
#include "Cli/Verbs.h"
#include "Engine/Document/DocumentFormat.h"
#include "Engine/Import/ReadTake.h"

#include "Engine/Document/TextFile.h"
#include "Engine/Error.h"
#include "Engine/Import/Export.h"
#include "Engine/Import/ImportMat.h"
#include "Engine/Import/ImportText.h"
#include "Engine/Take/TakeFile.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <memory>
#include <utility>
#include <variant>

namespace excursion::cli {
namespace {

struct ImportArguments {
    std::vector<std::string> files;
    std::string file, out, name, as;  ///< the first of the files
    RecordingArguments recording;
    std::vector<std::string> map;
    double rate = 0.0;
    std::size_t from = 0, to = 0;
    bool removeMean = false, minimumPhase = false;
};

ImportOptions importOptions(const ImportArguments& options)
{
    ImportOptions result;
    for (const auto& mapping : options.map)
        addMapping(result, mapping);
    if (!options.as.empty()) {
        result.as = responseNamed(options.as);
        if (!result.as || !result.as->input)
            throw Error(Error::Kind::usage,
                        "There is no response \"" + options.as
                            + "\" for --as; give impedance, admittance, response (sound pressure over "
                              "voltage) or a ratio such as displacement/voltage.");
    }
    result.minimumPhase = options.minimumPhase;
    result.sampleRate = options.rate;
    result.from = options.from;
    if (options.to > 0)
        result.to = options.to;
    result.removeMean = options.removeMean;
    return result;
}

void describe(const Measurement& take, Terminal& terminal, const std::string& out)
{
    std::vector<std::vector<std::string>> rows;
    auto channels = nlohmann::ordered_json::array();
    for (const auto& channel : take.channels) {
        double peak = 0.0;
        for (const double x : channel.samples)
            peak = std::max(peak, std::abs(x));
        rows.push_back(
            {std::string(name(channel.quantity)), channel.unit, significant(peak), significant(channel.fullScale)});
        channels.push_back({{"quantity", name(channel.quantity)},
                            {"unit", channel.unit},
                            {"peak", peak},
                            {"fullScale", channel.fullScale}});
    }
    for (const auto& remark : take.remarks)
        terminal.say(wrapped("remark  " + remark, 8));
    terminal.say("Wrote the take " + out + ": " + std::to_string(take.length()) + " samples at "
                 + significant(take.sampleRate, 8) + " Hz.");
    terminal.table({"channel", "unit", "peak", "full scale"}, rows);
    terminal.document(DocumentFormat {"excursion-import"}.with({{"take", out},
                                                                {"kind", "samples"},
                                                                {"sampleRate", take.sampleRate},
                                                                {"samples", take.length()},
                                                                {"channels", channels},
                                                                {"remarks", take.remarks}}));
}

/// A frequency response is a take as one CSV of spectra.
void importSpectra(const Spectra& spectra, const std::string& out, Terminal& terminal)
{
    const auto *voltage = spectra.find(Quantity::voltage), *current = spectra.find(Quantity::current);
    if (endingOf(out) == ".zma" && voltage && current) {
        Frf impedance {spectra.frequency, {}, {}, {}};
        for (std::size_t k = 0; k < voltage->values.size(); ++k)
            impedance.value.push_back(voltage->values[k] / current->values[k]);
        writeZma(impedance, out);
    } else if (endingOf(out) == ".csv") {
        writeCsv(spectra, out);
    } else {
        throw Error(
            Error::Kind::usage,
            "The file is a frequency response, which is written as one file; give --out a name that ends in .csv"
                + std::string(voltage && current ? " or .zma." : "."));
    }
    for (const auto& remark : spectra.remarks)
        terminal.say(wrapped("remark  " + remark, 8));
    terminal.say("Wrote the spectra " + out + ": " + std::to_string(spectra.frequency.size()) + " frequencies from "
                 + significant(spectra.frequency.front()) + " to " + significant(spectra.frequency.back()) + " Hz.");
    terminal.document(DocumentFormat {"excursion-import"}.with(
        {{"take", out}, {"kind", "spectra"}, {"frequencies", spectra.frequency.size()}, {"remarks", spectra.remarks}}));
}

std::variant<SweepTake, Spectra> readAny(const ImportArguments& options)
{
    const auto asSweepTake = [](Take take) -> std::variant<SweepTake, Spectra> {
        if (auto* spectra = std::get_if<Spectra>(&take))
            return std::move(*spectra);
        return SweepTake {std::move(std::get<Measurement>(take)), {}};
    };
    if (endingOf(options.file) == ".mat")
        return asSweepTake(importMat(options.file, importOptions(options)));
    const auto own = headerOf(options.file);
    if (own.empty() && endingOf(options.file) != ".wav")
        return asSweepTake(importText(options.file, importOptions(options)));
    if (!options.map.empty() || options.rate > 0 || options.from > 0 || options.to > 0 || options.removeMean
        || !options.as.empty() || options.minimumPhase)
        throw Error(Error::Kind::usage,
                    "--map, --as, --rate, --from, --to, --remove-mean and --minimum-phase are for text and MAT files.");
    if (own.empty())
        return asSweepTake(readTake(options.file));
    return readOwnTake(own);
}

void run(ImportArguments options, Terminal& terminal)
{
    options.file = options.files.front();
    for (const auto& file : options.files)
        requireApart(file, options.out);
    if (isRecording(options.file)) {
        options.recording.files = options.files;
        options.recording.map = options.map;
        options.recording.out = options.out;
        options.recording.name = options.name;
        options.recording.from = options.from;
        options.recording.to = options.to;
        if (options.rate > 0 || options.removeMean || !options.as.empty() || options.minimumPhase)
            throw Error(Error::Kind::usage, "--rate, --remove-mean, --as and --minimum-phase are for text and MAT "
                                            "files; a recording knows its rate.");
        return importRecordings(options.recording, terminal);
    }
    if (options.files.size() > 1)
        throw Error(Error::Kind::usage, "Only recordings can be several files; '" + options.file + "' is none.");
    if (options.recording.given())
        throw Error(Error::Kind::usage,
                    "--plan, --gain and --calibration are for recordings (WAV, AIFF, CAF or FLAC); '" + options.file
                        + "' is none.");
    auto read = readAny(options);
    if (auto* spectra = std::get_if<Spectra>(&read)) {
        if (!options.name.empty())
            throw Error(Error::Kind::usage, "A frequency response keeps no name of the loudspeaker; leave --name out.");
        return importSpectra(*spectra, options.out, terminal);
    }
    auto& sweeps = std::get<SweepTake>(read);
    if (!options.name.empty())
        sweeps.take.driver.name = options.name;
    if (endingOf(options.out) == ".csv")
        writeCsv(sweeps.take, options.out);
    else
        writeSweepTake(sweeps, options.out);
    describe(sweeps.take, terminal, options.out);
}

}  // namespace

void addImport(CLI::App& app, Terminal& terminal)
{
    const auto [verb, o] = addVerb<ImportArguments>(
        app, terminal, step::measure, "import",
        "Turn recordings or a file of another program (CSV, text, MAT, ZMA, FRD) into a take, or a take into a CSV",
        [](const ImportArguments& a, Terminal& t) { run(a, t); });
    verb->add_option("FILE", o->files,
                     "recordings of one --plan (.wav, .aif, .caf, .flac), a text file (.csv, .txt, .zma, .frd, ...), a "
                     ".mat, or a take")
        ->required();
    verb->add_option("--out", o->out, "folder of the new take, or a .csv; for an impedance also a .zma")
        ->required()
        ->type_name("PLACE");
    addRecordingOptions(*verb, o->recording);
    verb->add_option("--map", o->map,
                     "for a recording CHANNEL=QUANTITY:FULLSCALE, the quantity at a sample of 1.0, for example "
                     "1=voltage:32, 2=current:-500mA (negative: "
                     "inverted), 3=loopback (the interface's output, straight into its input); channels are counted "
                     "from 1 through all files, or FILE:CHANNEL. "
                     "For other files: what a column is, by its title or its number from 1: V1=force:V, "
                     "2=current:mA, 1=time:ms, 1=frequency, "
                     "G_re=impedance.re, 3=displacement/voltage.magnitude:mm/V, 4=impedance.phase:rad. May be repeated")
        ->expected(1)
        ->take_all();
    verb->add_option("--as", o->as,
                     "what the response is, if the file does not say: impedance, response, displacement/voltage, ...")
        ->type_name("RESPONSE");
    verb->add_flag("--minimum-phase", o->minimumPhase, "give a magnitude without phase its minimum phase");
    verb->add_option("--rate", o->rate, "sample rate in Hz, when the file has none")->check(CLI::PositiveNumber);
    verb->add_option("--from", o->from, "first sample to take, counted from 0");
    verb->add_option("--to", o->to, "one past the last sample to take")->check(CLI::PositiveNumber);
    verb->add_flag("--remove-mean", o->removeMean, "subtract the mean of each channel");
    verb->add_option("--name", o->name, "name of the loudspeaker");
}

}  // namespace excursion::cli
