// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Estimate/DriftNoise.h"

#include <Eigen/QR>

#include <algorithm>
#include <limits>
#include <span>

namespace excursion {
namespace {

constexpr std::size_t terms = 4, fewestLines = 4 * terms;
constexpr double widest = 1.0 / 32.0;  // of its frequency, where lines are dense

/// Neighbouring lines that share their noise.
std::vector<std::span<const int>> blocksOf(std::span<const int> lines)
{
    std::vector<std::span<const int>> blocks;
    while (lines.size() >= fewestLines) {
        std::size_t count = fewestLines;
        while (count < lines.size() && lines[count] < (1.0 + widest) * lines.front())
            ++count;
        if (lines.size() - count < fewestLines)
            count = lines.size();
        blocks.push_back(lines.first(count));
        lines = lines.subspan(count);
    }
    return blocks;
}

/// The columns of the local model on a block's lines.
Eigen::MatrixXcd regressorsOf(std::span<const int> lines, const AveragedPeriod& input, const AveragedPeriod& output)
{
    const auto rows = static_cast<Eigen::Index>(lines.size());
    Eigen::MatrixXcd columns(rows, static_cast<Eigen::Index>(terms));
    const double middle = 0.5 * (lines.front() + lines.back()),
                 half = std::max(1.0, 0.5 * (lines.back() - lines.front()));
    for (Eigen::Index r = 0; r < rows; ++r) {
        const int line = lines[static_cast<std::size_t>(r)];
        const auto k = static_cast<std::size_t>(line);
        const double kappa = (line - middle) / half;
        columns.row(r) << input.mean[k], kappa * input.mean[k], output.mean[k], kappa * output.mean[k];
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
    std::vector<double> sums(blocks.size(), 0.0), freedom(blocks.size(), 0.0);
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
            Eigen::ColPivHouseholderQR<Eigen::MatrixXcd> qr(regressorsOf(lines, input, output));
            deviation.applyOnTheLeft(qr.householderQ().adjoint());
            const auto left = deviation.rows() - qr.rank();
            sums[b] += deviation.bottomRows(left).squaredNorm() / P;
            freedom[b] += static_cast<double>(left) * (P - 1.0);
        }
    }
    std::vector<double> variance(averages.spectrum(channel, level, 0).mean.size(),
                                 std::numeric_limits<double>::infinity());
    for (std::size_t b = 0; b < blocks.size(); ++b)
        for (const int line : blocks[b])
            variance[static_cast<std::size_t>(line)] = sums[b] / freedom[b];
    return variance;
}

}  // namespace excursion
