// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/BlackBox/PlayedBox.h"

#include "Engine/BlackBox/BoxMotion.h"
#include "Engine/Document/Engineering.h"
#include "Engine/Error.h"
#include "Engine/Linear/Response.h"

#include <cctype>
#include <cmath>
#include <limits>

namespace excursion {
namespace {

/// See PlayedBox::perOutput; 0 where the linear part is silent.
double levelled(const BlackBox& box)
{
    double in = 0.0, out = 0.0;
    const auto responses = respond(box.linear, box.stimulus.frequency);
    for (std::size_t k = 0; k < responses.size(); ++k)
        if (box.stimulus.frequency[k] < 0.5 * box.linear.sampleRate) {
            in += box.stimulus.power[k];
            out += box.stimulus.power[k] * std::norm(responses[k](0, 0));
        }
    return out > 0.0 ? std::sqrt(in / out) : 0.0;
}

std::string whatItIs(const BlackBox& box)
{
    auto kind = box.kind;
    kind.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(kind.front())));
    return kind + " (" + box.output + " from " + box.input + ") at " + nominal(box.linear.sampleRate, "Hz");
}

}  // namespace

PlayedBox::PlayedBox(const BlackBox& wanted, const Progress& progress)
    : box(wanted), region(visitedBy(box)), rest(restOf(box)), perOutput(levelled(box))
{
    try {
        rehearsal = rehearse(box, region, rest, {}, progress);
    } catch (const Error& error) {
        if (error.kind() != Error::Kind::data)
            throw;
        refusal = error.what();
    }
}

double measuredDisplacement(const PlayedBox& played)
{
    return tellsExcursion(played.box) ? played.region.farthest : std::numeric_limits<double>::infinity();
}

std::string protectionOf(const PlayedBox& played, double coilResistance)
{
    if (!played.rehearsal)
        return "Nothing is linearized. Peaks above the limit of the voltage are cut; nothing else is limited.";
    const bool moves = tellsExcursion(played.box), coil = drivesCoil(played.box);
    const std::string power = coil && coilResistance > 0.0 ? " and power" : "";
    std::string text = moves ? "Excursion, voltage" + power : "Voltage" + power;
    text += " and the region of the fit are limited";
    if (!moves)
        text += "; the excursion is not told";
    if (coil && power.empty())
        text += "; the power needs the coil's resistance";
    return text + ".";
}

std::string wordsOf(const PlayedBox& played)
{
    const auto what = whatItIs(played.box);
    if (!played.rehearsal)
        return what + ". It plays, but it is not inverted. " + played.refusal;
    const auto& gain = *played.rehearsal;
    const std::string unit = played.box.input == "voltage" ? "V" : played.box.input == "force" ? "N" : "";
    auto text = what + ". As it was fitted, with " + engineering(played.box.stimulus.rms, unit, 3)
                + " rms, its distortion is " + decibels(gain.beforeDb) + "; with the correction "
                + decibels(gain.afterDb) + " are left: a gain of " + decibels(gain.gainDb())
                + ", as far as the model is right.";
    if (played.box.output == "current")
        text += " What becomes linear is the current, which is not the sound.";
    return text;
}

}  // namespace excursion
