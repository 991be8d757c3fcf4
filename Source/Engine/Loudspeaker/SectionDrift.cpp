// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/SectionDrift.h"

#include <Eigen/LU>

#include <algorithm>

namespace excursion {
namespace {

constexpr double stiffnessMoves = 0.02, resistanceMoves = 0.005;  // sigma

}  // namespace

bool SectionDrift::mayDrift(const Record& record, const Section& section)
{
    const auto quietest = std::min_element(record.levels.begin(), record.levels.end()) - record.levels.begin();
    const auto reference = std::find_if(record.sections.begin(), record.sections.end(), [&](const Section& s) {
        return s.level == quietest && !s.validation;
    });
    return record.levels.size() > 1 && &section != &*reference;
}

SectionDrift::SectionDrift(const Model& model, const Record& record, const Residual& residual, const Paths& paths,
                           const Spectrum& i, const Spectrum& x)
    : residual_(residual)
{
    const auto through = [&](const Path& path, double gain, const Spectrum& drive) {
        Spectrum result(drive.size(), 0.0);
        for (std::size_t k = residual.firstLine(); k <= residual.lastLine(); ++k)
            result[k] = gain * path.value[k - paths.first] * drive[k];
        return result;
    };
    const auto channels = record.channels.size();
    const double K = model.baseParameter("K").value;
    acts_.emplace_back();
    for (std::size_t c = 0; c < channels; ++c)
        acts_.back().push_back(through(paths.fromForce[c], -K, x));
    Eigen::VectorXd expected(model.electrical() ? 2 : 1);
    expected[0] = stiffnessMoves;
    if (model.electrical()) {
        const double Re = model.baseParameter("Re").value;
        acts_.emplace_back();
        for (std::size_t c = 0; c < channels; ++c)
            acts_.back().push_back(through(paths.fromVoltage[c], -Re, i));
        expected[1] = resistanceMoves;
    }
    const auto count = expected.size();
    Eigen::MatrixXd M = expected.array().square().inverse().matrix().asDiagonal();
    for (std::size_t c = 0; c < channels; ++c) {
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
    for (std::size_t c = 0; c < r.size(); ++c) {
        r[c].noalias() += a_[c] * drift;
        for (std::size_t p = 0; p < acts_.size(); ++p)
            for (std::size_t k = 0; k < predicted[c].size(); ++k)
                predicted[c][k] += drift[static_cast<Eigen::Index>(p)] * acts_[p][c][k];
    }
    return {drift[0], drift.size() > 1 ? drift[1] : 0.0};
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
