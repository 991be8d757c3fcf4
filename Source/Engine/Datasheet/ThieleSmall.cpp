// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Datasheet/ThieleSmall.h"

#include "Engine/Datasheet/Impedances.h"
#include "Engine/Error.h"
#include "Engine/Loudspeaker/FitResponse.h"
#include "Engine/Loudspeaker/Propagate.h"
#include "Engine/Loudspeaker/Resonance.h"
#include "Engine/Take/Air.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace excursion {
namespace {

using std::numbers::pi;

/// In the order in which they are told.
const std::vector<DatasheetFigure>& blanks()
{
    static const std::vector<DatasheetFigure> figures {
        {"Re", "ohm", "\u03a9", 1.0, "resistance of the coil"},
        {"Le", "H", "mH", 1e3, "inductance of the blocked coil at 1 kHz"},
        {"Bl", "N/A", "T m", 1.0, "force factor"},
        {"Mms", "kg", "g", 1e3, "moving mass with the load of the air"},
        {"Cms", "m/N", "mm/N", 1e3, "compliance of the suspension"},
        {"Rms", "N s/m", "kg/s", 1.0, "mechanical resistance"},
        {"fs", "Hz", "Hz", 1.0, "resonance"},
        {"Qms", "1", "", 1.0, "mechanical quality"},
        {"Qes", "1", "", 1.0, "electrical quality"},
        {"Qts", "1", "", 1.0, "total quality"},
        {"Sd", "m^2", "cm\u00b2", 1e4, "area of the cone"},
        {"Vas", "m^3", "l", 1e3, "volume of air with the suspension's compliance"},
        {"eta0", "1", "%", 1e2, "reference efficiency, half space"},
        {"SPL 1W", "dB", "dB", 1.0, "sensitivity for 1 W in Re, at 1 m"},
        {"SPL 2.83V", "dB", "dB", 1.0, "sensitivity for 2.83 V, at 1 m"}};
    return figures;
}

/// Where Im Z vanishes, nearest to the cone's resonance on the suspension: a part that swings lowers it.
double resonanceIn(const OpenCoilMechanics& mechanics, double near)
{
    constexpr int steps = 96;
    constexpr double octaves = 2.0;
    const auto reactance = [&](double omega) { return mechanics.at(omega).impedance.imag(); };
    double best = 0.0, below = near * std::exp2(-octaves), before = reactance(below);
    for (int k = 1; k <= steps; ++k) {
        const double above = near * std::exp2(octaves * (2.0 * k / steps - 1.0)), after = reactance(above);
        if (before < 0.0 && after >= 0.0) {
            double low = below, high = above;
            for (int n = 0; n < 60 && high > low; ++n) {
                const double middle = 0.5 * (low + high);
                (reactance(middle) < 0.0 ? low : high) = middle;
            }
            const double omega = 0.5 * (low + high);
            if (best == 0.0 || std::abs(std::log(omega / near)) < std::abs(std::log(best / near)))
                best = omega;
        }
        below = above;
        before = after;
    }
    if (best == 0.0)
        throw Error(Error::Kind::data, "The linear part of the model has no resonance of the cone within two octaves "
                                       "of that of mass and stiffness; Thiele/Small parameters are not "
                                       "defined for it.");
    return best;
}

/// The model without what yields in the course of time.
Model withoutCreep(Model model)
{
    std::erase_if(model.components, [](const Component& c) { return c.effect->creeps(); });
    model.covariance.resize(0, 0);
    return model;
}

double levelOf(double pressure) { return 20.0 * std::log10(pressure / referencePressure); }

/// One number a figure, in the order of blanks(); NaN where there is no coil to have it.
Eigen::VectorXd numbersOf(const Model& whole, double resistanceAt)
{
    const auto model = withoutEnclosure(linearPart(whole));
    const OpenCoilMechanics mechanics(model);
    const double omega = resonanceIn(mechanics, 2.0 * pi * resonanceOf(model));
    const auto inertia = OpenCoilMechanics(withoutCreep(model)).at(omega);
    // d Im Z/dw = Re dZ/ds on the imaginary axis.
    const double mass = 0.5 * (inertia.slope.real() + inertia.impedance.imag() / omega);
    const double losses = mechanics.at(omega).impedance.real(), compliance = 1.0 / (omega * omega * mass),
                 Qms = omega * mass / losses;
    // negative where a microphone is inverted
    const double area = std::abs(model.path.parameters[0].value),
                 volume = airDensity * speedOfSound * speedOfSound * area * area * compliance;
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    double Re = none, Le = none, Bl = none, Qes = none, Qts = none, eta0 = none, watt = none, volts = none;
    if (model.electrical()) {
        constexpr double sheetFrequency = 1000.0;
        Re = coilResistance(model, resistanceAt);
        Bl = model.baseParameter("Bl").value;
        Le = blockedImpedance(model, {sheetFrequency}).front().imag() / (2.0 * pi * sheetFrequency);
        Qes = omega * mass * Re / (Bl * Bl);
        Qts = 1.0 / (1.0 / Qms + 1.0 / Qes);
        const double perVolt = airDensity / (2.0 * pi) * Bl * area / (Re * mass);  // Pa at 1 m
        eta0 = airDensity / (2.0 * pi * speedOfSound) * std::pow(Bl * area / mass, 2) / Re;
        watt = levelOf(perVolt * std::sqrt(Re));
        volts = levelOf(perVolt * sheetVoltage);
    }
    Eigen::VectorXd numbers(15);
    numbers << Re, Le, Bl, mass, compliance, losses, omega / (2.0 * pi), Qms, Qes, Qts, area, volume, eta0, watt, volts;
    return numbers;
}

/// Whether a number is another one for a model that could be as well.
bool differs(double a, double b) { return std::abs(a - b) > 1e-6 * std::abs(a); }

}  // namespace

std::vector<DatasheetFigure> thieleSmall(const ScaledModel& given)
{
    const auto& model = given.model;
    const double resistanceAt = model.electrical() ? resistanceFrequency(model) : 0.0;
    const auto of = [resistanceAt](const Model& m) { return numbersOf(m, resistanceAt); };
    const auto numbers = of(model), errors = standardErrorsOf(model, of);
    constexpr double other = 1.25;  // any factor but 1
    auto otherArea = model;
    otherArea.path.parameters[0].value *= other;
    const auto ifMoved = of(withMotion(model, other)), ifWider = of(otherArea);
    const bool coilIsGuessed = model.electrical() && !model.baseParameter("Re").free;
    const auto ifOtherCoil = coilIsGuessed ? of(withCoil(model, other, 1.0)) : numbers,
               ifOtherShare = coilIsGuessed && !model.baseParameter("Rms").free ? of(withCoil(model, 1.0, 1.0 / other))
                                                                                : numbers;
    auto figures = blanks();
    for (std::size_t k = 0; k < figures.size(); ++k) {
        auto& figure = figures[k];
        const auto n = static_cast<Eigen::Index>(k);
        if (std::isnan(numbers[n])) {
            figure.why = "the model has no coil";
        } else if (given.motionIsGuessed && differs(numbers[n], ifMoved[n])) {
            figure.why = "voltage and current alone do not show the moving mass; give it, or Bl";
        } else if (given.areaIsGuessed && differs(numbers[n], ifWider[n])) {
            figure.why = "the take does not tell the area of the cone; give it";
        } else if (differs(numbers[n], ifOtherCoil[n]) || differs(numbers[n], ifOtherShare[n])) {
            figure.why = "a motion alone does not tell the coil from the suspension; measure the current, too";
        } else {
            figure.value = numbers[n];
            figure.standardError = errors[n] > 0.0
                                       ? errors[n]
                                       : std::numeric_limits<double>::quiet_NaN();  // of what was given it is not known
        }
    }
    return figures;
}

}  // namespace excursion
