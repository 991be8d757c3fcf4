// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Estimate/DriftNoise.h"

#include <Eigen/QR>

#include <algorithm>
#include <limits>
#include <span>

namespace excursion {
namespace {

constexpr std::size_t terms = 3, fewestLines = 5 * terms;

/// Neighbouring lines that share their noise.
std::vector<std::span<const int>> blocksOf(std::span<const int> lines)
{
    std::vector<std::span<const int>> blocks;
    while (lines.size() >= fewestLines) {
        const auto count = lines.size() < 2 * fewestLines ? lines.size() : fewestLines;
        blocks.push_back(lines.first(count));
        lines = lines.subspan(count);
    }
    return blocks;
}

/// The columns of the local model on a block's lines.
Eigen::MatrixXcd regressorsOf(std::span<const int> lines, const AveragedPeriod& input)
{
    const auto rows = static_cast<Eigen::Index>(lines.size());
    Eigen::MatrixXcd columns(rows, static_cast<Eigen::Index>(terms));
    const double middle = 0.5 * (lines.front() + lines.back()),
                 half = std::max(1.0, 0.5 * (lines.back() - lines.front()));
    for (Eigen::Index r = 0; r < rows; ++r) {
        const int line = lines[static_cast<std::size_t>(r)];
        const auto k = static_cast<std::size_t>(line);
        const double kappa = (line - middle) / half;
        columns.row(r) << input.mean[k], kappa * input.mean[k], kappa * kappa * input.mean[k];
    }
    return columns;
}

}  // namespace

std::vector<double> noiseBesideDrift(const AveragedPeriods& averages, const Channel& channel, int level)
{
    const auto& take = averages.take();
    const auto& e = averages.excitation();
    if (e.periods < 2)
        return {};
    const auto blocks = blocksOf(averages.lines());
    std::vector<double> own(averages.spectrum(channel, level, 0).mean.size(), 0.0), freedom(blocks.size(), 0.0);
    const double P = e.periods;
    for (int realization = 0; realization < e.realizations; ++realization) {
        const auto& input = averages.spectrum(take.input(), level, realization);
        const auto& output = averages.spectrum(channel, level, realization);
        const auto periods = periodSpectra(take, channel, level, realization);
        for (std::size_t b = 0; b < blocks.size(); ++b) {
            const auto lines = blocks[b];
            Eigen::MatrixXcd deviation(static_cast<Eigen::Index>(lines.size()),
                                       static_cast<Eigen::Index>(periods.size()));
            for (std::size_t p = 0; p < periods.size(); ++p)
                for (std::size_t r = 0; r < lines.size(); ++r) {
                    const auto k = static_cast<std::size_t>(lines[r]);
                    deviation(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(p)) = periods[p][k]
                                                                                            - output.mean[k];
                }
            const auto columns = regressorsOf(lines, input);
            const Eigen::ColPivHouseholderQR<Eigen::MatrixXcd> qr(columns);
            deviation -= columns * qr.solve(deviation);
            for (std::size_t r = 0; r < lines.size(); ++r)
                own[static_cast<std::size_t>(lines[r])] += deviation.row(static_cast<Eigen::Index>(r)).squaredNorm()
                                                           / P;
            freedom[b] += static_cast<double>(deviation.rows() - qr.rank()) * (P - 1.0);
        }
    }
    std::vector<double> variance(own.size(), std::numeric_limits<double>::infinity());
    constexpr double most = 6.0;  // times what neighbours share
    for (std::size_t b = 0; b < blocks.size(); ++b) {
        double shared = 0.0;
        for (const int line : blocks[b])
            shared += own[static_cast<std::size_t>(line)] / freedom[b];
        const double lines = static_cast<double>(blocks[b].size());
        for (const int line : blocks[b])
            variance[static_cast<std::size_t>(line)] = std::max(shared, own[static_cast<std::size_t>(line)] * lines
                                                                            / (most * freedom[b]));
    }
    return variance;
}

}  // namespace excursion
