// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Estimate/Wander.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace excursion {
namespace {

/// Scatter and power of the excited lines in one band at one level.
struct Band {
    double scatter = 0.0, power = 0.0;
    int lines = 0;
};

std::vector<double> powerOf(const AveragedPeriods& averages, const Channel& channel, int level)
{
    const int realizations = averages.excitation().realizations;
    std::vector<double> power;
    for (int realization = 0; realization < realizations; ++realization) {
        const auto& period = averages.spectrum(channel, level, realization);
        power.resize(period.mean.size(), 0.0);
        for (std::size_t k = 0; k < power.size(); ++k)
            power[k] += std::norm(period.mean[k]) / realizations;
    }
    return power;
}

/// Means in bands of a third of an octave, or of as many lines as it takes to know a variance.
std::vector<Band> bandsOf(const AveragedPeriods& averages, const Channel& channel, int level)
{
    const auto& take = averages.take();
    const auto &noise = averages.noise(channel, level), &inputNoise = averages.noise(take.input(), level);
    if (noise.variance.empty() || inputNoise.variance.empty())
        return {};
    const auto output = powerOf(averages, channel, level), input = powerOf(averages, take.input(), level);
    const int enough = std::max(1, 32 / std::max(1, noise.degreesOfFreedom));
    std::vector<Band> bands;
    double begin = 0.0;
    int lines = enough;
    for (const int line : averages.lines()) {
        const auto k = static_cast<std::size_t>(line);
        if (lines >= enough && line >= begin * std::cbrt(2.0)) {
            bands.emplace_back();
            begin = line;
            lines = 0;
        }
        bands.back().scatter += std::max(
            0.0, noise.variance[k] - (input[k] > 0.0 ? output[k] / input[k] * inputNoise.variance[k] : 0.0));
        bands.back().power += output[k];
        ++lines;
        bands.back().lines = lines;
    }
    if (lines < enough)
        bands.pop_back();
    for (auto& band : bands) {
        band.scatter /= band.lines;
        band.power /= band.lines;
    }
    return bands;
}

/// Scatter as noise of the same size in every band and a share of the power: v = a + c p, neither negative, each band
/// known to the same share of v.
struct Split {
    double noise = 0.0, share = 0.0;
};

Split splitOf(const std::vector<Band>& bands)
{
    Split best;
    double least = std::numeric_limits<double>::infinity();
    std::vector<double> expected;
    for (const auto& band : bands)
        expected.push_back(band.scatter);
    const auto keep = [&](double a, double c) {
        double cost = 0.0;
        for (std::size_t b = 0; b < bands.size(); ++b)
            cost += std::pow((bands[b].scatter - a - c * bands[b].power) / expected[b], 2);
        if (a >= 0.0 && c >= 0.0 && cost < least) {
            least = cost;
            best = {a, c};
        }
    };
    constexpr int rounds = 10;  // the weights follow what is expected
    for (int round = 0; round < rounds; ++round) {
        double aa = 0.0, ac = 0.0, cc = 0.0, va = 0.0, vc = 0.0;
        for (std::size_t b = 0; b < bands.size(); ++b) {
            const double w = 1.0 / std::max(expected[b] * expected[b], 1e-300);
            aa += w, ac += w * bands[b].power, cc += w * bands[b].power * bands[b].power;
            va += w * bands[b].scatter, vc += w * bands[b].scatter * bands[b].power;
        }
        least = std::numeric_limits<double>::infinity();
        const double determinant = aa * cc - ac * ac;
        if (determinant > 1e-12 * aa * cc)
            keep((cc * va - ac * vc) / determinant, (aa * vc - ac * va) / determinant);
        keep(va / aa, 0.0);
        keep(0.0, vc / cc);
        for (std::size_t b = 0; b < bands.size(); ++b)
            expected[b] = best.noise + best.share * bands[b].power;
    }
    return best;
}

}  // namespace

std::optional<double> wanderDb(const AveragedPeriods& averages, const Channel& channel)
{
    const auto& e = averages.excitation();
    if (e.periods < 2 || e.levels.size() < 2)
        return std::nullopt;
    const int loudest = e.loudest();
    const auto loud = bandsOf(averages, channel, loudest), quiet = bandsOf(averages, channel, 0);
    constexpr std::size_t fewest = 4;
    if (loud.size() < fewest || quiet.size() != loud.size()
        || !std::all_of(loud.begin(), loud.end(), [](const Band& b) { return b.scatter > 0.0; }))
        return std::nullopt;
    const auto split = splitOf(loud);
    Band loudly, quietly;  // where far more than noise is scattered
    constexpr double farMore = 2.0;
    for (std::size_t b = 0; b < loud.size(); ++b)
        if (split.share * loud[b].power > farMore * split.noise) {
            loudly = {loudly.scatter + loud[b].scatter, loudly.power + loud[b].power, 0};
            quietly = {quietly.scatter + quiet[b].scatter, quietly.power + quiet[b].power, 0};
        }
    constexpr double leastRise = 0.3, follows = 0.5;  // decades; a share of that
    // A transient that has not quite died away is not worth a word, nor is what noise hides.
    constexpr double worthAWord = 0.1;  // of all that is scattered within the band
    double wander = 0.0, all = 0.0;
    for (const auto& band : loud)
        wander += band.lines * split.share * band.power;
    for (int k = e.lines.front(); k <= e.lines.back(); ++k)
        all += averages.noise(channel, loudest).variance[static_cast<std::size_t>(k)];
    if (wander < worthAWord * all)
        return std::nullopt;
    const double rise = std::log10(loudly.power / std::max(quietly.power, 1e-300));
    if (!(loudly.scatter > 0.0) || rise < leastRise
        || std::log10(loudly.scatter / std::max(quietly.scatter, 1e-300)) < follows * rise)
        return std::nullopt;
    return 10.0 * std::log10(split.share);
}

}  // namespace excursion
