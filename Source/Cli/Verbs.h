// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CLI/CLI.hpp>

#include <memory>
#include <utility>

namespace excursion::cli {

class Terminal;

/// The steps of the method; `excursion --help` groups the verbs by them.
namespace step {
inline constexpr auto measure = "1. Measure the loudspeaker";
inline constexpr auto look = "2. See whether the take is fit for use, and what is in it";
inline constexpr auto fit = "3. Fit a model and see where it fails";
inline constexpr auto diagnose = "4. Find what the model is missing, and add it";
inline constexpr auto use = "5. Use the model";
inline constexpr auto batch = "6. Many loudspeakers";
inline constexpr auto around = "Around it";
}  // namespace step

/// A verb and where its options go.
template <class Arguments>
struct Verb {
    CLI::App* app;
    std::shared_ptr<Arguments> arguments;
};

/// Adds a verb that runs `run` once its options are parsed; it throws Error. A verb is one file. Give paths as
/// std::string: CLI11 would split a std::filesystem::path at its blanks.
template <class Arguments>
Verb<Arguments> addVerb(CLI::App& app, Terminal& terminal, const char* group, const char* name, const char* help,
                        void (*run)(const Arguments&, Terminal&))
{
    auto arguments = std::make_shared<Arguments>();
    auto* verb = app.add_subcommand(name, help)->group(group);
    verb->callback([arguments, run, &terminal] { run(*arguments, terminal); });
    return {verb, std::move(arguments)};
}

// Declared here in the order of the method, called in the same order by main.
void addExcite(CLI::App&, Terminal&);
void addVirtual(CLI::App&, Terminal&);
void addCalibrate(CLI::App&, Terminal&);
void addMeasure(CLI::App&, Terminal&);
void addImport(CLI::App&, Terminal&);
void addCheck(CLI::App&, Terminal&);
void addBla(CLI::App&, Terminal&);
void addHarmonics(CLI::App&, Terminal&);
void addIdentify(CLI::App&, Terminal&);
void addReduce(CLI::App&, Terminal&);
void addStabilize(CLI::App&, Terminal&);
void addPnlss(CLI::App&, Terminal&);
void addFit(CLI::App&, Terminal&);
void addCompare(CLI::App&, Terminal&);
void addDiagnose(CLI::App&, Terminal&);
void addAdd(CLI::App&, Terminal&);
void addImprove(CLI::App&, Terminal&);
void addRank(CLI::App&, Terminal&);
void addReport(CLI::App&, Terminal&);
void addEffects(CLI::App&, Terminal&);
void addSimulate(CLI::App&, Terminal&);
void addWhatIf(CLI::App&, Terminal&);
void addParameters(CLI::App&, Terminal&);
void addPredistort(CLI::App&, Terminal&);
void addAdapt(CLI::App&, Terminal&);
void addCollect(CLI::App&, Terminal&);
void addDoctor(CLI::App&, Terminal&);

}  // namespace excursion::cli
