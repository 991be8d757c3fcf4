// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/Target.h"

#include "Engine/Document/Engineering.h"
#include "Engine/Document/JsonText.h"
#include "Engine/Error.h"
#include "Engine/Import/LevelCurve.h"

#include <array>
#include <cmath>

namespace excursion::cli {
namespace {

constexpr double litre = 1e-3;  // m^3

/// Of what is met first.
std::string nameOf(TargetForecast::Peaks::First first)
{
    using First = TargetForecast::Peaks::First;
    return first == First::displacement ? "displacement" : first == First::voltage ? "voltage" : "region";
}

std::string roomOf(const TargetForecast::Peaks& peaks)
{
    return std::isfinite(peaks.roomDb)
               ? fixed(peaks.roomDb, 1) + " dB ("
                     + (peaks.first == TargetForecast::Peaks::First::displacement ? "excursion" : nameOf(peaks.first))
                     + ")"
               : "no limit";
}

nlohmann::ordered_json documentOf(const TargetForecast::Peaks& peaks)
{
    return {{"displacement", peaks.displacement},
            {"voltage", numberOrNull(peaks.voltage)},
            {"levelDb", numberOrNull(peaks.roomDb)},
            {"first", nameOf(peaks.first)}};
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
    verb.add_option("--target-flat", target.flat, "make its sound flat from LOW to HIGH, Hz")
        ->expected(2)
        ->delimiter(',');
    verb.add_option("--target-gains", target.gains,
                    "add these gains to its own sound, in thirds of an octave: a file with lines of Hz and dB");
    verb.add_option("--target-response", target.response,
                    "make its sound follow this curve, as loud as on average there: a file with lines of Hz and dB, "
                    "such as .frd");
}

Target targetFrom(const TargetArguments& asked, const OwnLinearPart& own)
{
    Target target;
    if (!asked.asked())
        return target;
    const int kinds = (asked.frequency || asked.quality ? 1 : 0) + (asked.litres ? 1 : 0) + (asked.flat.empty() ? 0 : 1)
                      + (asked.gains.empty() ? 0 : 1) + (asked.response.empty() ? 0 : 1);
    if (kinds > 1)
        throw Error(Error::Kind::usage,
                    "A loudspeaker has one target, and a closed box has its own resonance and Q: give --target-box, or "
                    "--target-f0 and --target-q, or one of --target-flat, --target-gains and --target-response.");
    if (asked.litres) {
        target.kind = Target::Kind::closedBox;
        target.volume = litre * *asked.litres;
    } else if (!asked.flat.empty()) {
        target.kind = Target::Kind::flat;
        target.low = asked.flat.front();
        target.high = asked.flat.back();
    } else if (asked.equalizes()) {
        target.kind = asked.gains.empty() ? Target::Kind::response : Target::Kind::bands;
        const auto curve = readLevelCurve(asked.gains.empty() ? asked.response : asked.gains);
        target.curve = targetCurve(curve.frequency, curve.db);
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

nlohmann::ordered_json tellTarget(const TargetForecast& told, Target::Kind kind, double fullScale,
                                  const std::string& inputUnit, Terminal& terminal)
{
    const std::string unit = " " + inputUnit;
    const auto moved = [](double metres) { return metres > 0.0 ? significant(1e3 * metres, 3) + " mm" : "not told"; };
    const auto row = [&](const char* name, const Resonance& one, const TargetForecast::Peaks& sine,
                         const TargetForecast::Peaks& pink) {
        return std::vector<std::string> {name,
                                         significant(one.frequency, 3) + " Hz",
                                         significant(one.quality, 3),
                                         moved(sine.displacement),
                                         roomOf(sine),
                                         moved(pink.displacement),
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
                 + (told.equalizes ? fixed(told.mostGainDb, 1) + " dB more voltage at most, at "
                                         + significant(told.mostGainFrequency, 3) + " Hz."
                                   : fixed(std::abs(told.lowGainDb), 1) + " dB " + (more ? "more" : "less")
                                         + " excursion and voltage at the lowest notes."));
    constexpr std::array names {"own", "resonance", "closed-box", "flat", "bands", "response"};
    return {{"kind", names[static_cast<std::size_t>(kind)]},
            {"lowGainDb", told.lowGainDb},
            {"mostGainDb", told.mostGainDb},
            {"driver", documentOf(told.own, told.ownSine, told.ownPink)},
            {"target", documentOf(told.played, told.targetSine, told.targetPink)}};
}

}  // namespace excursion::cli
