// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/Destination.h"
#include "Cli/Help.h"
#include "Cli/Manual.h"
#include "Cli/Terminal.h"
#include "Cli/Verbs.h"

#include "Engine/Error.h"

#include <glog/logging.h>

#include <exception>
#include <filesystem>
#include <iostream>
#include <memory>
#include <new>

namespace {

using namespace excursion;

constexpr auto tour = R"(Excursion finds out what a loudspeaker model is missing.

  excursion excite --out plan                 the signal to play, and its plan
  excursion measure --device 1 --plan plan --map 1=voltage:32 --map 2=current:4 --out take
                                              play it, record, and make a take of both; or, of what
  excursion import rec.wav --plan plan --map 1=voltage:32 --map 2=current:4 --out take
                                              another program has recorded meanwhile
  excursion check take                        is the take fit for use?
  excursion bla take                          frequency response, noise and distortion
  excursion fit take --out model.json         a loudspeaker model, the linear one first
  excursion compare take --model model.json   where it is wrong, and by how much
  excursion diagnose take --model model.json  which physical effect is missing
  excursion add take --model model.json stiffness --out better.json
                                              put it in, and refit
  excursion improve take --out ladder         all of this, until nothing is missing
  excursion simulate ladder/model.json in.wav --full-scale 10 --out played
                                              what the loudspeaker will do
  excursion parameters ladder --out ts.csv    Thiele/Small parameters and more, for other programs

No loudspeaker at hand? excursion virtual --seed 1 --out take draws one, with something hidden in it.
A take is a folder (measurement.json and its WAV), or a file of another program, such as a .zma, .csv or .txt.
Each verb has its own --help.)";

constexpr auto footer =
    R"(Exit codes: 0 done, 1 done and the answer is no, 2 a wrong option, 3 a file or device that cannot be used,
4 data that cannot answer the question, 5 a computation that failed, 6 stopped by Ctrl-C.)";

constexpr int internalError = 70;  // as sysexits.h has it; 1 is an answer

/// The arguments, last one first as CLI11 wants them. "--json out.json" is made "--json=out.json", and "--json" alone
/// "--json=-": an option whose value may be left out would take the take that follows it.
std::vector<std::string> argumentsFrom(int argc, char** argv)
{
    std::vector<std::string> arguments;
    for (int k = 1; k < argc; ++k) {
        std::string argument = argv[k];
        if (argument == "--json")
            argument += std::string("=")
                        + (k + 1 < argc && std::string_view(argv[k + 1]).ends_with(".json") ? argv[++k] : "-");
        arguments.insert(arguments.begin(), argument);
    }
    return arguments;
}

/// CLI11 would complain of a missing subcommand when one is misspelt.
void requireKnownVerb(const CLI::App& app, const std::vector<std::string>& arguments)
{
    if (arguments.empty() || arguments.back().starts_with('-'))
        return;
    std::string known;
    for (const auto* verb : app.get_subcommands([](const CLI::App*) { return true; })) {
        if (verb->get_name() == arguments.back())
            return;
        known += (known.empty() ? "" : ", ") + verb->get_name();
    }
    throw Error(Error::Kind::usage, "There is no verb \"" + arguments.back() + "\"; the known ones are " + known + ".");
}

int run(CLI::App& app, cli::Terminal& terminal, std::vector<std::string> arguments)
{
    try {
        requireKnownVerb(app, arguments);
        app.parse(std::move(arguments));
        return terminal.exitZero ? 0 : terminal.answer;
    } catch (const CLI::ParseError& e) {
        if (e.get_exit_code() == 0)  // --help and --version
            return app.exit(e);
        terminal.complain(std::string(e.what()) + " (see excursion --help)");
        return static_cast<int>(Error::Kind::usage);
    } catch (const Error& e) {
        terminal.complain(e.what());
        return e.exitCode();
    } catch (const std::filesystem::filesystem_error& e) {
        terminal.complain(e.what());
        return static_cast<int>(Error::Kind::input);
    } catch (const std::bad_alloc&) {
        terminal.complain("This computer has too little free memory for the work; use a shorter take.");
        return static_cast<int>(Error::Kind::numerical);
    } catch (const std::exception& e) {
        terminal.complain(std::string("Internal error, please report it: ") + e.what());
        return internalError;
    }
}

}  // namespace

int main(int argc, char** argv)
{
    FLAGS_minloglevel = google::GLOG_FATAL;  // Ceres reports trial steps that fail as errors: they are no news
    cli::Terminal terminal;
    CLI::App app(tour, "excursion");
    app.formatter(std::make_shared<cli::Help>());  // the verbs inherit it
    app.fallthrough();                             // so that --json may stand after the verb
    app.set_version_flag("--version", EXCURSION_VERSION);
    app.add_option("--json", terminal.jsonFile, "print one JSON document and nothing else, or write it to FILE.json")
        ->type_name("[FILE.json]");
    app.add_flag("--exit-zero", terminal.exitZero,
                 "exit with 0, not 1, when the work is done and its answer is no; for scripts that stop at failures");
    app.add_flag("--quiet", terminal.quiet, "print nothing but errors");
    app.add_flag("--progress", terminal.progressLines,
                 "tell on stderr how far the work is, in lines that a program can read");
    app.require_subcommand(1);
    app.parse_complete_callback([&terminal, argc, argv] {  // before the verb does its work
        if (terminal.jsonFile.empty() || terminal.jsonFile == "-")
            return;
        cli::requireFilePlace(terminal.jsonFile);
        for (int k = 1; k < argc; ++k) {
            const std::string_view given = argv[k];
            if (given == "--json")
                ++k;
            else if (!given.starts_with("--json="))
                cli::requireApart(std::string(given.substr(given.starts_with("--") ? given.find('=') + 1 : 0)),
                                  terminal.jsonFile);
        }
    });

    // In the order of the method: --help prints them so.
    cli::addExcite(app, terminal);
    cli::addCalibrate(app, terminal);
    cli::addMeasure(app, terminal);
    cli::addImport(app, terminal);
    cli::addVirtual(app, terminal);
    cli::addCheck(app, terminal);
    cli::addBla(app, terminal);
    cli::addHarmonics(app, terminal);
    cli::addIdentify(app, terminal);
    cli::addReduce(app, terminal);
    cli::addStabilize(app, terminal);
    cli::addPnlss(app, terminal);
    cli::addFit(app, terminal);
    cli::addCompare(app, terminal);
    cli::addDiagnose(app, terminal);
    cli::addAdd(app, terminal);
    cli::addImprove(app, terminal);
    cli::addRank(app, terminal);
    addReport(app, terminal);
    cli::addEffects(app, terminal);
    cli::addSimulate(app, terminal);
    cli::addWhatIf(app, terminal);
    cli::addParameters(app, terminal);
    cli::addPredistort(app, terminal);
    cli::addAdapt(app, terminal);
    cli::addCollect(app, terminal);

    cli::addDoctor(app, terminal);

    app.footer(footer);  // last, as the verbs would inherit it

    // For packages: no group, so that --help does not show them.
    const auto printing = [&app](auto make) {
        return [&app, make] {
            std::cout << make(app);
            throw CLI::Success();
        };
    };
    app.add_flag_callback("--manual", printing([](const CLI::App& a) { return cli::manualOf(a, EXCURSION_VERSION); }))
        ->group("");
    app.add_flag_callback("--bash-completion", printing([](const CLI::App& a) { return cli::bashCompletionOf(a); }))
        ->group("");

    return run(app, terminal, argumentsFrom(argc, argv));
}
