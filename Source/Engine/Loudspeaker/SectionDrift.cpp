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
    : residual_(residual)
{
    const bool moves = &section != &referenceOf(record);
    const auto add = [&](const std::vector<Path>& through, double gain, const Spectrum& drive, const Motion& motion) {
        std::vector<Spectrum> act, onTheWay;
        for (const auto& path : through) {
            act.emplace_back(drive.size(), 0.0);
            for (std::size_t k = residual.firstLine(); k <= residual.lastLine(); ++k)
                act.back()[k] = gain * path.value[k - paths.first] * drive[k];
            onTheWay.push_back(ramped(act.back(), section.window));
        }
        if (moves) {
            acts_.push_back(std::move(act));
            motions_.push_back(motion);
        }
        acts_.push_back(std::move(onTheWay));
        motions_.push_back({nullptr, perWindow * motion.sigma});
    };
    add(paths.fromForce, -model.baseParameter("K").value, x, {&Amount::stiffness, stiffnessMoves});
    if (model.electrical())
        add(paths.fromVoltage, -model.baseParameter("Re").value, i, {&Amount::resistance, resistanceMoves});
    const auto count = static_cast<Eigen::Index>(motions_.size());
    Eigen::MatrixXd M = Eigen::MatrixXd::Zero(count, count);
    for (Eigen::Index p = 0; p < count; ++p)
        M(p, p) = std::pow(motions_[static_cast<std::size_t>(p)].sigma, -2);
    for (std::size_t c = 0; c < record.channels.size(); ++c) {
        Eigen::MatrixXd a(residual.rows(), count);
        for (Eigen::Index p = 0; p < count; ++p)
            residual.fill(c, acts_[static_cast<std::size_t>(p)][c], a.col(p));
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
    for (std::size_t p = 0; p < motions_.size(); ++p) {
        const double by = drift[static_cast<Eigen::Index>(p)];
        if (motions_[p].amount)
            amount.*motions_[p].amount = by;
        for (std::size_t c = 0; c < r.size(); ++c)
            for (std::size_t k = 0; k < predicted[c].size(); ++k)
                predicted[c][k] += by * acts_[p][c][k];
    }
    for (std::size_t c = 0; c < r.size(); ++c)
        r[c].noalias() += a_[c] * drift;
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
