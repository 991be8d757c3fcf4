// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Predistortion/ConeShift.h"

#include "Engine/Numerics/Exponential.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

constexpr double meanPeriods = 1.0;  // of the resonance: time constant of what was asked for lately
// of the mean of a tone: a correction is largest while the cone is far out, up to twice its mean
constexpr double widening = 2.0;

/// The same motion by a correction.
LinearMotion byCorrection(LinearMotion motion)
{
    if (motion.correction.size() > 0)
        motion.B = motion.correction;
    return motion;
}

/// x at these times of a cone at rest, of which a correction of 1 V is asked from now on.
Eigen::VectorXd lasting(const LinearMotion& motion, const Eigen::VectorXd& times)
{
    Eigen::VectorXd x = Eigen::VectorXd::Zero(times.size());
    if (motion.correction.size() > 0)
        for (Eigen::Index i = 0; i < times.size(); ++i)
            x[i] = motion.displacement.dot(exponential(motion.A, motion.correction, times[i], 1).phi.col(0));
    return x;
}

/// Between the values of a grid, and the last one beyond it.
double at(const std::vector<double>& values, double place)
{
    const auto last = static_cast<double>(values.size() - 1);
    if (!(place < last))
        return values.back();
    const auto below = static_cast<std::size_t>(place);
    return std::lerp(values[below], values[below + 1], place - std::floor(place));
}

}  // namespace

ConeShift::ConeShift(const LinearMotion& motion, double spacing, double tick, const Eigen::VectorXd& times,
                     const Eigen::VectorXd& ahead)
    : happens_(motion.correction.size() > 0),
      soFar_(byCorrection(motion), 1.0 / spacing),
      perVolt_(lasting(motion, times)),
      perVoltAhead_(lasting(motion, ahead)),
      grid_(motion.holdingStep),
      least_(motion.leastCorrection),
      most_(motion.mostCorrection),
      share_(1.0 - std::exp(-tick * motion.resonance / meanPeriods)),
      middle_(Eigen::VectorXd::Zero(ahead.size())),
      range_(Eigen::VectorXd::Zero(ahead.size())),
      coasted_(Eigen::VectorXd::Zero(times.size()))
{
}

void ConeShift::reset()
{
    soFar_.reset();
    told_ = lately_ = 0.0;
}

void ConeShift::tell(double correction)
{
    told_ = correction;
    lately_ += share_ * (correction - lately_);
}

void ConeShift::step()
{
    if (happens_)
        soFar_.step(told_);
}

void ConeShift::addTo(Eigen::VectorXd& x, const LaidRows& coasting)
{
    if (!happens_)
        return;
    coasting.multiply(soFar_.state().data(), coasted_.data());
    x += coasted_;
    x.noalias() += lately_ * perVolt_;
}

void ConeShift::foresee(double reach)
{
    const double place = grid_ > 0.0 ? reach / grid_ : 0.0,
                 least = std::min({0.0, lately_, widening * at(least_, place)}),
                 most = std::max({0.0, lately_, widening * at(most_, place)});
    middle_.noalias() = 0.5 * (least + most) * perVoltAhead_;
    range_ = 0.5 * (most - least) * perVoltAhead_.cwiseAbs();
}

}  // namespace excursion
