// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Predistortion/Target.h"

#include "Engine/Document/Engineering.h"
#include "Engine/Error.h"
#include "Engine/Loudspeaker/SensorResponse.h"
#include "Engine/Loudspeaker/SmallSignal.h"
#include "Engine/Predistortion/ThirdOctaves.h"
#include "Engine/Take/Air.h"
#include "Engine/Validity.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>
#include <vector>

namespace excursion {
namespace {

constexpr double mostApart = 6.0;  // dB
constexpr double farthest = 8.0;   // a factor

constexpr double edge = 1.122462048309373;  // a sixth of an octave

double largest(const ThirdOctaves& gains)
{
    double most = 0.0;
    for (const double gain : gains)
        most = std::max(most, std::abs(gain));
    return most;
}

bool inReach(double frequency, const Resonance& own)
{
    return frequency >= own.frequency / farthest && frequency <= own.frequency * farthest;
}

/// What a curve asks for at the bands where it is given: that, less what is there, so that the average stays.
std::optional<ThirdOctaves> aligned(const ThirdOctaves& wanted, const ThirdOctaves& own)
{
    double level = 0.0;
    int given = 0;
    for (std::size_t k = 0; k < own.size(); ++k)
        if (wanted[k] != Target::notGiven) {
            level += wanted[k] - own[k];
            ++given;
        }
    if (given < 3)
        return std::nullopt;
    ThirdOctaves gains {};
    for (std::size_t k = 0; k < own.size(); ++k)
        gains[k] = wanted[k] != Target::notGiven ? wanted[k] - own[k] - level / given : Target::notGiven;
    // Beyond its ends, and in its gaps
    const auto known = gains;
    for (std::size_t k = 0; k < gains.size(); ++k) {
        if (known[k] != Target::notGiven)
            continue;
        const bool below = k > 0 && known[k - 1] != Target::notGiven,
                   above = k + 1 < known.size() && known[k + 1] != Target::notGiven;
        gains[k] = 0.5 * ((below ? known[k - 1] : 0.0) + (above ? known[k + 1] : 0.0));
    }
    return gains;
}

}  // namespace

bool Target::isValid(std::string* reason) const
{
    if (!areSound())
        return refuse(reason, "a target needs a resonance of 1 to 20000 Hz, a Q of 0.1 to 10, a box of 0.01 l to "
                              "100 m\u00b3, a band from 1 to 40000 Hz, and levels of -200 to 300 dB");
    return true;
}

ThirdOctaves targetCurve(const std::vector<double>& frequency, const std::vector<double>& db)
{
    ThirdOctaves curve {};
    for (std::size_t k = 0; k < curve.size(); ++k) {
        const double centre = thirdOctave(k);
        curve[k] = Target::notGiven;
        if (frequency.empty() || centre < frequency.front() / edge || centre > frequency.back() * edge)
            continue;
        const auto from = std::lower_bound(frequency.begin(), frequency.end(), centre / edge) - frequency.begin(),
                   to = std::lower_bound(frequency.begin(), frequency.end(), centre * edge) - frequency.begin();
        if (to > from) {
            curve[k] = std::accumulate(db.begin() + from, db.begin() + to, 0.0) / static_cast<double>(to - from);
        } else if (from > 0 && static_cast<std::size_t>(from) < frequency.size()) {
            const auto above = static_cast<std::size_t>(from);
            const double part = std::log(centre / frequency[above - 1])
                                / std::log(frequency[above] / frequency[above - 1]);
            curve[k] = db[above - 1] + part * (db[above] - db[above - 1]);
        }
    }
    return curve;
}

void OwnLinearPart::takeResonance(const std::function<std::complex<double>(double)>& motion, const Resonance& own,
                                  double slow)
{
    single.reset();
    if (!(own.frequency > 0.0 && own.quality > 0.0 && std::isfinite(own.frequency) && std::isfinite(own.quality)))
        return;
    for (double octaves = -2.0; octaves <= 1.0; octaves += 1.0 / 24.0) {
        const double ratio = std::exp2(octaves);
        const std::complex<double> s(0.0, ratio);
        const double apart = std::abs(motion(ratio * own.frequency) * (s * s + s / own.quality + 1.0)) / slow;
        if (!(std::abs(20.0 * std::log10(apart)) < mostApart))
            return;
    }
    single = own;
}

OwnLinearPart::OwnLinearPart(const Model& model)
{
    const auto straight = withoutSensors(linearPart(model));
    const auto own = coneResonance(model);
    const auto there = baseAt(model, own.frequency);
    const auto base = [&there](const char* name) { return parameterNamed(there, name).value; };
    const double stiffness = base("K");
    takeResonance(
        [&straight](double f) { return respond(straight, {Quantity::displacement}, {f}).front().value.front(); }, own,
        (model.electrical() ? base("Bl") / base("Re") : 1.0) / stiffness);
    // As it is made, a model knows no area; what is free has been fitted.
    static const double unknown = makeModel("electrodynamic").path.parameters.front().value;
    const auto& area = model.path.parameters.front();
    if ((area.free || area.value != unknown) && stiffness > 0.0)
        suspensionVolume = airDensity * speedOfSound * speedOfSound * area.value * area.value / stiffness;
    std::vector<double> centres;
    for (std::size_t k = 0; k < std::tuple_size_v<ThirdOctaves>; ++k)
        centres.push_back(thirdOctave(k));
    const auto heard = respond(straight, {Quantity::pressure}, centres).front().value;
    sound.emplace();
    for (std::size_t k = 0; k < centres.size(); ++k)
        (*sound)[k] = 20.0 * std::log10(std::max(std::abs(heard[k]), 1e-30));
}

/// Whether it can be played or not.
std::optional<Resonance> OwnLinearPart::asked(const Target& target) const
{
    if (!single || !target.areSound())
        return std::nullopt;
    if (target.kind == Target::Kind::own || target.equalizes())
        return single;
    if (target.kind == Target::Kind::resonance)
        return Resonance {target.frequency, target.quality};
    if (!suspensionVolume)
        return std::nullopt;
    const double stiffer = std::sqrt(1.0 + *suspensionVolume / target.volume);
    return Resonance {stiffer * single->frequency, stiffer * single->quality};
}

Resonance OwnLinearPart::played(const Target& target) const
{
    const auto wanted = asked(target);
    return wanted && inReach(wanted->frequency, *single) ? *wanted : single.value_or(Resonance {1.0, 1.0});
}

/// Nothing: it cannot be played, or is too much.
std::optional<ThirdOctaves> OwnLinearPart::askedGains(const Target& target) const
{
    if (!target.equalizes() || !target.areSound())
        return ThirdOctaves {};
    if (target.kind == Target::Kind::bands) {
        auto gains = target.curve;
        std::replace(gains.begin(), gains.end(), Target::notGiven, 0.0);
        return gains;
    }
    if (!sound)
        return std::nullopt;
    if (target.kind == Target::Kind::response)
        return aligned(target.curve, *sound);
    ThirdOctaves wanted {};
    for (std::size_t k = 0; k < wanted.size(); ++k) {
        const double centre = thirdOctave(k);
        wanted[k] = centre > target.low / edge && centre < target.high * edge ? 0.0 : Target::notGiven;
    }
    return aligned(wanted, *sound);
}

ThirdOctaves OwnLinearPart::gains(const Target& target) const
{
    const auto asked = askedGains(target);
    return asked && largest(*asked) <= Target::mostGain ? *asked : ThirdOctaves {};
}

void OwnLinearPart::require(const Target& target) const
{
    if (target.kind == Target::Kind::own)
        return;
    std::string reason;
    if (!target.isValid(&reason))
        throw Error(Error::Kind::usage, "This is no target: " + reason + ".");
    if (target.equalizes()) {
        const auto gains = askedGains(target);
        if (!gains && !sound)
            throw Error(Error::Kind::data, "What this loudspeaker sounds like the model does not tell, so its sound "
                                           "cannot be equalized. Give the gains of the bands instead.");
        if (!gains)
            throw Error(Error::Kind::usage, "A target needs three thirds of an octave at least, from its lower end to "
                                            "its upper one.");
        if (const double most = largest(*gains); most > Target::mostGain)
            throw Error(Error::Kind::data, "This target takes a gain of " + plainText(most, 0)
                                               + " dB, which is out of reach: no more than "
                                               + plainText(Target::mostGain, 0)
                                               + " dB are played. Begin higher, or end lower.");
        return;
    }
    if (!single)
        throw Error(Error::Kind::data,
                    "This loudspeaker cannot be given another resonance: its cone does not swing with "
                    "one, as in a vented box. Keep to its own linear part.");
    if (target.kind == Target::Kind::closedBox && !suspensionVolume)
        throw Error(Error::Kind::data, "What a closed box would do cannot be told: the model does not know the area of "
                                       "its cone. Give a resonance and a Q instead.");
    if (const double frequency = asked(target)->frequency; !inReach(frequency, *single))
        throw Error(Error::Kind::data, "A resonance of " + engineering(frequency, "Hz", 3)
                                           + " is out of reach: its own is at "
                                           + engineering(single->frequency, "Hz", 3) + ", and no target is more than "
                                           + plainText(farthest, 0) + " times lower or higher.");
}

}  // namespace excursion
