// SPDX-License-Identifier: GPL-3.0-or-later
// A model without physics inverted.
#include "Cli/Predistorting.h"

#include "Engine/BlackBox/BlackBoxPredistorter.h"
#include "Engine/BlackBox/BoxLinearPart.h"
#include "Engine/BlackBox/BoxMotion.h"
#include "Engine/Document/Engineering.h"
#include "Engine/Document/JsonText.h"
#include "Engine/Error.h"
#include "Engine/Signal/Level.h"

#include <limits>
#include <memory>

namespace excursion::cli {

namespace {

PredistortionControls controlsFrom(const PredistortArguments& options, const RehearsedBox& model)
{
    constexpr double none = std::numeric_limits<double>::infinity();
    PredistortionControls controls;
    controls.amount = options.amount;
    controls.voltageLimit = options.voltageLimit.value_or(none);
    controls.margin = options.margin;
    controls.displacementLimit = options.displacementLimit.value_or(tellsExcursion(model.box) ? model.region.farthest
                                                                                              : none);
    controls.powerLimit = options.powerLimit.value_or(none);
    controls.coilResistance = options.coilResistance.value_or(0.0);
    controls.target = targetFrom(options.target, ownLinearPart(model.box));
    requireValid(controls);
    return controls;
}

/// What no limit can be kept of.
void requireKnown(const PredistortArguments& options, const BlackBox& box)
{
    if (options.known.mass || options.known.forceFactor)
        throw Error(Error::Kind::usage, "--mass and --bl are of a driver; this model knows no physics.");
    if (!tellsExcursion(box) && (options.displacementLimit || options.margin != 0.0))
        throw Error(Error::Kind::usage, "--limit-x and --margin are of the excursion, and this model tells the "
                                            + box.output + ": leave them out; it keeps to where it was fitted.");
    if (options.powerLimit && !drivesCoil(box))
        throw Error(Error::Kind::usage, "--limit-p is of the heat of a coil, and this model begins at the " + box.input
                                            + "; leave it out.");
    if (options.powerLimit && !options.coilResistance)
        throw Error(Error::Kind::usage, "--limit-p is of the heat of a coil, whose resistance a model without physics "
                                        "does not know: give it with --coil-resistance.");
}

}  // namespace

void runBlackBox(const PredistortArguments& options, const BlackBox& box, Terminal& terminal)
{
    requireKnown(options, box);
    const auto wav = readPlayable(options.input, options.out);
    const RehearsedBox model(box);
    const auto& gain = model.rehearsal;
    const std::string unit = box.input == "voltage" ? "V" : box.input == "force" ? "N" : "units of " + box.input;
    terminal.say("A " + box.kind + " (" + box.output + " from " + box.input + ") at "
                 + significant(box.linear.sampleRate, 6) + " Hz. As it was fitted, with "
                 + significant(box.stimulus.rms, 3) + " " + unit + " rms, its distortion is " + fixed(gain.beforeDb, 1)
                 + " dB; with the correction " + fixed(gain.afterDb, 1) + " dB are left: a gain of "
                 + fixed(gain.gainDb(), 1) + " dB, as far as the model is right.");
    if (box.output == "current")
        terminal.say(
            "What becomes linear is the current, which is not the sound: of that, a model of the displacement, "
            "the velocity, the acceleration or the pressure would take the distortion out.");
    const auto rate = static_cast<double>(wav.sampleRate);
    if (rate != box.linear.sampleRate)
        terminal.say("The WAV is at another rate, " + significant(rate, 6)
                     + " Hz: the correction passes through the model's rate, and reaches up to "
                     + significant(0.41e-3 * std::min(rate, box.linear.sampleRate), 3) + " kHz.");
    auto bent = wav;
    const auto progress = terminal.progress();
    std::vector<std::vector<std::string>> rows;
    nlohmann::ordered_json channels = nlohmann::ordered_json::array();
    bool limited = false, beyond = false;
    const auto controls = controlsFrom(options, model);
    const bool moves = tellsExcursion(box);
    nlohmann::ordered_json target;
    if (options.target.asked())
        target = tellTarget(
            forecastTarget(model.box, model.region, model.rest, model.rehearsal, controls, options.fullScale),
            controls.target.kind, options.fullScale, unit, terminal);
    const auto make = [&] { return std::make_unique<BlackBoxPredistorter>(model, rate, controls, options.coupling); };
    const auto told = [&](double before, double after, const BlackBoxPredistorter::Meters& meters) {
        beyond = beyond || meters.regionReduction > noticed;
        limited = limited || beyond || wasLimited(meters);
        channels.push_back({{"peakIn", before},
                            {"peakOut", after},
                            {"correction", meters.correction},
                            {"region", meters.region},
                            {"reduction", meters.regionReduction},
                            {"displacement", moves ? nlohmann::ordered_json(meters.displacement) : nullptr},
                            {"power", meters.power},
                            {"displacementReduction", meters.displacementReduction},
                            {"voltageReduction", meters.voltageReduction},
                            {"powerReduction", meters.powerReduction}});
        rows.push_back({std::to_string(channels.size()), significant(before) + " " + unit,
                        significant(after) + " " + unit, significant(meters.correction) + " " + unit,
                        fixed(100.0 * meters.region, 0) + " %", turnedDown(meters.regionReduction, true),
                        moves ? significant(1e3 * meters.displacement) + " mm" : "unknown",
                        turnedDown(meters.displacementReduction, moves),
                        turnedDown(meters.voltageReduction, options.voltageLimit.has_value())});
        addPower(rows.back(), options, meters);
    };
    const double loudest = bendAll(bent, options.fullScale, progress, make, told);
    publish(bent, options.out);
    auto report = documentOf(options, wav);
    report.update({{"voltageLimit", numberOrNull(controls.voltageLimit)},
                   {"displacementLimit", numberOrNull(controls.displacementLimit)},
                   {"powerLimit", numberOrNull(controls.powerLimit)},
                   {"margin", controls.margin},
                   {"target", target},
                   {"modelRate", box.linear.sampleRate},
                   {"distortionBeforeDb", gain.beforeDb},
                   {"distortionAfterDb", gain.afterDb},
                   {"gainDb", gain.gainDb()},
                   {"channels", channels},
                   {"limited", limited}});
    terminal.document(report);
    std::vector<std::string> heads {"channel",
                                    "peak in",
                                    "out",
                                    "the correction",
                                    "of the region",
                                    "turned down",
                                    "the cone moves",
                                    "motion turned down",
                                    "voltage turned down"};
    if (options.powerLimit)
        heads.insert(heads.end(), {"heat at most", "current turned down"});
    terminal.table(heads, rows);
    if (!moves)
        terminal.say("The model tells the " + box.output + ", not the excursion, so no limit of that is kept.");
    if (beyond)
        terminal.say("The signal goes beyond where the model was fitted (" + significant(box.stimulus.peak, 3) + " "
                     + unit + " peak, or what its states reached): there it was turned down.");
    sayLoudest(options, loudest, terminal);
    sayWritten(options, unit, terminal);
    if (limited)
        terminal.answer = 1;
}

}  // namespace excursion::cli
