// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Predistortion/DriverMotion.h"

#include "Engine/Loudspeaker/Resonance.h"
#include "Engine/Loudspeaker/SensorResponse.h"
#include "Engine/Loudspeaker/SmallSignal.h"
#include "Engine/Predistortion/Inverse.h"
#include "Engine/Predistortion/RealTime.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace excursion {
namespace {

constexpr int points = 33;
constexpr double farthest = 4.0;  // of what was measured

double stepOf(const Model& model)
{
    const double measured = measuredDisplacement(model);
    return std::isfinite(measured) ? farthest * measured / (points - 1) : 0.0;
}

/// The heat that holds a cone at points of the grid, by the inverse at rest there.
std::vector<double> holdingHeat(const Model& model, double sampleRate, double grid)
{
    std::vector<double> heat {0.0};
    if (!model.electrical() || !(grid > 0.0))
        return heat;
    Inverse inverse(model, sampleRate);
    const double ohms = model.baseParameter("Re").value,
                 perMetre = model.baseParameter("K").value / model.baseParameter("Bl").value;
    for (int k = 1; k < points; ++k) {
        double worst = heat.back();
        for (const double x : {k * grid, -k * grid}) {
            inverse.reset();
            MotionPoint there;
            there.x = x;
            there.i = perMetre * x;
            for (int settle = 0; settle < 8; ++settle)
                inverse.step(there);
            worst = std::max(worst, ohms * inverse.current() * inverse.current());
        }
        heat.push_back(worst);
    }
    return heat;
}

/// Adds the means of the correction of tones about the resonance, as their amplitude grows.
void addMeanCorrection(LinearMotion& motion, const Model& model)
{
    constexpr int perPeriod = 64, settling = 2;
    motion.leastCorrection.resize(points, 0.0);
    motion.mostCorrection.resize(points, 0.0);
    for (const double octaves : {-1.0, 0.0, 1.0}) {
        const double frequency = motion.resonance * std::exp2(octaves),
                     perVolt = std::abs(
                         respond(withoutSensors(model), {Quantity::displacement}, {frequency}).front().value.front());
        Reference reference(model, perPeriod * frequency);
        Inverse inverse(model, perPeriod * frequency);
        for (std::size_t k = 1; k < points; ++k) {
            const double volts = static_cast<double>(k) * motion.holdingStep / perVolt;
            reference.reset();
            inverse.reset();
            double mean = 0.0;
            for (int n = 0; n < (settling + 1) * perPeriod; ++n) {
                const double u = volts * std::sin(2.0 * std::numbers::pi * n / perPeriod),
                             correction = inverse.step(reference.step(u)) - u;
                if (n >= settling * perPeriod)
                    mean += correction / perPeriod;
            }
            motion.leastCorrection[k] = std::min(motion.leastCorrection[k], mean);
            motion.mostCorrection[k] = std::max(motion.mostCorrection[k], mean);
        }
    }
}

double worstSensitivity(const Model& given, double f0)
{
    const auto model = withoutSensors(given);
    std::vector<double> frequency;
    for (int k = 0; k < 24; ++k)
        frequency.push_back(f0 * 0.1 * std::pow(30.0, k / 23.0));
    const auto response = respond(model, {Quantity::displacement}, frequency, true).front();
    const auto parameters = parametersOf(model);
    double worst = 0.0;
    for (std::size_t f = 0; f < frequency.size(); ++f) {
        double sum = 0.0;
        for (std::size_t p = 0; p < parameters.size(); ++p)
            sum += std::abs((response.gradient(static_cast<Eigen::Index>(f), static_cast<Eigen::Index>(p))
                             * parameters[p]->value / response.value[f])
                                .real());
        worst = std::max(worst, sum);
    }
    return worst;
}

}  // namespace

LinearMotion linearMotion(const Model& model, double sampleRate)
{
    const auto linear = smallSignal(linearPart(model));
    const auto n = linear.A.rows();
    LinearMotion motion;
    motion.A = linear.A;
    motion.B = linear.B;
    motion.displacement = Eigen::RowVectorXd::Unit(n, 1);
    motion.current = Eigen::RowVectorXd::Unit(n, 0);
    motion.resonance = resonanceOf(model);
    motion.uncertainty = worstSensitivity(model, motion.resonance);
    motion.ohms = model.electrical() ? model.baseParameter("Re").value : 0.0;
    motion.holdingStep = stepOf(model);
    motion.holding = holdingHeat(model, sampleRate, motion.holdingStep);
    return motion;
}

LinearMotion linearMotion(const Model& model, double sampleRate, const AmplifierCoupling& coupling)
{
    auto motion = behind(linearMotion(model, sampleRate), coupling);
    if (!coupling.passesConstant() && motion.holdingStep > 0.0)
        addMeanCorrection(motion, model);
    return motion;
}

}  // namespace excursion
