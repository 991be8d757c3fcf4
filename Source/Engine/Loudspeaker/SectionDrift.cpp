// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/SectionDrift.h"

#include "Engine/Signal/Fft.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

using Spectrum = SectionDrift::Spectrum;

constexpr double stiffnessMoves = 0.02, resistanceMoves = 0.005, perWindow = 0.1;  // sigma

/// The section to which the model's K and Re belong.
const Section& referenceOf(const Record& record)
{
    const auto quietest = std::min_element(record.levels.begin(), record.levels.end()) - record.levels.begin();
    const auto found = std::find_if(record.sections.begin(), record.sections.end(),
                                    [&](const Section& s) { return s.level == quietest && !s.validation; });
    return found != record.sections.end() ? *found : record.sections.front();
}

/// Over the window a ramp times what has this spectrum.
Spectrum ramped(const Spectrum& spectrum, std::size_t window)
{
    auto samples = inverseFft(spectrum, window);
    for (std::size_t n = 0; n < window; ++n)
        samples[n] *= (static_cast<double>(n) + 0.5) / static_cast<double>(window) - 0.5;
    return fft(samples);
}

}  // namespace

SectionDrift::SectionDrift(const Model& model, const Record& record, const Section& section, const Residual& residual,
                           const Paths& paths, const Spectrum& i, const Spectrum& x)
    : section_(section), residual_(residual)
{
    const bool moves = &section != &referenceOf(record);
    const auto add = [&](const std::vector<Path>& through, double gain, const Spectrum& drive, Motion motion) {
        for (const auto& path : through) {
            auto& act = motion.act.emplace_back(drive.size(), 0.0);
            for (std::size_t k = residual.firstLine(); k <= residual.lastLine(); ++k)
                act[k] = gain * path.value[k - paths.first] * drive[k];
        }
        if (moves)
            motions_.push_back(motion);
        motion.sigma *= perWindow;
        motion.onTheWay = true;
        motions_.push_back(std::move(motion));
    };
    add(paths.fromForce, -model.baseParameter("K").value, x, {&Amount::stiffness, stiffnessMoves, {}, false});
    if (model.electrical())
        add(paths.fromVoltage, -model.baseParameter("Re").value, i, {&Amount::resistance, resistanceMoves, {}, false});
    const auto count = static_cast<Eigen::Index>(motions_.size());
    Eigen::MatrixXd M = Eigen::MatrixXd::Zero(count, count);
    for (Eigen::Index p = 0; p < count; ++p)
        M(p, p) = std::pow(motions_[static_cast<std::size_t>(p)].sigma, -2);
    for (std::size_t c = 0; c < record.channels.size(); ++c) {
        Eigen::MatrixXd a(residual.rows(), count);
        for (Eigen::Index p = 0; p < count; ++p) {
            const auto& motion = motions_[static_cast<std::size_t>(p)];
            residual.fill(c, motion.onTheWay ? ramped(motion.act[c], section.window) : motion.act[c], a.col(p));
        }
        M.noalias() += a.transpose() * a;
        a_.push_back(std::move(a));
    }
    inverse_ = M.inverse();
}

SectionDrift::Amount SectionDrift::follow(std::vector<Spectrum>& predicted, std::vector<Eigen::VectorXd>& r) const
{
    Eigen::VectorXd pull = Eigen::VectorXd::Zero(inverse_.rows());
    for (std::size_t c = 0; c < r.size(); ++c)
        pull.noalias() += a_[c].transpose() * r[c];
    const Eigen::VectorXd drift = -inverse_ * pull;
    Amount amount;
    for (std::size_t p = 0; p < motions_.size(); ++p)
        if (!motions_[p].onTheWay)
            amount.*motions_[p].amount = drift[static_cast<Eigen::Index>(p)];
    for (std::size_t c = 0; c < r.size(); ++c) {
        Spectrum step(predicted[c].size(), 0.0), moved(predicted[c].size(), 0.0);
        for (std::size_t p = 0; p < motions_.size(); ++p) {
            auto& sum = motions_[p].onTheWay ? step : moved;
            for (std::size_t k = residual_.firstLine(); k <= residual_.lastLine(); ++k)
                sum[k] += drift[static_cast<Eigen::Index>(p)] * motions_[p].act[c][k];
        }
        double& power = amount.onTheWay.emplace_back(0.0);
        for (const int k : section_.excited)
            power += std::norm(step[static_cast<std::size_t>(k)]);
        const auto ramp = ramped(step, section_.window);
        for (std::size_t k = 0; k < predicted[c].size(); ++k)
            predicted[c][k] += moved[k] + ramp[k];
        r[c].noalias() += a_[c] * drift;
    }
    return amount;
}

void SectionDrift::takeOut(std::vector<Eigen::MatrixXd>& J) const
{
    Eigen::MatrixXd pulls = Eigen::MatrixXd::Zero(inverse_.rows(), J.front().cols());
    for (std::size_t c = 0; c < J.size(); ++c)
        pulls.noalias() += a_[c].transpose() * J[c];
    const Eigen::MatrixXd moves = inverse_ * pulls;
    for (std::size_t c = 0; c < J.size(); ++c)
        J[c].noalias() -= a_[c] * moves;
}

}  // namespace excursion
