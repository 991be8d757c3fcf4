// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/Destination.h"
#include "Cli/Terminal.h"
#include "Cli/Verbs.h"
#include "Engine/Import/ReadTake.h"
#include "Engine/Take/SweepTake.h"

#include "Engine/Document/DraftFile.h"
#include "Engine/Document/JsonText.h"
#include "Engine/Document/TextFile.h"
#include "Engine/Error.h"
#include "Engine/Polynomial/Hammerstein/HarmonicDistortionFile.h"
#include "Engine/Polynomial/Hammerstein/ParallelHammersteinFile.h"
#include "Engine/Polynomial/Hammerstein/SweepModel.h"
#include "Engine/Take/ChannelNamed.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <memory>

namespace excursion::cli {
namespace {

struct HarmonicsArguments {
    std::string take, output, out, model;
    int level = -1;
    HarmonicOptions options;
};

/// Loudest and most wanted first: what a microphone hears, what the cone does, what the amplifier gives.
Quantity heardBest(const Measurement& take)
{
    for (const auto wanted :
         {Quantity::pressure, Quantity::displacement, Quantity::velocity, Quantity::acceleration, Quantity::current})
        if (take.find(wanted))
            return wanted;
    throw Error(Error::Kind::data, "The take has no channel beside its input.");
}

std::optional<Quantity> wantedOutput(const HarmonicsArguments& arguments, const Measurement& take)
{
    if (arguments.output.empty())
        return std::nullopt;
    return channelNamed(take, arguments.output).quantity;
}

/// "-41.2", "< -93.0" where it does not rise above the noise, "-" outside of what was played.
std::string harmonicCell(double db, double floorDb)
{
    if (std::isfinite(db))
        return fixed(db, 1);
    return std::isfinite(floorDb) ? "< " + fixed(floorDb, 1) : "-";
}

/// One row each third of an octave.
void print(const HarmonicCurves& curves, int highest, double pointsPerOctave, Terminal& terminal)
{
    std::vector<std::string> header {"Hz", "fundamental"};
    for (int m = 2; m <= highest; ++m)
        header.push_back("H" + std::to_string(m) + " dB");
    header.insert(header.end(), {"THD dB", "THD %"});
    std::vector<std::vector<std::string>> rows;
    const auto every = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(pointsPerOctave / 3.0)));
    for (std::size_t i = 0; i < curves.frequency.size(); i += every) {
        const auto row = static_cast<Eigen::Index>(i);
        rows.push_back({fixed(curves.frequency[i], 1), significant(curves.fundamental[i])});
        for (Eigen::Index m = 0; m < curves.db.cols(); ++m)
            rows.back().push_back(harmonicCell(curves.db(row, m), curves.floorDb(row, m)));
        rows.back().push_back(harmonicCell(curves.thdDb[i], curves.thdFloorDb[i]));
        const double thd = curves.thdDb[i];
        rows.back().push_back(std::isfinite(thd) ? significant(100.0 * std::pow(10.0, thd / 20.0), 3) : "-");
    }
    terminal.say(std::string(name(curves.quantity)) + " at " + significant(curves.level, 3)
                 + " V rms: the fundamental in " + curves.unit + " rms, harmonics in dB of it");
    terminal.table(header, rows);
}

nlohmann::ordered_json keepModel(const HarmonicsArguments& arguments, const SweepTake& take, Terminal& terminal)
{
    const auto output = wantedOutput(arguments, take.take).value_or(heardBest(take.take));
    const auto found = sweepModel(take, output, arguments.options);
    const auto input = std::string(name(take.take.input().quantity));
    writeJson(toJson(Named<ParallelHammerstein> {take.take.driver.name, input, std::string(name(output)), found.model}),
              arguments.model);
    std::vector<std::vector<std::string>> rows;
    const auto& levels = take.sweep->levels;
    for (std::size_t k = 0; k < levels.size(); ++k)
        rows.push_back({significant(levels[k], 3), errorText(found.errorDb[k]),
                        k + 1 == levels.size() ? "identified from it" : "not seen before"});
    terminal.say("Parallel Hammerstein model of the " + std::string(name(output)) + ", degree "
                 + std::to_string(found.model.degree()) + ", " + std::to_string(found.model.length())
                 + " taps a branch: " + arguments.model);
    terminal.table({"V rms", "error dB", "level"}, rows);
    return {{"path", arguments.model},      {"output", name(output)}, {"degree", found.model.degree()},
            {"taps", found.model.length()}, {"levels", levels},       {"errorDb", numbersOrNulls(found.errorDb)}};
}

void run(const HarmonicsArguments& arguments, Terminal& terminal)
{
    if (!arguments.out.empty()) {
        if (endingOf(arguments.out) != ".csv")
            throw Error(Error::Kind::usage, "The file \"" + arguments.out + "\" should end in .csv.");
        requireFilePlace(arguments.out);
    }
    if (!arguments.model.empty())
        requireFilePlace(arguments.model);
    const auto take = readSweepTake(arguments.take);
    const auto wanted = wantedOutput(arguments, take.take);
    if (take.sweep && arguments.level >= static_cast<int>(take.sweep->levels.size()))
        throw Error(Error::Kind::usage,
                    "The take has " + std::to_string(take.sweep->levels.size()) + " levels, numbered from 0.");
    auto found = harmonicDistortion(take, arguments.options, terminal.progress());
    std::erase_if(found.curves, [&](const HarmonicCurves& c) {
        return (wanted && c.quantity != *wanted)
               || (arguments.level >= 0 && c.level != take.sweep->levels[static_cast<std::size_t>(arguments.level)]);
    });
    const auto input = take.take.input().quantity;
    for (const auto& curves : found.curves)
        if (curves.quantity != input || wanted == input)
            print(curves, found.highest, arguments.options.pointsPerOctave, terminal);
    terminal.say("\"<\": not above what noise, or the drive's own harmonics, may look like there; \"-\": outside of "
                 "what was played and sampled.");
    for (const auto& remark : found.remarks)
        terminal.say(wrapped("remark  " + remark, 8));
    auto document = toJson(found);
    document["take"] = arguments.take;
    if (!arguments.model.empty())
        document["model"] = keepModel(arguments, take, terminal);
    if (!arguments.out.empty()) {
        publish(arguments.out, harmonicsCsv(found));
        terminal.say("Wrote " + arguments.out + ".");
    }
    terminal.document(document);
}

}  // namespace

void addHarmonics(CLI::App& app, Terminal& terminal)
{
    const auto [verb, o] = addVerb<HarmonicsArguments>(
        app, terminal, step::look, "harmonics",
        "Harmonic distortion over frequency (H2, H3, ... and THD) of a take of sweeps", run);
    verb->add_option("TAKE", o->take, "the take: a recording of a plan of excite --sweep, imported")->required();
    verb->add_option("--highest", o->options.highest, "the highest harmonic")
        ->capture_default_str()
        ->check(CLI::Range(2, 20));
    verb->add_option("--points", o->options.pointsPerOctave, "points of a curve per octave")
        ->capture_default_str()
        ->check(CLI::Range(1.0, 96.0));
    verb->add_option("--output", o->output, "one channel; by default all, and --model uses the sound");
    verb->add_option("--level", o->level, "number of the level, 0 the quietest; by default all")
        ->check(CLI::NonNegativeNumber);
    verb->add_option("--out", o->out, "the curves as a table")->type_name("FILE.csv");
    verb->add_option("--model", o->model, "keep a parallel Hammerstein model of the loudest level")
        ->type_name("FILE.json");
    verb->footer("excursion report draws what --json FILE writes; excursion simulate plays what --model keeps.");
}

}  // namespace excursion::cli
