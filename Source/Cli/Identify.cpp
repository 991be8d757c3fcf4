// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/Alpha.h"
#include "Cli/Destination.h"
#include "Cli/MotorCone.h"
#include "Cli/OpenResponse.h"
#include "Cli/Terminal.h"
#include "Cli/Verbs.h"

#include "Engine/Document/DocumentFormat.h"
#include "Engine/Document/JsonText.h"
#include "Engine/Fractional/FractionalIdentificationFile.h"
#include "Engine/GreyBox/MixedImpedance.h"
#include "Engine/Linear/IdentificationFile.h"
#include "Engine/Signal/Level.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>

namespace excursion::cli {
namespace {

using Json = nlohmann::ordered_json;

struct IdentifyArguments {
    ResponseChoice response;
    std::string validation, out, alpha;
    std::vector<int> orders;
    std::vector<double> band;
    std::optional<int> cone;
    std::optional<double> delay;
    bool discrete = false, unrefined = false, quick = false, unstable = false, mixed = false;
};

/// Without --order all from 1 to 8 are tried: a loudspeaker in a box with eddy currents has about 6.
std::vector<int> ordersFrom(std::vector<int> orders, const FrequencyData& data)
{
    if (orders.empty())
        return ordersWithin({1, 2, 3, 4, 5, 6, 7, 8}, data);
    std::sort(orders.begin(), orders.end());
    orders.erase(std::unique(orders.begin(), orders.end()), orders.end());
    return orders;
}

void print(const OrderSweep& sweep, Terminal& terminal)
{
    std::vector<std::vector<std::string>> rows;
    for (const auto& e : sweep.entries)
        rows.push_back({std::to_string(e.order), fixed(e.found.errorDb, 1), fixed(decibelsOf(e.found.cost), 1),
                        significant(e.mdl, 6), e.validationDb ? fixed(*e.validationDb, 1) : "-",
                        e.found.stable ? "yes" : "no", e.found.start});
    terminal.table({"order", "error dB", "weighted dB", "MDL", "validation dB", "stable", "from"}, rows);
}

/// A state-space model of commensurate fractional order.
void runFractional(const IdentifyArguments& options, const OpenResponse& open, const FrequencyData& data,
                   Terminal& terminal)
{
    if (options.discrete || options.unrefined || options.unstable || !options.validation.empty())
        throw Error(Error::Kind::usage, "Fractional models are refined, stable and of continuous time: leave "
                                        "--discrete, --subspace, --allow-unstable and "
                                        "--validation out with --alpha.");
    FractionalOptions fractional;
    fractional.alpha = alphaFrom(options.alpha);
    fractional.thorough = !options.quick;
    const auto sweep = sweepFractional(data, ordersFrom(options.orders, data), fractional, terminal.progress());
    const auto& chosen = sweep.entries[sweep.chosen];
    const auto& found = chosen.found;
    const IdentifiedFractionalModel identified {
        options.response.path,
        data.lines(),
        sweep,
        {std::filesystem::path(options.response.path).stem().string(), {open.input}, {open.output}, found.model}};
    if (!options.out.empty())
        writeJson(toJson(identified.model), options.out);

    terminal.say(open.output + " / " + open.input + ", " + std::to_string(data.lines()) + " lines, in s^alpha");
    std::vector<std::vector<std::string>> rows;
    for (const auto& e : sweep.entries)
        rows.push_back({std::to_string(e.order), withError(e.found.model.alpha, e.found.alphaStandardError),
                        fixed(e.found.errorDb, 1), fixed(decibelsOf(e.found.cost), 1), significant(e.mdl, 6),
                        fixed(e.found.sectorMargin, 3), e.found.start});
    terminal.table({"order", "alpha", "error dB", "weighted dB", "MDL", "margin rad", "from"}, rows);
    if (sweep.entries.size() > 1)
        terminal.say(wrapped(sweep.sentence));
    for (const auto& warning : {found.warning, sweep.warning})
        if (!warning.empty())
            terminal.say(wrapped(warning));
    if (!options.out.empty())
        terminal.say("Wrote " + options.out + ".");
    terminal.document(toJson(identified));
    if (!found.stable)
        terminal.answer = 1;
}

/// R + L s^alpha and a resonance, of an impedance.
void runMixed(const IdentifyArguments& options, const OpenResponse& open, const FrequencyData& data, Terminal& terminal)
{
    if (open.output != "voltage" || open.input != "current")
        throw Error(Error::Kind::usage,
                    "--mixed fits an impedance: leave --output and --input out, or make them voltage and current.");
    if (!options.out.empty())
        throw Error(
            Error::Kind::usage,
            "A mixed-order impedance has no file of its own; take its parameters from --json and leave --out out.");
    MixedImpedanceOptions mixed;
    mixed.alpha = alphaFrom(options.alpha);
    const auto fit = fitMixedImpedance(data, mixed);
    static constexpr std::array<std::array<const char*, 3>, MixedImpedance::parameters> names {
        {{"resistance", "R", "ohm"},
         {"semiInductance", "L", "ohm s^alpha"},
         {"alpha", "alpha", "1"},
         {"motional", "K = Bl^2/m", "ohm/s"},
         {"resonance", "f0", "Hz"},
         {"quality", "Q", "1"}}};
    Json document = DocumentFormat {"excursion-mixed-impedance"}.with({{"source", options.response.path}});
    document["lines"] = data.lines();
    std::vector<std::vector<std::string>> rows;
    for (std::size_t k = 0; k < names.size(); ++k) {
        const double value = fit.model.values()[k], standardError = fit.standardErrors.values()[k];
        rows.push_back({names[k][1], significant(value, 5), significant(standardError, 2), names[k][2]});
        document[names[k][0]] = {
            {"value", value}, {"standardError", numberOrNull(standardError)}, {"unit", names[k][2]}};
    }
    document["errorDb"] = fit.errorDb;
    document["chiSquared"] = numberOrNull(fit.chiSquared);
    document["converged"] = fit.converged();
    document["stopped"] = fit.message;
    terminal.say("impedance, " + std::to_string(data.lines())
                 + " lines: R + L s^alpha + K s/(s^2 + w0/Q s + w0^2), error " + fixed(fit.errorDb, 1) + " dB");
    terminal.table({"parameter", "value", "standard error", "unit"}, rows);
    terminal.document(document);
    if (!fit.converged())
        terminal.answer = 1;
}

void runMotorCone(const IdentifyArguments& options, Terminal& terminal)
{
    if (options.orders.size() != 1)
        throw Error(Error::Kind::usage, "Give one --order with --cone, that of the motor.");
    if (!options.alpha.empty() || !options.validation.empty() || !options.response.output.empty() || options.discrete
        || options.unrefined || options.unstable)
        throw Error(Error::Kind::usage,
                    "Motor and cone are refined, stable and of continuous time, and explain displacement and pressure: "
                    "leave --alpha, "
                    "--validation, --output, --discrete, --subspace and --allow-unstable out with --cone.");
    identifyMotorAndCone({options.response, options.orders.front(), *options.cone, options.delay, options.band,
                          options.quick, options.out},
                         terminal);
}

void run(const IdentifyArguments& options, Terminal& terminal)
{
    if (!options.out.empty())
        requireFilePlace(options.out);
    if (!options.band.empty() && !(options.band[0] < options.band[1]))
        throw Error(Error::Kind::usage, "The band of --band begins at or beyond its end.");
    if (options.mixed && !options.orders.empty())
        throw Error(Error::Kind::usage, "A mixed-order impedance has no order; leave --order out with --mixed.");
    if (options.mixed && options.alpha.empty())
        throw Error(Error::Kind::usage, "Give --alpha with --mixed: a number, or free.");
    if (options.cone)
        return runMotorCone(options, terminal);
    if (options.delay)
        throw Error(Error::Kind::usage, "--delay is that of the sound; give --cone with it.");
    auto response = options.response;
    if (options.mixed && response.output.empty() && response.input.empty()) {  // it is one of impedances
        response.output = "voltage";
        response.input = "current";
    }
    const auto open = openResponse(response);
    for (const auto& remark : open.remarks)
        terminal.say(wrapped("remark  " + remark, 8));
    if (options.discrete && open.sampleRate == 0.0)
        throw Error(Error::Kind::usage, "A frequency response has no sample rate; leave --discrete out.");
    const auto data = frequencyDataOf(within(open.frf, options.band));
    if (!options.alpha.empty())
        return options.mixed ? runMixed(options, open, data, terminal) : runFractional(options, open, data, terminal);
    std::optional<FrequencyData> validation;
    if (!options.validation.empty()) {
        auto choice = response;
        choice.path = options.validation;
        validation = frequencyDataOf(within(openResponse(choice).frf, options.band));
    }

    OrderSweepOptions sweeping;
    sweeping.orders = ordersFrom(options.orders, data);
    sweeping.identify.sampleRate = options.discrete ? open.sampleRate : 0.0;
    sweeping.identify.refine = !options.unrefined;
    sweeping.identify.thorough = !options.quick;
    sweeping.identify.refinement.stable = !options.unstable;
    const auto sweep = sweepOrders(data, sweeping, validation ? &*validation : nullptr, terminal.progress());
    const auto& chosen = sweep.entries[sweep.chosen];
    const IdentifiedModel identified {options.response.path,
                                      data.lines(),
                                      sweep,
                                      {std::filesystem::path(options.response.path).stem().string(),
                                       {open.input},
                                       {open.output},
                                       chosen.found.model}};
    if (!options.out.empty())
        writeJson(toJson(identified.model), options.out);

    terminal.say(open.output + " / " + open.input + ", " + std::to_string(data.lines()) + " lines, "
                 + (options.discrete ? "discrete time at " + significant(open.sampleRate, 6) + " Hz"
                                     : std::string("continuous time")));
    print(sweep, terminal);
    if (sweep.entries.size() > 1)
        terminal.say(wrapped(sweep.sentence));
    if (!chosen.found.stable)
        terminal.say("This model is not stable.");
    if (!options.out.empty())
        terminal.say("Wrote " + options.out + ".");

    terminal.document(toJson(identified));
    if (!chosen.found.stable)
        terminal.answer = 1;
}

}  // namespace

void addIdentify(CLI::App& app, Terminal& terminal)
{
    const auto [verb, o] = addVerb<IdentifyArguments>(
        app, terminal, step::fit, "identify",
        "Identify a linear state-space model from a frequency response, of a given order or the best one", run);
    verb->add_option("TAKE", o->response.path,
                     "a take, an impedance or another response (.zma, .frd, .csv, .txt), or the .json of excursion bla")
        ->required();
    verb->add_option("--order", o->orders,
                     "the order, or several separated by commas to choose from; by default the best of 1 to 8")
        ->delimiter(',')
        ->check(CLI::Range(0, 400));
    verb->add_option("--alpha", o->alpha,
                     "a model of fractional order, in s^alpha: give alpha, or free to find it and its standard error");
    verb->add_flag("--mixed", o->mixed,
                   "with --alpha: an impedance R + L s^alpha with one resonance, in place of a state-space model");
    verb->add_option(
            "--cone", o->cone,
            "separate motor and cone, using displacement and pressure: the cone's order; --order is the motor's")
        ->check(CLI::Range(0, 400));
    verb->add_option("--delay", o->delay,
                     "with --cone: time of flight of the sound, s; by default from the microphone's distance")
        ->check(CLI::Range(0.0, 1.0));
    verb->add_option("--output", o->response.output, "the channel to explain; by default the first beside the input");
    verb->add_option("--input", o->response.input,
                     "the channel that explains it; by default the voltage or force, for an impedance the current");
    verb->add_option("--level", o->response.level, "number of the level, 0 the quietest; by default the loudest")
        ->check(CLI::NonNegativeNumber);
    verb->add_option("--band", o->band, "lowest and highest frequency to use, Hz")->delimiter(',')->expected(2);
    verb->add_option("--validation", o->validation, "another take or response, which then chooses the order")
        ->type_name("TAKE");
    verb->add_flag("--discrete", o->discrete,
                   "a model of discrete time at the take's sample rate, not of continuous time");
    verb->add_flag("--subspace", o->unrefined, "by the subspace method alone, without refinement");
    verb->add_flag("--quick", o->quick, "fewer starts");
    verb->add_flag("--allow-unstable", o->unstable, "do not keep the poles stable");
    verb->add_option("--out", o->out, "the model, a .json")->type_name("FILE");
    verb->footer("Exit code 1: the model is not stable, or the search of --mixed did not converge.");
}

}  // namespace excursion::cli
