// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/ModelTables.h"
#include "Cli/OpenTake.h"
#include "Cli/Terminal.h"
#include "Cli/Verbs.h"

#include "Engine/Diagnosis/Compare.h"
#include "Engine/Diagnosis/ComparisonFile.h"
#include "Engine/Diagnosis/DiagnosisFile.h"
#include "Engine/Document/Engineering.h"
#include "Engine/Loudspeaker/ModelFile.h"
#include "Engine/Loudspeaker/Seen.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <memory>

namespace excursion::cli {
namespace {

using Rows = std::vector<std::vector<std::string>>;

struct CompareArguments {
    std::string take, model;
};

/// The largest of what the error is made of; within a decibel of the noise it is noise.
std::string kindOf(const ErrorLevel& level, const ErrorKinds& kinds)
{
    if (level.noiseFloorDb && level.db < *level.noiseFloorDb + 1.0)
        return "noise";
    std::string best = "-";
    double most = -1e9;
    const auto look = [&](const std::optional<double>& db, const char* what) {
        if (db && *db > most) {
            most = *db;
            best = what;
        }
    };
    look(kinds.linear, "linear");
    look(kinds.odd, "odd");
    look(kinds.even, "even");
    return best;
}

/// Each channel at each level, then over all levels.
void printLevels(const Comparison& comparison, const std::string& unit, Terminal& terminal)
{
    Rows rows;
    for (const auto& channel : comparison.channels)
        for (std::size_t k = 0; k < channel.byLevel.size(); ++k) {
            const auto& level = channel.byLevel[k];
            const auto kinds = k < channel.kindsByLevel.size() ? channel.kindsByLevel[k] : ErrorKinds {};
            rows.push_back({k == 0 ? std::string(name(channel.quantity)) : std::string(),
                            comparison.levels[k] > 0.0 ? significant(comparison.levels[k], 3) : "-", fixed(level.db, 1),
                            decibelText(level.noiseFloorDb),
                            chiSquaredText(level.chiSquaredPerValue, comparison.noiseKnown), decibelText(kinds.linear),
                            decibelText(kinds.odd), decibelText(kinds.even), kindOf(level, kinds)});
        }
    terminal.table({"channel", unit + " rms", "error dB", "noise dB", chiSquaredTitle, "excited dB", "odd dB",
                    "even dB", "mostly"},
                   rows);
    terminal.say(
        "Excited, odd, even: the error on the lines that were played, and on the odd and even lines between them.");
}

/// Error over measurement in an octave, dB; empty where the channel holds little but noise.
std::optional<double> errorWithin(const ErrorSpectrum& s, double low, double high)
{
    double error = 0.0, measured = 0.0, noise = 0.0;
    for (std::size_t k = 0; k < s.frequency.size(); ++k)
        if (s.frequency[k] >= low && s.frequency[k] < high) {
            error += s.error[k] * s.error[k];
            measured += s.measured[k] * s.measured[k];
            if (k < s.noise.size() && std::isfinite(s.noise[k]))
                noise += s.noise[k] * s.noise[k];
        }
    if (measured <= 4.0 * noise)
        return std::nullopt;
    return 10.0 * std::log10(std::max(error / measured, 1e-30));
}

/// One row an octave, at the loudest level.
void printSpectrum(const Comparison& comparison, Terminal& terminal)
{
    std::vector<std::string> header {"octave Hz"};
    for (const auto& channel : comparison.channels)
        header.push_back(titleOf(channel) + " dB");
    Rows rows;
    for (const double centre :
         {2.0, 4.0, 8.0, 16.0, 31.5, 63.0, 125.0, 250.0, 500.0, 1000.0, 2000.0, 4000.0, 8000.0, 16000.0, 32000.0}) {
        std::vector<std::string> row {significant(centre)};
        bool any = false;
        for (const auto& channel : comparison.channels) {
            const auto error = channel.spectrumByLevel.empty()
                                   ? std::nullopt
                                   : errorWithin(channel.spectrumByLevel.back(), centre / std::sqrt(2.0),
                                                 centre * std::sqrt(2.0));
            any = any || error;
            row.push_back(decibelText(error));
        }
        if (any)
            rows.push_back(std::move(row));
    }
    if (rows.empty())
        return;
    terminal.say("");
    terminal.say(std::string("Error over measurement") + (comparison.levels.size() > 1 ? " at the loudest level" : ""));
    terminal.table(header, rows);
}

/// Where the missing law shows its shape: the residual force and voltage at five places of what they are sorted by.
void printResiduals(const Comparison& comparison, Terminal& terminal)
{
    Rows rows;
    for (const auto& curve : comparison.residuals) {
        if (curve.argument.size() < 5)
            continue;
        double largest = 0.0, scatter = 0.0;
        for (std::size_t k = 0; k < curve.mean.size(); ++k)
            if (std::isfinite(curve.mean[k])) {
                largest = std::max(largest, std::abs(curve.mean[k]));
                scatter = std::max(scatter, curve.scatter[k]);
            }
        const auto unit = displayUnit(std::max(largest, scatter), curve.unit);
        const auto across = displayUnit(curve.argument.back(), curve.againstUnit);
        std::vector<std::string> row {curve.residual + " over " + curve.against,
                                      significant(curve.argument.front() * across.factor, 3) + " .. "
                                          + significant(curve.argument.back() * across.factor, 3) + " " + across.unit};
        for (std::size_t n = 0; n < 5; ++n) {
            const double mean = curve.mean[n * (curve.mean.size() - 1) / 4];
            row.push_back(std::isfinite(mean) ? fixed(mean * unit.factor, 2) : "-");
        }
        row.push_back(fixed(scatter * unit.factor, 2));
        row.push_back(unit.unit);
        rows.push_back(std::move(row));
    }
    if (rows.empty())
        return;
    terminal.say("");
    terminal.say("What the model lacks, sorted by motion: residual force and voltage at the loudest level");
    terminal.table({"residual", "range", "least", "half", "rest", "half", "most", "scatter", "unit"}, rows);
}

void run(const CompareArguments& options, Terminal& terminal)
{
    const auto model = readModel(options.model);
    const auto open = openTake(options.take);
    requireSameKind(model, seenIn(open.take.either()));
    const auto comparison = open.take.asResponses() ? compare(model, *open.take.asResponses())
                                                    : compare(model, recordFor(model, open), {}, terminal.progress());
    sayProblems(open.take.report().problems, terminal);
    if (open.take.asResponses())
        printErrors(comparison, terminal);
    else
        printLevels(comparison, open.take.measurement().input().unit, terminal);
    if (comparison.sectionMoves)
        terminal.say(wrapped(told(*comparison.sectionMoves)));
    printSpectrum(comparison, terminal);
    printResiduals(comparison, terminal);
    auto document = toJson(comparison);
    document["take"] = options.take;
    document["model"] = options.model;
    document["problems"] = toJson(open.take.report().problems);
    terminal.document(document);
}

}  // namespace

void addCompare(CLI::App& app, Terminal& terminal)
{
    const auto [verb, o] = addVerb<CompareArguments>(app, terminal, step::fit, "compare",
                                                     "Where a model and a take differ, by how much, and how", run);
    verb->add_option("TAKE", o->take,
                     "the take: a folder, a .csv, or an impedance or other response (.zma, .frd, .txt)")
        ->required();
    verb->add_option("--model", o->model, "the model, a .json")->required()->type_name("FILE");
}

}  // namespace excursion::cli
