// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Predistortion/Linearizer.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

constexpr double arrivalTime = 0.2;  // s, until a cone that is told where to go is there
constexpr double joinTime = 0.025;   // s, time constant; far shorter, so that they are alike by then
constexpr int mostCorrections = 3;

}  // namespace

Linearizer::Linearizer(const Model& model, double sampleRate, const AmplifierCoupling& coupling)
    : wish_ {Reference(model, sampleRate), Inverse(model, sampleRate)},
      cone_(wish_),
      joining_(1.0 - std::exp(-1.0 / (joinTime * sampleRate))),
      settling_(static_cast<int>(arrivalTime * sampleRate)),
      withheld_(coupling, sampleRate),
      passed_(1.0 - withheld_.direct()),
      perPassed_(1.0 / passed_),
      state_(static_cast<std::size_t>(wish_.reference.state().size()) + withheld_.order())
{
}

void Linearizer::reset()
{
    for (auto* pair : {&wish_, &cone_}) {
        pair->reference.reset();
        pair->inverse.reset();
        pair->made = 0.0;
    }
    follows_ = false;
    alike_ = 0;
    wanted_ = 0.0;
    withheld_.reset();
}

Eigen::Map<const Eigen::VectorXd> Linearizer::state()
{
    const auto driver = cone().state();
    if (withheld_.order() == 0)
        return driver;
    std::copy(driver.begin(), driver.end(), state_.begin());
    for (std::size_t k = 0; k < withheld_.order(); ++k)
        state_[static_cast<std::size_t>(driver.size()) + k] = withheld_.state(k);
    return {state_.data(), static_cast<Eigen::Index>(state_.size())};
}

void Linearizer::rest()
{
    Warmth kept;
    keep(kept);
    reset();
    warm(kept);
}

void Linearizer::keep(Warmth& warmth) const
{
    (follows_ ? cone_ : wish_).inverse.keep(warmth);
    warmth.charge = withheld_.charge();
}

void Linearizer::warm(const Warmth& warmth)
{
    for (auto* pair : {&wish_, &cone_})
        pair->inverse.warm(warmth);
    withheld_.charge(warmth.charge);
}

void Linearizer::drift(const MotionPoint& motion, double seconds) { followed().inverse.drift(motion, seconds); }

void Linearizer::Pair::step(double u) { made = inverse.step(reference.step(u)); }

/// Secant steps; the first one takes the inverse for linear in the voltage, with the force factor as it is at this
/// place.
void Linearizer::Pair::moveTo(double voltage)
{
    double byInput = inverse.ease();
    const double close = 1e-6 * std::abs(voltage);
    for (int k = 0; k < mostCorrections && std::abs(voltage - made) > close; ++k) {
        const double difference = (voltage - made) / byInput, before = made;
        made = inverse.again(reference.correct(difference));
        if (const double slope = (made - before) / difference; slope > 0.2 * byInput && slope < 5.0 * byInput)
            byInput = slope;
    }
}

double Linearizer::step(double u, double amount, double limit)
{
    alike_ = amount < 1.0 ? 0 : alike_ + 1;
    if (amount < 1.0 && !follows_) {
        cone_ = wish_;
        follows_ = true;
    } else if (follows_ && alike_ > settling_) {
        wish_ = cone_;
        follows_ = false;
    }
    // Where the reference goes is free, as long as the driver is then given what takes it there: a guess of l does.
    const double kept = withheld_.coming(), left = u - (kept + withheld_.direct() * withheld_.latest());
    wish_.step(left);
    wanted_ = u + amount * (perPassed_ * (wish_.made + kept) - u);
    const double out = std::clamp(wanted_, -limit, limit), given = passed_ * out - kept;
    if (follows_) {
        cone_.step(left);
        cone_.moveTo(given);
        wish_.inverse.join(cone_.inverse, alike_ > 0 ? joining_ : 0.0);
    } else if (out != wanted_) {
        wish_.moveTo(given);
    }
    return out;
}

}  // namespace excursion
