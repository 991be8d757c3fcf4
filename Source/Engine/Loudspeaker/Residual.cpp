// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/Residual.h"

#include "Engine/Numerics/Gram.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

namespace excursion {

void ErrorPower::add(const ErrorPower& other)
{
    error += other.error;
    measured += other.measured;
    noise += other.noise;
}

Residual::Residual(const Record& record, const Section& section) : section_(section)
{
    std::tie(first_, last_) = record.lineRange(section);
    lines_ = static_cast<Eigen::Index>(last_ - first_ + 1);
    for (const auto& deviation : section.deviation) {
        auto& weight = weight_.emplace_back(lines_);
        for (Eigen::Index n = 0; n < lines_; ++n)
            weight[n] = std::numbers::sqrt2 / deviation[first_ + static_cast<std::size_t>(n)];
    }
}

Eigen::VectorXd Residual::of(std::size_t channel, const std::vector<std::complex<double>>& predicted) const
{
    auto error = predicted;
    for (std::size_t k = first_; k <= last_; ++k)
        error[k] -= section_.measured[channel][k];
    Eigen::VectorXd r(rows());
    fill(channel, error, r);
    return r;
}

ErrorPower Residual::power(std::size_t channel, const std::vector<std::complex<double>>& predicted) const
{
    const auto& measured = section_.measured[channel];
    const auto& deviation = section_.deviation[channel];
    ErrorPower power;
    for (std::size_t k = first_; k <= last_; ++k) {
        power.error += std::norm(predicted[k] - measured[k]);
        power.measured += std::norm(measured[k]);
        power.noise += deviation[k] * deviation[k];
    }
    return power;
}

Eigen::MatrixXd Residual::pulls(const Eigen::MatrixXd& J, const Eigen::VectorXd& r) const
{
    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(J.cols(), bands);
    const double low = static_cast<double>(first_) + 0.5, octaves = std::log2((static_cast<double>(last_) + 1.5) / low);
    Eigen::Index from = 0;
    for (Eigen::Index b = 0; b < bands; ++b) {
        const double end = low * std::exp2(octaves * static_cast<double>(b + 1) / bands) - static_cast<double>(first_);
        const auto until = b + 1 == bands ? lines_ : std::clamp<Eigen::Index>(std::lround(end), from, lines_);
        const auto count = until - from;
        result.col(b).noalias() = J.middleRows(from, count).transpose() * r.segment(from, count)
                                  + J.middleRows(lines_ + from, count).transpose() * r.segment(lines_ + from, count);
        from = until;
    }
    return result;
}

Eigen::MatrixXd Residual::shared(const std::vector<Eigen::MatrixXd>& J) const
{
    if (section_.inputNoise.size() != J.size())
        return {};
    std::vector<Eigen::Index> played;
    for (Eigen::Index n = 0; n < lines_; ++n)
        if (section_.inputNoise.front()[first_ + static_cast<std::size_t>(n)] != 0.0)
            played.push_back(n);
    const auto count = static_cast<Eigen::Index>(played.size()), columns = J.front().cols();
    Eigen::MatrixXd own(2 * count, columns), all = Eigen::MatrixXd::Zero(2 * count, columns),
                                             result = Eigen::MatrixXd::Zero(columns, columns);
    for (std::size_t c = 0; c < J.size(); ++c) {
        for (Eigen::Index n = 0; n < count; ++n) {
            const auto line = played[static_cast<std::size_t>(n)];
            const auto k = first_ + static_cast<std::size_t>(line);
            const auto share = section_.inputNoise[c][k] / section_.deviation[c][k];
            own.row(n) = share.real() * J[c].row(line) + share.imag() * J[c].row(lines_ + line);
            own.row(count + n) = share.imag() * J[c].row(line) - share.real() * J[c].row(lines_ + line);
        }
        result -= gram(own);
        all += own;
    }
    return result + gram(all);
}

void Residual::fill(std::size_t channel, const std::vector<std::complex<double>>& derivative,
                    Eigen::Ref<Eigen::VectorXd> column) const
{
    const auto& weight = weight_[channel];
    const auto* line = derivative.data() + first_;
    for (Eigen::Index n = 0; n < lines_; ++n) {
        column[n] = weight[n] * line[n].real();
        column[lines_ + n] = weight[n] * line[n].imag();
    }
}

}  // namespace excursion
