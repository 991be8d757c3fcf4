// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/StepCurvature.h"

#include "Engine/Loudspeaker/Residual.h"

#include <algorithm>
#include <utility>

namespace excursion {

StepCurvature::StepCurvature(const Record& record, const std::vector<std::size_t>& sections, Predict predict)
    : record_(record), sections_(sections), predict_(std::move(predict))
{
}

void StepCurvature::beginAt(std::vector<SectionFit> fits)
{
    slopes_ = std::move(fits);
    here_.clear();
}

Eigen::VectorXd StepCurvature::along(const Eigen::VectorXd& theta, const Eigen::VectorXd& step,
                                     const Eigen::VectorXd& lower, const Eigen::VectorXd& upper)
{
    constexpr double h = 0.2;
    const Eigen::VectorXd behind = theta - h * step, ahead = theta + h * step;
    const auto stays = behind.array() < lower.array() || behind.array() > upper.array();
    if (here_.empty())
        here_ = predict_(theta);
    const auto before = predict_(stays.select(theta, behind)), after = predict_(stays.select(theta, ahead));
    const auto finite = [](const std::vector<SectionFit>& fits) {
        return std::all_of(fits.begin(), fits.end(), [](const SectionFit& fit) { return fit.finite; });
    };
    if (!finite(here_) || !finite(before) || !finite(after))
        return {};
    Eigen::VectorXd pull = Eigen::VectorXd::Zero(theta.size());
    for (std::size_t s = 0; s < sections_.size(); ++s) {
        const Residual residual(record_, record_.sections[sections_[s]]);
        Eigen::VectorXd bend(residual.rows());
        for (std::size_t c = 0; c < record_.channels.size(); ++c) {
            auto second = here_[s].predicted[c];
            for (std::size_t k = 0; k < second.size(); ++k)
                second[k] = (after[s].predicted[c][k] - 2.0 * second[k] + before[s].predicted[c][k]) / (h * h);
            residual.fill(c, second, bend);
            pull += (slopes_[s].slopes[c].transpose() * bend.cast<float>()).cast<double>();
        }
    }
    return pull;
}

}  // namespace excursion
