// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Diagnosis/RestShift.h"

#include "Engine/Diagnosis/ResidualCurves.h"

#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <limits>

namespace excursion {
namespace {

/// Means over one section, m.
struct Means {
    double time, measured, model, deviation, rms;
};

std::vector<Means> meansOf(const Record& record, const std::vector<SectionFit>& fits, std::size_t channel)
{
    std::vector<Means> means;
    for (const auto n : sectionsInTime(record)) {
        const auto& section = record.sections[n];
        const auto N = static_cast<double>(section.window);
        const auto& lines = section.measured[channel];
        double power = 0.0;
        for (std::size_t k = 1; k < lines.size(); ++k)
            power += 2.0 * std::norm(lines[k] / N);
        means.push_back({section.middle, lines.front().real() / N, fits[n].predicted[channel].front().real() / N,
                         section.deviation[channel].front() / N, std::sqrt(power)});
    }
    return means;
}

/// A step between section `after` and the next one.
struct Shift {
    std::size_t after = 0;
    double size = 0.0;                                      ///< m
    double left = std::numeric_limits<double>::infinity();  ///< m, the largest that it leaves
};

/// The step there, by least squares; none that b explains.
std::optional<Shift> stepAfter(const std::vector<Means>& means, std::size_t after)
{
    const auto rows = static_cast<Eigen::Index>(means.size());
    Eigen::VectorXd beside(rows), step = Eigen::VectorXd::Zero(rows);
    Eigen::MatrixXd others(rows, 2);
    for (Eigen::Index n = 0; n < rows; ++n) {
        const auto& one = means[static_cast<std::size_t>(n)];
        beside[n] = one.measured - one.model;
        step[n] = static_cast<std::size_t>(n) > after ? 1.0 : 0.0;
        others.row(n) << 1.0, one.model;
    }
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(others);
    const Eigen::VectorXd own = step - others * qr.solve(step), rest = beside - others * qr.solve(beside);
    constexpr double least = 0.1;  // of the step, that nothing else does
    if (own.squaredNorm() < least * (step.array() - step.mean()).square().sum())
        return std::nullopt;
    const double size = own.dot(rest) / own.squaredNorm();
    return Shift {after, size, (rest - size * own).cwiseAbs().maxCoeff()};
}

}  // namespace

std::optional<RestShift> restShift(const Record& record, const std::vector<SectionFit>& fits)
{
    constexpr std::size_t fewest = 4, beside = 2;
    const auto channel = record.channelIndex(Quantity::displacement);
    if (!channel || !hasPeriods(record) || !record.noiseKnown || record.sections.size() < fewest
        || std::any_of(fits.begin(), fits.end(), [](const SectionFit& fit) { return !fit.finite; }))
        return std::nullopt;
    const auto means = meansOf(record, fits, *channel);
    Shift best;
    for (std::size_t after = beside - 1; after + beside < means.size(); ++after)
        if (const auto step = stepAfter(means, after); step && step->left < best.left)
            best = *step;
    double explained = 0.0, rms = 0.0;
    for (const auto& one : means) {
        explained = std::max(explained, std::abs(one.model));
        rms = std::max(rms, one.rms);
    }
    const auto &here = means[best.after], &next = means[best.after + 1];
    const double moved = std::abs(best.size), noise = std::hypot(here.deviation, next.deviation);
    constexpr double sure = 6.0, hardly = 0.05, worthAWord = 0.01, seen = 0.5;
    if (!(moved > sure * noise && best.left < hardly * moved + sure * noise && moved > explained
          && moved > worthAWord * rms && std::abs(next.measured - here.measured) > seen * moved))
        return std::nullopt;
    return RestShift {moved, here.time, next.time};
}

}  // namespace excursion
