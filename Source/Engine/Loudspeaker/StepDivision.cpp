// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/StepDivision.h"

#include "Engine/Loudspeaker/StepParts.h"
#include "Engine/Numerics/Parallel.h"

#include <algorithm>
#include <cmath>
#include <mutex>

namespace excursion {
namespace {

constexpr double outer = 0.7;  // share of the current's range from which on the end of it counts

}  // namespace

int StepDivision::cellOfVelocity(double share)
{
    const double size = std::abs(share);
    const int level = size <= 0.25 ? 0 : size <= 0.5 ? 1 : 2;
    return share < 0.0 ? level : speeds + level;
}

StepDivision::StepDivision(const Model& model, double sampleRate, unsigned threads)
{
    constexpr std::array<double, speeds> shares {0.25, 0.5, 1.0};
    StepParts parts(model, 1.0 / sampleRate);
    const auto slopes = parts[0].lawSlopes(ExponentialStep::Places::all, shares);
    std::vector<std::array<std::vector<const ExponentialStep::LawSlope*>, cellsV>> places;  // [table][velocity]
    for (const auto& slope : slopes) {
        auto table = std::find_if(tables_.begin(), tables_.end(), [&](const Table& known) {
            return known.displacement == slope.range->displacement && known.velocity == slope.range->velocity
                   && known.current == slope.range->current;
        });
        if (table == tables_.end()) {
            table = tables_.insert(table, {slope.range->displacement, slope.range->velocity, slope.range->current});
            places.emplace_back();
        }
        places[static_cast<std::size_t>(table - tables_.begin())]
              [static_cast<std::size_t>(cellOfVelocity(slope.velocity))]
                  .push_back(&slope);
    }
    std::mutex making;
    const auto isStable = [&](int power, const Eigen::MatrixXd& slope) {
        const auto& part = [&]() -> const ExponentialStep& {
            const std::lock_guard lock(making);
            return parts[power];
        }();
        return part.isStable(slope);
    };
    inParallel(tables_.size() * cellsV, threads, {}, [&](std::size_t n) {  // of which none shares a cell with another
        for (const auto* slope : places[n / cellsV][n % cellsV])
            divide(tables_[n / cellsV], *slope, isStable);
        return true;
    });
}

/// Raises the cells about a place to the least power that is stable there.
template <class IsStable>
void StepDivision::divide(Table& table, const ExponentialStep::LawSlope& slope, const IsStable& isStable)
{
    const int v = cellOfVelocity(slope.velocity);
    const int x = static_cast<int>(std::lround(4.0 * (slope.displacement + 1.0)));  // the cells on either side
    const int lowX = std::max(0, x - 1), highX = std::min(cellsX - 1, x);
    const int end = slope.current < 0.0 ? 0 : cellsI - 1, middle = 1;
    const bool inner = std::abs(slope.current) < 0.5 * (1.0 + outer);
    const auto each = [&](const auto& work) {
        for (int k = lowX; k <= highX; ++k) {
            work(table.power[static_cast<std::size_t>(cellOf(k, end, v))]);
            if (inner)
                work(table.power[static_cast<std::size_t>(cellOf(k, middle, v))]);
        }
    };
    constexpr int powers = StepParts::powers;
    signed char least = powers;
    each([&](signed char known) { least = std::min(least, known); });
    int power = least;  // where all cells have more this place asks for nothing
    while (power < powers - 1 && !isStable(power, slope.slope))
        ++power;
    each([&](signed char& known) { known = std::max(known, static_cast<signed char>(power)); });
}

int StepDivision::power(double i, double x, double v) const
{
    int most = 0;
    for (const auto& table : tables_) {
        const double place = std::floor(4.0 * (x / table.displacement + 1.0)), share = i / table.current;
        // what is not finite is in no cell
        const int cellX = place > 0.0 ? static_cast<int>(std::min<double>(place, cellsX - 1)) : 0;
        const int cellI = share < -outer ? 0 : share <= outer ? 1 : 2;
        most = std::max<int>(
            most, table.power[static_cast<std::size_t>(cellOf(cellX, cellI, cellOfVelocity(v / table.velocity)))]);
    }
    return most;
}

}  // namespace excursion
