// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/Terminal.h"
#include "Cli/Verbs.h"

#include "Engine/Document/DocumentFormat.h"
#include "Engine/Error.h"
#include "Engine/Signal/Level.h"
#include "Engine/Take/ExcitationPlan.h"
#include "Engine/Take/SweepTake.h"
#include "Engine/Take/TakeFile.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <memory>

namespace excursion::cli {
namespace {

struct ExciteArguments {
    ExcitationPlanOptions plan;
    std::vector<double> band {20.0, 20000.0};
    double fullScale = 0.0;  ///< V; 0: chosen
    std::string grid = "odd-random", shape = "pink", out;
    bool sweeps = false;
    SweepExcitation sweep;
    std::vector<double> fades {0.1, 0.01};
};

/// Takes the wished full scale. Throws Error (usage) where the excitation does not fit below it.
void setFullScale(Channel& voltage, double wished)
{
    const double peak = peakOf(voltage.samples);
    if (wished > 0 && wished < peak)
        throw Error(Error::Kind::usage, "The excitation peaks at " + fixed(peak, 2) + " V, above the full scale of "
                                            + fixed(wished, 2) + " V; raise --full-scale or lower --levels.");
    if (wished > 0)
        voltage.fullScale = wished;
}

void runSweeps(ExciteArguments options, Terminal& terminal)
{
    auto& sweep = options.sweep;
    const double rate = options.plan.multisine.sampleRate;
    sweep.bandLow = options.band[0];
    sweep.bandHigh = options.band[1];
    sweep.levels = options.plan.levels;
    sweep.fadeIn = options.fades[0];
    sweep.fadeOut = options.fades[1];
    SweepTake plan {planSweep(sweep, rate), sweep};
    plan.sweep->seconds = sweep.sweep(rate, 0).seconds();  // what was wished, synchronized
    auto& voltage = plan.take.channels.front();
    const double peak = peakOf(voltage.samples);
    setFullScale(voltage, options.fullScale);
    writeSweepPlan(plan, options.out);

    const double seconds = static_cast<double>(plan.take.length()) / rate;
    terminal.say("Wrote " + options.out + "/excitation.wav, " + fixed(seconds, 2) + " s, and its plan.");
    std::vector<std::vector<std::string>> rows;
    for (std::size_t i = 0; i < sweep.levels.size(); ++i)
        rows.push_back({significant(sweep.levels[i]), significant(peak * sweep.levels[i] / sweep.levels.back()),
                        fixed(static_cast<double>(i) * seconds / static_cast<double>(sweep.levels.size()), 2)});
    terminal.table({"level V rms", "peak V", "starts at s"}, rows);
    terminal.say("Synchronized sweeps of " + fixed(plan.sweep->seconds, 3) + " s, "
                 + (sweep.repeats > 1 ? std::to_string(sweep.repeats) + " times each, " : "") + "with "
                 + significant(sweep.silence) + " s of silence behind them. A sample of 1.0 stands for "
                 + significant(voltage.fullScale) + " V at the loudspeaker: set the amplifier's gain so.");
    terminal.document(DocumentFormat {"excursion-excite"}.with({{"folder", options.out},
                                                                {"audio", "excitation.wav"},
                                                                {"plan", "plan.json"},
                                                                {"kind", "sweep"},
                                                                {"samples", plan.take.length()},
                                                                {"seconds", seconds},
                                                                {"sweepSeconds", plan.sweep->seconds},
                                                                {"repeats", sweep.repeats},
                                                                {"fullScale", voltage.fullScale},
                                                                {"peak", peak},
                                                                {"levels", sweep.levels}}));
}

void run(ExciteArguments options, Terminal& terminal)
{
    if (options.sweeps)
        return runSweeps(std::move(options), terminal);
    auto& plan = options.plan;
    plan.multisine.grid = gridNamed(options.grid).value();  // CLI11 let only known names pass
    plan.multisine.shape = shapeNamed(options.shape).value();
    plan.multisine.bandLow = options.band[0];
    plan.multisine.bandHigh = options.band[1];
    auto take = planExcitation(plan);
    auto& voltage = take.channels.front();
    const double peak = peakOf(voltage.samples);
    setFullScale(voltage, options.fullScale);
    writePlan(take, options.out);

    const auto& e = *take.excitation;
    const double seconds = static_cast<double>(e.totalSamples()) / take.sampleRate;
    terminal.say("Wrote " + options.out + "/excitation.wav, " + fixed(seconds, 2) + " s, and its plan.");
    terminal.table({"level V rms", "peak V", "starts at s"}, [&] {
        std::vector<std::vector<std::string>> rows;
        const double loudest = e.levels.back();
        for (std::size_t i = 0; i < e.levels.size(); ++i)
            rows.push_back({significant(e.levels[i]), significant(peak * e.levels[i] / loudest),
                            fixed(static_cast<double>(i) * seconds / static_cast<double>(e.levels.size()), 2)});
        return rows;
    }());
    terminal.say(std::to_string(e.lines.size()) + " lines, " + fixed(take.sampleRate / e.period, 3)
                 + " Hz apart at the least. A sample of 1.0 stands for " + significant(voltage.fullScale)
                 + " V at the loudspeaker: set the amplifier's gain so.");
    terminal.document(
        DocumentFormat {"excursion-excite"}.with({{"folder", options.out},
                                                  {"audio", "excitation.wav"},
                                                  {"plan", "plan.json"},
                                                  {"samples", e.totalSamples()},
                                                  {"seconds", seconds},
                                                  {"fullScale", voltage.fullScale},
                                                  {"peak", peak},
                                                  {"levels", e.levels},
                                                  {"lines", e.lines.size()},
                                                  {"detectionLines", oddDetectionLines(e.lines).size()}}));
}

}  // namespace

void addExcite(CLI::App& app, Terminal& terminal)
{
    const auto [verb, o] = addVerb<ExciteArguments>(app, terminal, step::measure, "excite",
                                                    "Write the multisine, or the sweeps, to play, and the plan",
                                                    [](const ExciteArguments& a, Terminal& t) { run(a, t); });
    verb->add_option("--out", o->out, "folder for excitation.wav and plan.json")->required()->type_name("DIR");
    auto& m = o->plan.multisine;
    verb->add_option("--levels", o->plan.levels, "V rms, quiet to loud")->delimiter(',')->capture_default_str();
    verb->add_option("--realizations", o->plan.realizations, "draws of the phases at each level")
        ->capture_default_str();
    verb->add_option("--periods", o->plan.periods, "periods to be used in each realization")->capture_default_str();
    verb->add_option("--settle", o->plan.settlePeriods, "periods before them, for the loudspeaker to settle")
        ->capture_default_str();
    verb->add_option("--period", m.period, "samples of one period")->capture_default_str();
    verb->add_option("--rate", m.sampleRate, "sample rate in Hz")->capture_default_str();
    verb->add_option("--band", o->band, "lowest and highest frequency in Hz")
        ->expected(2)
        ->delimiter(',')
        ->capture_default_str();
    verb->add_option("--grid", o->grid,
                     "which frequencies are excited; odd-random shows even and odd distortion between them")
        ->check(CLI::IsMember({"full", "odd", "odd-odd", "odd-random", "R10", "R20", "R40", "R80"}))
        ->capture_default_str();
    verb->add_option("--shape", o->shape, "amplitude over frequency")
        ->check(CLI::IsMember({"white", "pink", "red"}))
        ->capture_default_str();
    verb->add_option("--group", m.groupSize, "odd-random: odd lines in a group that misses one")->capture_default_str();
    verb->add_option("--seed", m.seed, "of the lines and phases; the same seed gives the same bytes")
        ->capture_default_str();
    verb->add_option("--full-scale", o->fullScale, "V at the loudspeaker for a sample of 1.0 (chosen when not given)")
        ->check(CLI::PositiveNumber);
    auto* sweep = verb->add_flag("--sweep", o->sweeps,
                                 "synchronized exponential sweeps in place of multisines: for the curves of harmonic "
                                 "distortion that excursion harmonics makes");
    const std::string group = "Sweeps";
    verb->add_option("--seconds", o->sweep.seconds, "of one sweep, about")
        ->capture_default_str()
        ->needs(sweep)
        ->group(group);
    verb->add_option("--silence", o->sweep.silence, "s of silence after each sweep, which shows the noise")
        ->capture_default_str()
        ->needs(sweep)
        ->group(group);
    verb->add_option("--repeats", o->sweep.repeats, "how often a sweep is played at each level")
        ->capture_default_str()
        ->needs(sweep)
        ->group(group);
    verb->add_option("--fades", o->fades, "s at the beginning and the end of a sweep")
        ->expected(2)
        ->delimiter(',')
        ->capture_default_str()
        ->needs(sweep)
        ->group(group);
    for (const char* multisine :
         {"--realizations", "--periods", "--settle", "--period", "--grid", "--shape", "--group", "--seed"})
        sweep->excludes(verb->get_option(multisine));
}

}  // namespace excursion::cli
