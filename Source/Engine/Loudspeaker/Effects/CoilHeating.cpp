// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/Effects/Effects.h"

#include "Engine/Numerics/LeastSquares.h"

#include <Eigen/Core>

#include <cmath>
#include <numbers>

namespace excursion {
namespace {

/// The coil's resistance rises with the power that it has turned into heat, through two stages (coil and magnet;
/// Button, J. Audio Eng. Soc. 40, 1992; Zuccatti, 38, 1990):
///     u = R i,   R = r (w_1 + share w_2),   dw_k/dt = (P - w_k)/tau_k,   P = (Re + R) i^2,
/// w_k the power that stage k feels, in W. This is the two-stage ladder of thermal resistances and capacities seen from
/// the coil, as its partial fractions. r is in ohm per watt and takes in the temperature coefficient of the wire. The
/// time constants are sought between a small part of the take and many times its length: what is slower still is a
/// steady rise.
class CoilHeating final : public EffectOf<CoilHeating> {
public:
    CoilHeating()
        : EffectOf({.id = "coil-heating",
                    .title = "Coil heating Re(T)",
                    .physics = "The coil turns power into heat, and hot copper resists more.",
                    .symptoms = "residual voltage in step with the current that grows with the level and in the course "
                                "of the take, without harmonics",
                    .remedy = "A larger coil, a closer gap, ferrofluid or a vented pole piece carry the heat away.",
                    .electrical = true,
                    .linear = false})
    {
    }
    bool slow() const override { return true; }
    Evidence evidence() const override { return Evidence::drift; }
    std::string sizedBy() const override { return "Re"; }

    std::vector<Parameter> parameters(const OperatingRange& e) const override
    {
        constexpr double plausibleRise = 10.0;  // Re doubles at a current of a third of the visited peak
        const auto time = [&e](const char* name, double likely, double least, double most) -> Parameter {
            return {.name = name,
                    .unit = "log10 s",
                    .value = std::log10(likely * e.duration),
                    .lower = std::log10(least * e.duration),
                    .upper = std::log10(most * e.duration)};
        };
        return {{.name = "rise",
                 .unit = "ohm/W",
                 .lower = 0.0,
                 .strength = true,
                 .prior = plausibleRise / (e.current * e.current)},
                time("fast", 0.1, 0.003, 2.0),
                {.name = "share", .unit = "1", .value = 0.3, .lower = 0.0, .upper = 30.0},
                time("slow", 4.0, 0.5, 100.0)};
    }

    /// A take tells how far the resistance has risen so long after a step of power,
    ///     r (1 - exp(-t/tau_1) + share (1 - exp(-t/tau_2))),
    /// and tells the four numbers hardly apart. That rise follows the slopes: a step keeps to it as well as it can.
    void follow(const OperatingRange& e, const double* from, double* p) const override;

    int memorySize(const OperatingRange&) const override { return 2; }
    int coefficientCount(const OperatingRange&) const override { return 4; }

    /// Coefficients: the rise of both stages, ohm/W, and their rates, 1/s.
    template <class T>
    void prepareFor(const OperatingRange&, const T* p, T* c) const
    {
        using std::exp;
        c[0] = p[0];
        c[1] = p[0] * p[2];
        c[2] = exp(-std::numbers::ln10 * p[1]);
        c[3] = exp(-std::numbers::ln10 * p[3]);
    }

    template <class T>
    void addTo(const OperatingRange& e, const T* c, const Motion<T>& at, const T* memory, T* rate,
               Balance<T>& sum) const
    {
        const T rise = c[0] * memory[0] + c[1] * memory[1];
        const T power = (rise + e.scale) * at.i * at.i;
        for (int k = 0; k < 2; ++k)
            rate[k] = c[2 + k] * (power - memory[k]);
        sum.drop += rise * at.i;
    }
};

using Rises = Eigen::Matrix<double, 9, 1>;
using Slopes = Eigen::Matrix<double, 9, 4>;

/// The rise at times from a hundredth of the take to its length, in ohm/W, and its slopes by the four parameters.
void riseOf(const OperatingRange& e, const double* p, Rises& rise, Slopes& slopes)
{
    for (int j = 0; j < rise.size(); ++j) {
        const double t = e.duration * std::pow(10.0, -0.25 * j);
        const auto stage = [&](double logTime, double& slope) {
            const double ratio = t / std::pow(10.0, logTime), left = std::exp(-ratio);
            slope = -std::numbers::ln10 * ratio * left;
            return 1.0 - left;
        };
        double bySlow = 0.0, byFast = 0.0;
        const double fast = stage(p[1], byFast), slow = stage(p[3], bySlow);
        rise[j] = p[0] * (fast + p[2] * slow);
        slopes.row(j) << fast + p[2] * slow, p[0] * byFast, p[0] * slow, p[0] * p[2] * bySlow;
    }
}

void CoilHeating::follow(const OperatingRange& e, const double* from, double* p) const
{
    if (!(from[0] > 0.0 && p[0] > 0.0))
        return;
    Rises wanted, rise;
    Slopes slopes;
    riseOf(e, from, wanted, slopes);
    wanted += slopes * (Eigen::Map<const Eigen::Vector4d>(p) - Eigen::Map<const Eigen::Vector4d>(from));
    const auto bounds = parameters(e);
    Eigen::VectorXd at = Eigen::Map<const Eigen::Vector4d>(p), lower(4), upper(4);
    for (int k = 0; k < 4; ++k) {
        lower[k] = bounds[static_cast<std::size_t>(k)].lower;
        upper[k] = bounds[static_cast<std::size_t>(k)].upper;
    }
    const double scale = wanted.norm();
    if (!(scale > 0.0) || !at.allFinite())
        return;
    minimize(
        [&](const Eigen::VectorXd& where, bool gradient, NormalEquations& sum) {
            riseOf(e, where.data(), rise, slopes);
            const Eigen::VectorXd r = (rise - wanted) / scale;
            sum = NormalEquations(r);
            if (gradient)
                sum.differentiateBy(slopes / scale, r);
            return true;
        },
        at, lower, upper, {.maximumIterations = 30, .costTolerance = 1e-6, .firstDamping = 1e-6});
    Eigen::Map<Eigen::Vector4d>(p, 4) = at;
}

}  // namespace

const Effect& coilHeating()
{
    static const CoilHeating effect;
    return effect;
}

}  // namespace excursion
