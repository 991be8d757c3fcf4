// SPDX-License-Identifier: GPL-3.0-or-later
// A model without physics inverted.
#include "Cli/Predistorting.h"

#include "Engine/BlackBox/BlackBoxPredistorter.h"
#include "Engine/Document/Engineering.h"
#include "Engine/Document/JsonText.h"
#include "Engine/Error.h"
#include "Engine/Signal/Level.h"

#include <limits>
#include <memory>

namespace excursion::cli {

/// A model without physics knows no cone: the region of its fit is the limit.
void runBlackBox(const PredistortArguments& options, const BlackBox& box, Terminal& terminal)
{
    if (options.displacementLimit || options.powerLimit || options.margin != 0.0)
        throw Error(Error::Kind::usage, "--limit-x, --limit-p and --margin are of a cone and a coil, which a model "
                                        "without physics does not know: leave them out; it keeps to where it was "
                                        "fitted.");
    if (options.target.asked())
        throw Error(Error::Kind::usage, "A target moves the resonance of a driver, which a model without physics does "
                                        "not know: leave --target-f0, --target-q and --target-box out.");
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
    bool limited = false;
    const BlackBoxControls controls {options.amount,
                                     options.voltageLimit.value_or(std::numeric_limits<double>::infinity())};
    const auto make = [&] { return std::make_unique<BlackBoxPredistorter>(model, rate, controls); };
    const auto told = [&](double before, double after, const BlackBoxPredistorter::Meters& meters) {
        limited = limited || meters.reduction > noticed;
        channels.push_back({{"peakIn", before},
                            {"peakOut", after},
                            {"correction", meters.correction},
                            {"region", meters.region},
                            {"reduction", meters.reduction}});
        rows.push_back({std::to_string(channels.size()), significant(before) + " " + unit,
                        significant(after) + " " + unit, significant(meters.correction) + " " + unit,
                        fixed(100.0 * meters.region, 0) + " %", turnedDown(meters.reduction, true)});
    };
    const double loudest = bendAll(bent, options.fullScale, progress, make, told);
    publish(bent, options.out);
    auto report = documentOf(options, wav);
    report.update({{"voltageLimit", numberOrNull(controls.inputLimit)},
                   {"modelRate", box.linear.sampleRate},
                   {"distortionBeforeDb", gain.beforeDb},
                   {"distortionAfterDb", gain.afterDb},
                   {"gainDb", gain.gainDb()},
                   {"channels", channels},
                   {"limited", limited}});
    terminal.document(report);
    terminal.table({"channel", "peak in", "out", "the correction", "of the region", "turned down"}, rows);
    if (limited)
        terminal.say("The signal goes beyond where the model was fitted (" + significant(box.stimulus.peak, 3) + " "
                     + unit + " peak, or what its states reached): there it was turned down.");
    sayLoudest(options, loudest, terminal);
    sayWritten(options, unit, terminal);
    if (limited)
        terminal.answer = 1;
}

}  // namespace excursion::cli
