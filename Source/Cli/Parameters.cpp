// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/Destination.h"
#include "Cli/KnownMotion.h"
#include "Cli/ModelTables.h"
#include "Cli/OpenDriver.h"
#include "Cli/Terminal.h"
#include "Cli/Verbs.h"
#include "Engine/Document/DocumentFormat.h"
#include "Engine/Import/ReadTake.h"

#include "Engine/Check/PreparedTake.h"
#include "Engine/Datasheet/DatasheetFile.h"
#include "Engine/Datasheet/ResponseCurves.h"
#include "Engine/Datasheet/SpiceNetlist.h"
#include "Engine/Document/DraftFile.h"
#include "Engine/Document/Engineering.h"
#include "Engine/Document/JsonText.h"
#include "Engine/Document/TextFile.h"
#include "Engine/Document/Words.h"
#include "Engine/Error.h"
#include "Engine/Import/Export.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>

namespace excursion::cli {
namespace {

using Json = nlohmann::ordered_json;

struct ParametersArguments {
    std::string from, out, lawsOut, spice, zma, frd;
    std::vector<double> inductanceBand, band;
    KnownScale known;
    double level = 0.0;  ///< V rms; 0: not given
    int points = 41;

    bool sheetWanted() const { return !out.empty() || !lawsOut.empty() || !spice.empty(); }
};

void requireTableName(const std::string& path)
{
    if (!path.empty() && endingOf(path) != ".csv" && endingOf(path) != ".json")
        throw Error(Error::Kind::usage, "The file \"" + path + "\" should end in .csv or .json.");
}

/// Decimals that show the second digit of the error.
std::string shown(double value, double error)
{
    if (!std::isfinite(error) || error <= 0.0)
        return significant(value, 5);
    return fixed(value, std::clamp(static_cast<int>(std::ceil(1.0 - std::log10(error))), 0, 7));
}

void printFigures(const Datasheet& sheet, Terminal& terminal)
{
    std::vector<std::vector<std::string>> rows;
    std::string unknown, why;
    for (const auto& f : sheet.thieleSmall) {
        if (!f.why.empty()) {
            unknown += (unknown.empty() ? "" : why == f.why ? ", " : " (" + why + "); ") + f.symbol;
            why = f.why;
            continue;
        }
        const double value = f.value * f.perUnit, error = f.standardError * f.perUnit;
        rows.push_back({f.symbol, shown(value, error),
                        std::isfinite(error) && error > 0.0 ? significant(error, 2) : "-", f.sheetUnit, f.meaning});
    }
    terminal.table({"parameter", "value", "std error", "unit", ""}, rows);
    if (!unknown.empty())
        terminal.say(wrapped("Not said: " + unknown + " (" + why + ")."));
    for (const auto& remark : sheet.remarks)
        terminal.say(wrapped(remark));
}

void printInductance(const LossyInductance& inductance, Terminal& terminal)
{
    terminal.say("");
    if (inductance.lossless) {
        terminal.say("The inductance of the model has no losses: it is Le alone.");
        return;
    }
    std::vector<std::vector<std::string>> rows;
    for (const auto& form : inductance.forms) {
        std::string text;
        for (const auto& p : form.parameters) {
            const auto unit = displayUnit(p.value, p.unit);
            text += (text.empty() ? "" : ", ") + p.name + " = " + significant(p.value * unit.factor, 4)
                    + (unit.unit.empty() ? "" : " " + unit.unit);
        }
        rows.push_back({form.id, significant(form.errorPercent, 2) + " %", fixed(form.worstDb, 2), text});
    }
    terminal.say("Lossy inductance from " + significant(inductance.low, 3) + " to " + significant(inductance.high, 4)
                 + " Hz, beside Re = " + significant(inductance.Re, 4) + " ohm");
    terminal.table({"form", "error", "at most dB", "parameters"}, rows);
    terminal.say("Error: rms of the complex impedance with Re in it, and the largest of its magnitude.");
}

/// The curves of a take or of a model at a level; the files that were written.
void writeCurves(const ParametersArguments& options, const ScaledModel* given, const Measurement* measured,
                 Json& written, Terminal& terminal)
{
    Frf impedance, sound;
    Measurement played;
    std::pair<double, double> band {0.0, 0.0};
    if (given) {
        band = options.band.empty() ? bandOf(given->model) : std::pair(options.band[0], options.band[1]);
        if (options.level > 0.0) {
            curveFrequencies(band.first, band.second);
            if (!options.frd.empty())
                soundCurve(*given, {band.first});  // refuses a guess before the work
            played = playedAt(given->model, options.level, band.first, band.second, terminal.progress());
            measured = &played;
        }
    }
    const auto frequency = given ? curveFrequencies(band.first, band.second) : std::vector<double> {};
    if (!options.zma.empty())
        impedance = measured ? impedanceCurve(*measured, options.level) : impedanceCurve(given->model, frequency);
    if (!options.frd.empty())
        sound = measured ? soundCurve(*measured, options.level) : soundCurve(*given, frequency);
    if (!options.zma.empty()) {
        writeZma(impedance, options.zma);
        written.push_back(options.zma);
    }
    if (!options.frd.empty()) {
        writeFrd(sound, options.frd);
        written.push_back(options.frd);
    }
}

bool isTake(const std::string& path)
{
    namespace fs = std::filesystem;
    std::error_code ignored;
    if (fs::is_directory(path, ignored))
        return !fs::exists(fs::path(path) / "ladder.json", ignored);
    return fs::exists(path, ignored) && endingOf(path) != ".json";
}

void sayWritten(const Json& written, Terminal& terminal)
{
    const auto list = joined(written.get<std::vector<std::string>>());
    if (!list.empty())
        terminal.say("Wrote " + list + ".");
}

void runOnTake(const ParametersArguments& options, Terminal& terminal)
{
    if (options.sheetWanted() || options.known.mass || options.known.forceFactor || options.known.coneArea
        || !options.band.empty() || !options.inductanceBand.empty())
        throw Error(Error::Kind::usage,
                    "'" + options.from
                        + "' is a take: only --zma, --frd and --level are for one. Fit a model to it for the rest.");
    if (options.zma.empty() && options.frd.empty())
        throw Error(Error::Kind::usage,
                    "'" + options.from + "' is a take: say with --zma or --frd what to write, or fit a model to it.");
    const PreparedTake take(readMeasurement(options.from));
    Json document = DocumentFormat {"excursion-parameters"}.with({{"take", options.from}, {"wrote", Json::array()}});
    writeCurves(options, nullptr, take.inTime(), document["wrote"], terminal);
    sayWritten(document["wrote"], terminal);
    terminal.document(document);
}

void run(const ParametersArguments& options, Terminal& terminal)
{
    requireTableName(options.out);
    requireTableName(options.lawsOut);
    for (const auto* file : {&options.out, &options.lawsOut, &options.spice, &options.zma, &options.frd})
        if (!file->empty())
            requireFilePlace(*file);
    if (options.level > 0.0 && options.zma.empty() && options.frd.empty())
        throw Error(Error::Kind::usage, "--level is that of --zma and --frd; give one of them.");
    if (isTake(options.from))
        return runOnTake(options, terminal);

    const auto given = withKnown(openDriver(options.from), options.known);
    const auto& inductance = options.inductanceBand;
    const auto sheet = datasheetOf(given, inductance.empty() ? 0.0 : inductance[0],
                                   inductance.empty() ? 0.0 : inductance[1], options.points);
    Json document = DocumentFormat {"excursion-parameters"}.with({{"model", options.from}});
    document.update(toJson(sheet));
    auto written = Json::array();
    writeCurves(options, &given, nullptr, written, terminal);  // may refuse, and so comes first
    const auto table = [&](const std::string& file, const std::string& csv) {
        if (file.empty())
            return;
        endingOf(file) == ".json" ? writeJson(document, file) : publish(file, csv);
        written.push_back(file);
    };
    table(options.out, parametersCsv(sheet));
    table(options.lawsOut, lawsCsv(sheet));
    if (!options.spice.empty()) {
        publish(options.spice, spiceNetlist(given.model, std::filesystem::path(options.spice).stem().string()));
        written.push_back(options.spice);
    }

    printFigures(sheet, terminal);
    if (sheet.inductance)
        printInductance(*sheet.inductance, terminal);
    printLaws(sheet.laws, terminal);
    if (sheet.stroke) {
        terminal.say("");
        printLimits(*sheet.stroke, terminal);
    }
    sayWritten(written, terminal);
    document["wrote"] = written;
    terminal.document(document);
}

}  // namespace

void addParameters(CLI::App& app, Terminal& terminal)
{
    const auto [verb, o] = addVerb<ParametersArguments>(
        app, terminal, step::use, "parameters",
        "Thiele/Small parameters, lossy inductance, laws, SPICE, ZMA and FRD, for other programs", run);
    verb->add_option("MODEL", o->from, "the model, a .json; a ladder or its folder; or a take, for --zma and --frd")
        ->required();
    verb->add_option("--out", o->out, "the parameters, a .csv or .json")->type_name("FILE");
    verb->add_option(
            "--laws", o->lawsOut,
            "Bl(x), K(x), Cms(x), Le(x), Le(i), Rms(v) with 95 % bands and the limits of the stroke, a .csv or .json")
        ->type_name("FILE");
    verb->add_option("--points", o->points, "of each law")->check(CLI::Range(3, 100001))->capture_default_str();
    addMotionOptions(*verb, o->known);
    verb->add_option("--cone-area", o->known.coneArea, "area of the cone in m^2");
    verb->add_option("--inductance-band", o->inductanceBand,
                     "Hz, band in which the lossy inductance is fitted; by default from 3 fs to the highest frequency "
                     "that was measured")
        ->expected(2)
        ->delimiter(',')
        ->type_name("HZ");
    verb->add_option("--spice", o->spice, "the linear model as a SPICE subcircuit")->type_name("FILE");
    verb->add_option("--zma", o->zma, "the impedance")->type_name("FILE");
    verb->add_option("--frd", o->frd, "the sound pressure level at 1 m for 2.83 V")->type_name("FILE");
    verb->add_option("--band", o->band, "Hz, for --zma and --frd; by default where the model was measured")
        ->expected(2)
        ->delimiter(',')
        ->type_name("HZ");
    verb->add_option("--level", o->level,
                     "V rms for --zma and --frd: a multisine of that level for a model, one of its levels for a take; "
                     "by default small signals, or the loudest level of a take")
        ->check(CLI::PositiveNumber);
}

}  // namespace excursion::cli
