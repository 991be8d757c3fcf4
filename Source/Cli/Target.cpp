// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/Target.h"

#include "Engine/Document/Engineering.h"
#include "Engine/Document/JsonText.h"
#include "Engine/Error.h"
#include "Engine/Predistortion/TargetForecast.h"

#include <cmath>

namespace excursion::cli {
namespace {

constexpr double litre = 1e-3;  // m^3

std::string roomOf(const TargetForecast::Peaks& peaks)
{
    return std::isfinite(peaks.roomDb)
               ? fixed(peaks.roomDb, 1) + " dB" + (peaks.byDisplacement ? " (excursion)" : " (voltage)")
               : "no limit";
}

nlohmann::ordered_json documentOf(const TargetForecast::Peaks& peaks)
{
    return {{"displacement", peaks.displacement},
            {"voltage", numberOrNull(peaks.voltage)},
            {"levelDb", numberOrNull(peaks.roomDb)},
            {"first", peaks.byDisplacement ? "displacement" : "voltage"}};
}

nlohmann::ordered_json documentOf(const Resonance& one, const TargetForecast::Peaks& sine,
                                  const TargetForecast::Peaks& pink)
{
    return {{"f0", one.frequency},
            {"q", numberOrNull(one.quality)},
            {"sine", documentOf(sine)},
            {"pink", documentOf(pink)}};
}

}  // namespace

void addTargetOptions(CLI::App& verb, TargetArguments& target)
{
    verb.add_option("--target-f0", target.frequency,
                    "resonance of the linearized loudspeaker, Hz (default: the driver's own)");
    verb.add_option("--target-q", target.quality, "its total Q (default: the driver's own)");
    verb.add_option("--target-box", target.litres,
                    "make it move like the driver in a closed box of this volume, litres");
}

Target targetFrom(const TargetArguments& asked, const Model& model)
{
    Target target;
    if (!asked.asked())
        return target;
    if (asked.litres && (asked.frequency || asked.quality))
        throw Error(Error::Kind::usage,
                    "A closed box has its own resonance and Q: give --target-box, or --target-f0 and "
                    "--target-q.");
    const OwnResonance own(model);
    if (asked.litres) {
        target.kind = Target::Kind::closedBox;
        target.volume = litre * *asked.litres;
    } else {
        target.kind = Target::Kind::resonance;
        if (own.single) {
            target.frequency = asked.frequency.value_or(own.single->frequency);
            target.quality = asked.quality.value_or(own.single->quality);
        }
    }
    own.require(target);
    return target;
}

nlohmann::ordered_json tellTarget(const Model& model, const PredistortionControls& controls, double fullScale,
                                  Terminal& terminal)
{
    const auto told = forecastTarget(model, controls, fullScale);
    const std::string unit = model.electrical() ? " V" : " N";
    const auto row = [&](const char* name, const Resonance& one, const TargetForecast::Peaks& sine,
                         const TargetForecast::Peaks& pink) {
        return std::vector<std::string> {name,
                                         significant(one.frequency, 3) + " Hz",
                                         significant(one.quality, 3),
                                         significant(1e3 * sine.displacement, 3) + " mm",
                                         roomOf(sine),
                                         significant(1e3 * pink.displacement, 3) + " mm",
                                         significant(pink.voltage, 3) + unit,
                                         roomOf(pink)};
    };
    terminal.table({"moves like", "f0", "Q", "sine moves", "up to", "pink moves", "needs", "up to"},
                   {row("itself", told.own, told.ownSine, told.ownPink),
                    row("the target", told.played, told.targetSine, told.targetPink)});
    const bool more = told.lowGainDb >= 0.0;
    terminal.say("At full scale, " + significant(fullScale, 3) + unit
                 + ", as if there were no limit: the worst sine and pink noise. Up to: the level, of full scale, to "
                   "which both limits are kept without turning anything down. The target takes "
                 + fixed(std::abs(told.lowGainDb), 1) + " dB " + (more ? "more" : "less")
                 + " excursion and voltage at the lowest notes.");
    return {{"kind", controls.target.kind == Target::Kind::closedBox ? "closed-box" : "resonance"},
            {"lowGainDb", told.lowGainDb},
            {"mostGainDb", told.mostGainDb},
            {"driver", documentOf(told.own, told.ownSine, told.ownPink)},
            {"target", documentOf(told.played, told.targetSine, told.targetPink)}};
}

}  // namespace excursion::cli
