// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/Destination.h"
#include "Cli/OpenResponse.h"
#include "Cli/Terminal.h"
#include "Cli/Verbs.h"
#include "Engine/Import/ReadTake.h"

#include "Engine/Check/PreparedTake.h"
#include "Engine/Document/JsonText.h"
#include "Engine/Document/TextFile.h"
#include "Engine/Error.h"
#include "Engine/Estimate/Bla.h"
#include "Engine/Estimate/Distortion.h"
#include "Engine/Estimate/Periods.h"
#include "Engine/Estimate/RestGrowth.h"
#include "Engine/Estimate/Welch.h"
#include "Engine/Import/Export.h"
#include "Engine/Signal/Delay.h"
#include "Engine/Signal/Level.h"
#include "Engine/Take/ChannelNamed.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <memory>

namespace excursion::cli {
namespace {

using Json = nlohmann::ordered_json;

struct BlaArguments {
    std::string take, output, out;
    int level = -1;
    int segment = 0;
};

/// What one verb run found: the response, and the rows and fields that only one of the two estimators has.
struct Found {
    Frf frf;
    Json document;
    std::vector<std::string> header;
    std::vector<std::vector<double>> columns;  ///< after the frequency, in dB
    std::vector<std::string> remarks;
};

constexpr double nothing = -400.0;  ///< dB of a power of zero

double decibels(double powerRatio) { return powerRatio > 1e-40 ? 10.0 * std::log10(powerRatio) : nothing; }

std::vector<double> relativeTo(const std::vector<double>& variance, const Frf& frf)
{
    std::vector<double> db;
    for (std::size_t i = 0; i < variance.size(); ++i)
        db.push_back(decibels(variance[i] / std::norm(frf.value[i])));
    return db;
}

void add(Found& found, const std::string& title, std::vector<double> column)
{
    if (column.empty())
        return;
    found.header.push_back(title);
    found.columns.push_back(std::move(column));
}

Json json(const DetectionLines& lines, const std::optional<DistortionTotal>& total)
{
    Json object;
    if (total)
        object = {{"db", total->db}, {"significant", total->significant}};
    object["frequency"] = numbersOrNulls(lines.frequency);
    object["power"] = numbersOrNulls(lines.power);
    object["noise"] = numbersOrNulls(lines.noise);
    return object;
}

std::string remark(const char* parity, const std::optional<DistortionTotal>& total)
{
    if (!total)
        return std::string(parity) + " distortion: this grid leaves no such lines out";
    return std::string(parity) + " distortion: " + (total->significant ? "" : "below ") + fixed(total->db, 1)
           + " dB of the output" + (total->significant ? "" : " (not above the noise)");
}

Found fromPeriods(const Measurement& take, Quantity output, int level)
{
    const auto result = bla(take, output, level);
    Found found;
    found.frf = result.frf;
    found.document = {{"method", "periods"},
                      {"level", level},
                      {"levelRms", take.excitation->levels[static_cast<std::size_t>(level)]},
                      {"realizations", result.realizations},
                      {"periods", result.periods}};
    found.document["nonlinearVariance"] = numbersOrNulls(result.nonlinearVariance);
    found.document["stochasticNonlinear"] = numbersOrNulls(result.stochasticNonlinear);
    found.document["coherence"] = numbersOrNulls(result.coherence);
    add(found, "noise dB", relativeTo(result.frf.noiseVariance, result.frf));
    add(found, "total dB", relativeTo(result.frf.totalVariance, result.frf));
    add(found, "nonlinear dB", relativeTo(result.stochasticNonlinear, result.frf));
    found.remarks.push_back("noise and total: variance of this response over its power; nonlinear: of one realization");

    const auto& lines = take.excitation->lines;
    if (std::all_of(lines.begin(), lines.end(), [](int k) { return k % 2 != 0; })) {
        const auto levels = distortion(take, output, level);
        found.document["odd"] = json(levels.odd, levels.oddTotal);
        found.document["even"] = json(levels.even, levels.evenTotal);
        found.remarks.push_back(remark("odd", levels.oddTotal));
        found.remarks.push_back(remark("even", levels.evenTotal));
        if (levels.noiseDb) {
            found.document["noiseDb"] = *levels.noiseDb;
            found.remarks.push_back("noise: " + fixed(*levels.noiseDb, 1) + " dB of the output");
        }
    }
    return found;
}

Found fromRecord(const Measurement& take, Quantity output, int segment)
{
    const auto result = welch(take, output, {.segment = segment});
    Found found;
    found.frf = result.frf;
    found.document = {
        {"method", "welch"}, {"segments", result.segments}, {"effectiveAverages", result.effectiveAverages}};
    found.document["coherence"] = numbersOrNulls(result.coherence);
    found.document["inputPower"] = numbersOrNulls(result.inputPower);
    found.document["outputPower"] = numbersOrNulls(result.outputPower);
    found.document["nonCoherentPower"] = numbersOrNulls(result.nonCoherentPower);
    std::vector<double> added;
    double power = 0.0, all = 0.0;
    for (std::size_t i = 0; i < result.outputPower.size(); ++i) {
        added.push_back(decibels(result.nonCoherentPower[i] / result.outputPower[i]));
        power += result.nonCoherentPower[i];
        all += result.outputPower[i];
    }
    add(found, "not coherent dB", added);
    found.document["nonCoherentDb"] = decibels(power / all);
    found.remarks.push_back("not coherent with the input (noise and added distortion): "
                            + fixed(decibels(power / all), 1) + " dB of the output");
    const auto growth = restGrowth(take, output, {.segment = segment});
    found.document["rest"] = {{"verdict", name(growth.verdict)},
                              {"slope", growth.slope},
                              {"standardError", numberOrNull(growth.standardError)},
                              {"rangeDb", growth.range},
                              {"excessDb", numberOrNull(growth.excessDb)},
                              {"gainDb", growth.gainDb ? Json(*growth.gainDb) : Json()},
                              {"segments", growth.segments},
                              {"sentence", growth.sentence()}};
    found.remarks.push_back(growth.sentence());
    return found;
}

/// How late the output is, as one number for all frequencies.
void tellDelay(Found& found, const Measurement& take, Quantity output, int level, int segment)
{
    const auto &in = take.input(), &out = *take.find(output);
    if (take.length() < 16 || peakOf(in.samples) == 0.0 || peakOf(out.samples) == 0.0)
        return;
    const auto late = level >= 0
                          ? estimateDelay(averagePeriod(take, in, level, 0), averagePeriod(take, out, level, 0),
                                          {.period = take.excitation->period})
                          : estimateDelay(in.samples, out.samples,
                                          {.segment = WelchOptions {.segment = segment}.segmentOf(take.length())});
    found.document["delay"] = {{"samples", numberOrNull(late.samples)},
                               {"standardError", numberOrNull(late.standardError)},
                               {"inverted", late.inverted}};
    found.remarks.push_back("delay that explains the phase best, what a driver turns included: "
                            + fixed(late.samples, 2) + " samples, " + fixed(1e3 * late.samples / take.sampleRate, 3)
                            + " ms" + (late.inverted ? ", inverted" : ""));
}

/// One row each third of an octave: the line nearest to it.
void print(const Found& found, const std::string& title, Terminal& terminal)
{
    std::vector<std::string> header {"Hz", "magnitude", "phase deg"};
    header.insert(header.end(), found.header.begin(), found.header.end());
    std::vector<std::vector<std::string>> rows;
    double next = 0.0;
    for (std::size_t i = 0; i < found.frf.frequency.size(); ++i) {
        const double f = found.frf.frequency[i];
        if (f < next)
            continue;
        next = f * std::cbrt(2.0);
        rows.push_back({fixed(f, 1), significant(std::abs(found.frf.value[i])),
                        fixed(std::arg(found.frf.value[i]) * 180.0 / 3.14159265358979323846, 1)});
        for (const auto& column : found.columns)
            rows.back().push_back(column[i] > nothing ? fixed(column[i], 1) : "-");
    }
    terminal.say(title);
    terminal.table(header, rows);
    for (const auto& line : found.remarks)
        terminal.say(line);
}

void write(const Found& found, const Measurement& take, int level, const BlaArguments& options)
{
    const auto extension = endingOf(options.out);
    if (extension == ".json")
        return writeJson(found.document, options.out);
    if (extension == ".csv")
        return writeCsv(found.frf, options.out);
    if (extension == ".frd")
        return writeFrd(found.frf, options.out);
    auto impedance = level >= 0 ? bla(take, Quantity::voltage, level, Quantity::current).frf : found.frf;
    if (level < 0)
        for (auto& value : impedance.value)
            value = 1.0 / value;
    writeZma(impedance, options.out);
}

/// Said before the work, not after it.
void checkExtension(const BlaArguments& options)
{
    const auto extension = endingOf(options.out);
    if (options.out.empty() || extension == ".csv" || extension == ".frd" || extension == ".zma"
        || extension == ".json")
        return;
    throw Error(Error::Kind::usage, "The file \"" + options.out + "\" should end in .csv, .frd, .zma or .json.");
}

Json documentOf(const Frf& frf, const std::string& take, std::string_view input, std::string_view output)
{
    std::vector<double> re, im;
    for (const auto& value : frf.value) {
        re.push_back(value.real());
        im.push_back(value.imag());
    }
    Json document = blaFormat.with({{"take", take}, {"input", input}, {"output", output}});
    document["frequency"] = numbersOrNulls(frf.frequency);
    document["re"] = numbersOrNulls(re);
    document["im"] = numbersOrNulls(im);
    document["noiseVariance"] = numbersOrNulls(frf.noiseVariance);
    document["totalVariance"] = numbersOrNulls(frf.totalVariance);
    return document;
}

/// A file that holds the response already: it is shown, and turned into another format.
void showResponse(const BlaArguments& options, Terminal& terminal)
{
    if (options.level >= 0 || options.segment > 0)
        throw Error(Error::Kind::usage,
                    "'" + options.take + "' is a frequency response already; leave --level and --segment out.");
    const auto open = openResponse({options.take, options.output, "", -1});
    Found found;
    found.frf = open.frf;
    found.remarks = open.remarks;
    found.document = documentOf(open.frf, options.take, open.input, open.output);
    found.document["method"] = "file";
    const bool impedance = open.output == "voltage" && open.input == "current";
    if (endingOf(options.out) == ".zma" && !impedance && (open.output != "current" || open.input != "voltage"))
        throw Error(Error::Kind::usage,
                    "A .zma holds an impedance, but this is " + open.output + " / " + open.input + ".");
    print(found,
          impedance ? std::string("impedance, voltage / current, as the file has it")
                    : open.output + " / " + open.input + ", as the file has it",
          terminal);
    if (!options.out.empty()) {
        if (endingOf(options.out) == ".zma") {
            auto z = open.frf;
            if (!impedance)
                for (auto& value : z.value)
                    value = 1.0 / value;
            writeZma(z, options.out);
        } else {
            write(found, {}, -1, options);
        }
        terminal.say("Wrote " + options.out + ".");
    }
    terminal.document(found.document);
}

void run(const BlaArguments& options, Terminal& terminal)
{
    checkExtension(options);
    const PreparedTake prepared(readTake(options.take));
    if (prepared.asResponses())
        return showResponse(options, terminal);
    const auto& take = prepared.settled();
    const auto output = outputNamed(take, options.output, take.input().quantity).quantity;
    if (endingOf(options.out) == ".zma" && (output != Quantity::current || take.input().quantity != Quantity::voltage))
        throw Error(Error::Kind::usage, "A .zma holds an impedance: ask for --output current.");
    const bool periodic = take.hasPeriods();
    const int level = take.levelOf(options.level);
    auto found = periodic ? fromPeriods(take, output, level) : fromRecord(take, output, options.segment);
    tellDelay(found, take, output, level, options.segment);

    const auto input = take.input().quantity;
    auto head = documentOf(found.frf, options.take, name(input), name(output));
    head.update(found.document);
    found.document = std::move(head);

    print(found,
          std::string(name(output)) + " / " + std::string(name(input))
              + (periodic ? ", best linear approximation at level " + std::to_string(level) + " ("
                                + significant(take.excitation->levels[static_cast<std::size_t>(level)], 3) + " rms)"
                          : std::string(", cross-spectra of the whole record")),
          terminal);
    if (!options.out.empty()) {
        write(found, take, level, options);
        terminal.say("Wrote " + options.out + ".");
    }
    terminal.document(found.document);
}

}  // namespace

void addBla(CLI::App& app, Terminal& terminal)
{
    const auto [verb, options] = addVerb<BlaArguments>(
        app, terminal, step::look, "bla", "Frequency response, with its noise and its odd and even distortion", run);
    verb->add_option("TAKE", options->take,
                     "the take: a folder, a .csv of time signals, or a file that is a response already")
        ->required();
    verb->add_option("--level", options->level, "number of the level, 0 the quietest; by default the loudest")
        ->check(CLI::NonNegativeNumber);
    verb->add_option("--output", options->output, "the channel to explain; by default the first beside the input");
    verb->add_option("--segment", options->segment,
                     "samples of a segment, for a take without periods; by default 8192, fewer for a short record");
    verb->add_option("--out", options->out, "also write a .csv, .frd, .zma (of --output current) or .json")
        ->type_name("FILE");
}

}  // namespace excursion::cli
