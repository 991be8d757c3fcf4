// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/FitResponse.h"

#include "Engine/Estimate/PhysicalDelay.h"
#include "Engine/Loudspeaker/ImpedanceScan.h"
#include "Engine/Loudspeaker/MatchSound.h"
#include "Engine/Loudspeaker/PistonBand.h"
#include "Engine/Loudspeaker/SmallSignal.h"
#include "Engine/Numerics/Median.h"
#include "Engine/Take/Air.h"
#include "Engine/Take/Motion.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <utility>

namespace excursion {
namespace {

/// Moving mass of a typical driver, kg: it grows like the cone's area to the power 3/2; without the area the resonance
/// tells a woofer (15 g at 45 Hz) from a tweeter (0.3 g at 800 Hz). Rounded to one digit, as it is no more than a
/// convention.
double typicalMass(double f0, const std::optional<double>& area)
{
    const double mass = std::clamp(area ? 8.6 * std::pow(*area, 1.5) : 0.015 * std::pow(45.0 / f0, 1.4), 5e-5, 0.5);
    const double digit = std::pow(10.0, std::floor(std::log10(mass)));
    return std::round(mass / digit) * digit;
}

/// Another mass for the same electrical behaviour: only Bl^2/m, Rms/m and K/m are seen. The motion changes with the
/// root of it, or, without a coil, with it.
void rescale(Model& model, double mass)
{
    const double ratio = mass / model.baseParameter("m").value;
    for (const char* name : {"m", "Rms", "K"})
        model.baseParameter(name).value *= ratio;
    if (model.electrical())
        model.baseParameter("Bl").value *= std::sqrt(ratio);
}

/// How many times larger the measured response is than the model's.
double sizeOver(const Model& model, const ResponseTarget& target)
{
    const auto response = respond(model, {target.quantity}, target.frequency).front();
    double cross = 0.0, power = 0.0;
    for (std::size_t f = 0; f < target.frequency.size(); ++f) {
        const double weight = 1.0 / (target.deviation[f] * target.deviation[f]);
        cross += weight * std::abs(response.value[f]) * std::abs(target.value[f]);
        power += weight * std::norm(response.value[f]);
    }
    return cross / power;
}

/// The responses on a grid that is just fine enough to tell a good start from a bad one.
constexpr int startPointsPerOctave = 24;

/// What the targets show and what they do not.
struct Sight {
    bool mass = false;
    const ResponseTarget *current = nullptr, *motion = nullptr, *pressure = nullptr;
    double low = std::numeric_limits<double>::infinity(), high = 0.0;  ///< Hz
};

Sight sightOf(const std::vector<ResponseTarget>& targets, bool electrical, const DriverInfo& driver)
{
    Sight sight;
    for (const auto& target : targets) {
        sight.low = std::min(sight.low, target.frequency.front());
        sight.high = std::max(sight.high, target.frequency.back());
        if (target.quantity == Quantity::current)
            sight.current = &target;
        else if (target.quantity == Quantity::pressure)
            sight.pressure = &target;
        else if (!sight.motion && isMotion(target.quantity))
            sight.motion = &target;
    }
    sight.mass = !electrical || sight.motion || (sight.pressure && driver.coneArea && driver.microphoneDistance);
    return sight;
}

/// The responses as a base is fitted to them. It lacks most of what is there, so what it leaves is not noise, and lines
/// that are known very well must not outweigh the rest. Below a port's tuning the port nearly cancels the sound of the
/// cone. The base has no port, so relative errors of the pressure do not count there.
std::vector<ResponseTarget> evened(std::vector<ResponseTarget> targets)
{
    constexpr double share = 0.1, heard = 0.03;  // of the line, and of the loudest one
    for (auto& target : targets) {
        double loudest = 0.0;
        if (target.quantity == Quantity::pressure)
            for (const auto& value : target.value)
                loudest = std::max(loudest, std::abs(value));
        for (std::size_t k = 0; k < target.value.size(); ++k)
            target.deviation[k] = std::max({target.deviation[k], share * std::abs(target.value[k]), heard * loudest});
    }
    return targets;
}

/// The best of the candidates after a few iterations each.
class Contest {
public:
    explicit Contest(const std::vector<ResponseTarget>& targets) : targets_(targets) {}

    void consider(Model candidate)
    {
        for (const auto& p : candidate.base().parameters)
            if (!(p.value > 0.0))
                return;
        const auto summary = fitResponse(candidate, targets_, {12, 1e-3});
        if (summary.usable() && summary.finalCost < lowest_) {
            lowest_ = summary.finalCost;
            best_ = std::move(candidate);
        }
    }
    bool found() const { return std::isfinite(lowest_); }
    Model& best() { return best_; }

private:
    const std::vector<ResponseTarget>& targets_;
    Model best_;
    double lowest_ = std::numeric_limits<double>::infinity();
};

/// Gives the model the mass, and the area, with which its motion and pressure are of the size that was measured,
/// whatever their units.
void matchSizes(Model& model, const Sight& sight)
{
    if (const auto* target = sight.motion ? sight.motion : sight.pressure; target && sight.mass) {
        const double size = sizeOver(model, *target);
        rescale(model, model.baseParameter("m").value / (model.electrical() ? size * size : size));
    }
    if (model.path.parameters[0].free)
        model.path.parameters[0].value *= sizeOver(model, *sight.pressure);
    if (sight.pressure)
        matchArrival(model, *sight.pressure);
}

/// From the impedance's own peak; the mass is the one thing it does not show.
void considerPeak(Contest& contest, Model model, const Sight& sight)
{
    const auto shape = scanImpedance(*sight.current);
    constexpr double recognized = 0.7;
    if (!shape || shape->relativeError > recognized)
        return;
    const double omega = 2.0 * std::numbers::pi * shape->resonance;
    const double mass = model.baseParameter("m").value;
    model.baseParameter("Re").value = shape->Re;
    model.baseParameter("Le").value = std::max(shape->Le, shape->Re / (2.0 * std::numbers::pi * 1e5));
    model.baseParameter("K").value = mass * omega * omega;
    model.baseParameter("Rms").value = omega * mass / shape->quality;
    model.baseParameter("Bl").value = std::sqrt(shape->height * model.baseParameter("Rms").value);
    matchSizes(model, sight);
    contest.consider(model);
    if (!sight.mass)
        return;
    // The size of a motion tells the mass but roughly where the cone does not move as one piece.
    for (const double factor : {0.2, 5.0}) {
        auto other = model;
        rescale(other, factor * model.baseParameter("m").value);
        contest.consider(std::move(other));
    }
}

/// From a grid of resonance, quality and coupling.
void considerGrid(Contest& contest, Model model, const Sight& sight)
{
    // The magnitude of the response sets the scale, so that only dimensionless numbers are searched.
    double Re = 6.0;
    if (sight.current) {
        std::vector<double> ohms;
        for (const auto& v : sight.current->value)
            ohms.push_back(sight.current->impedance ? std::abs(v) : 1.0 / std::abs(v));
        Re = 0.8 * medianOf(std::move(ohms));
    }
    for (double f0 = 1.1 * std::max(sight.low, 1e-4 * sight.high); f0 < sight.high; f0 *= 1.45)
        for (const double Q : {1.0, 5.0, 25.0}) {
            const double omega = 2.0 * std::numbers::pi * f0;
            const double mass = model.baseParameter("m").value;
            model.baseParameter("K").value = mass * omega * omega;
            model.baseParameter("Rms").value = omega * mass / Q;
            if (!model.electrical()) {
                auto candidate = model;
                matchSizes(candidate, sight);
                contest.consider(std::move(candidate));
                continue;
            }
            for (const double coupling : {0.5, 4.0}) {  // Bl^2/(Re Rms): the height of the impedance peak
                auto candidate = model;
                candidate.baseParameter("Re").value = Re;
                candidate.baseParameter("Le").value = Re / (2.0 * std::numbers::pi * 3000.0);
                candidate.baseParameter("Bl").value = std::sqrt(coupling * Re * model.baseParameter("Rms").value);
                matchSizes(candidate, sight);
                contest.consider(std::move(candidate));
            }
        }
}

}  // namespace

Model startModel(const std::vector<ResponseTarget>& dense, bool electrical, const DriverInfo& driver)
{
    if (dense.empty())
        throw Error(Error::Kind::data, "The take gives no frequency response to start from; excite it in the band of "
                                       "the loudspeaker's resonance.");
    const auto even = evened(dense), targets = thinned(even, startPointsPerOctave);
    const auto sight = sightOf(targets, electrical, driver);
    Model model = makeModel(electrical ? "electrodynamic" : "mechanical");
    model.microphoneDistance = driver.microphoneDistance.value_or(1.0);
    model.path.parameters[0].value = driver.coneArea.value_or(0.01);
    model.path.parameters[1].value = model.microphoneDistance / speedOfSound;
    model.path.parameters[1].free = sight.pressure != nullptr;
    // Where neither the mass nor the area is known, the mass is held, and the area takes the size of the pressure.
    model.path.parameters[0].free = sight.pressure && (sight.motion || !sight.mass);
    if (electrical) {
        model.baseParameter("m").free = sight.mass;
        // Without a current a driver with hardly any coil fits as well: only the sum of both dampings shows.
        model.baseParameter("Re").free = model.baseParameter("Rms").free = sight.current != nullptr;
    }
    Contest contest(targets);
    if (electrical && sight.current)
        considerPeak(contest, model, sight);
    if (!contest.found())
        considerGrid(contest, model, sight);
    if (!contest.found())
        throw Error(
            Error::Kind::numerical,
            "No linear driver could be fitted to the frequency response of the take; run the check of the take first.");
    Model best = contest.best();
    if (!sight.mass) {
        const double f0 = resonanceOf(best.base().parameters);
        rescale(best, typicalMass(f0, driver.coneArea));
        matchSizes(best, sight);
    }
    if (electrical && !sight.current) {
        constexpr double usualShare = 0.8;
        const double Bl = best.baseParameter("Bl").value, coil = Bl * Bl / best.baseParameter("Re").value;
        best = withCoil(std::move(best), 1.0, usualShare * (coil + best.baseParameter("Rms").value) / coil);
    }
    fitResponse(best, even, {60, 1e-8});
    best.name = driver.name;
    return best;
}

Model withCoil(Model model, double resistance, double share)
{
    auto& Re = model.baseParameter("Re").value;
    auto& Bl = model.baseParameter("Bl").value;
    auto& m = model.baseParameter("m").value;
    auto& Rms = model.baseParameter("Rms").value;
    const double rate = (Rms + Bl * Bl / Re) / m;
    Re *= resistance;
    model.baseParameter("Le").value *= resistance;
    m *= share / resistance;
    model.baseParameter("K").value *= share / resistance;
    Bl *= share;
    Rms = rate * m - Bl * Bl / Re;
    return model;
}

std::string caveatsOf(const Model& model, const std::vector<ResponseTarget>& targets)
{
    std::string text;
    char number[32];
    const auto print = [&number](const char* format, double value) {
        std::snprintf(number, sizeof number, format, value);  // the C locale is never changed
        return std::string(number);
    };
    if (model.electrical() && !model.baseParameter("m").free)
        text += " The moving mass is held at " + print("%.3g", 1e3 * model.baseParameter("m").value)
                + " g, a guess: without a measured motion only Bl^2/m, Rms/m and K/m are known, so Bl, Rms and K scale "
                  "with it.";
    if (model.electrical() && !model.baseParameter("m").free && model.path.parameters[0].free)
        text += " The area of the cone follows from that guess and the size of the pressure.";
    if (model.electrical() && !model.baseParameter("Re").free)
        text += " Re is held at " + print("%.3g", model.baseParameter("Re").value)
                + " ohm, a guess: without a measured current m, Rms and K are known but for a common factor"
                + (model.baseParameter("Rms").free ? "." : ", and the coil's share of the damping is a guess, too.");
    double highest = 0.0;
    for (const auto& target : targets)
        highest = std::max(highest, target.frequency.back());
    for (const auto& target : targets)
        if (isMotion(target.quantity) && target.frequency.back() < 0.9 * highest)
            text += " The " + std::string(name(target.quantity)) + " counts up to "
                    + print("%.0f", target.frequency.back()) + " Hz; above, the cone does not move as one piece.";
    return text;
}

}  // namespace excursion
