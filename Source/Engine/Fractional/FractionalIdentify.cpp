// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Fractional/FractionalIdentify.h"

#include "Engine/Document/Engineering.h"
#include "Engine/Error.h"
#include "Engine/Fractional/AlphaCurve.h"
#include "Engine/Linear/Identify.h"
#include "Engine/Validity.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace excursion {
namespace {

using Eigen::Index;

constexpr double notKnown = std::numeric_limits<double>::quiet_NaN();
constexpr double asWell = 2.0;  // a rise of V that two standard errors make

Index parametersOf(const FrequencyData& data, int order, bool free)
{
    return order * (data.inputs + data.outputs) + data.inputs * data.outputs + (free ? 1 : 0);
}

/// Complex values less what the parameters of a free alpha take of them.
double freedomOf(const FrequencyData& data, int order)
{
    return std::max(1.0, static_cast<double>(data.value.size())
                             - 0.5 * static_cast<double>(parametersOf(data, order, true)));
}

/// Where the curve, in units of another (`unit`), stays within what two standard errors make above `least`; first above
/// second: nowhere.
std::pair<double, double> rangeOf(const std::vector<AlphaChiSquared>& curve, double least, double unit = 1.0)
{
    std::pair<double, double> range {2.0, 0.0};
    for (const auto& point : curve)
        if (point.chiSquared * unit <= least + asWell)
            range = {std::min(range.first, point.alpha), std::max(range.second, point.alpha)};
    return range;
}

FractionalIdentification fixedAlpha(const FrequencyData& data, const FractionalOptions& options,
                                    const Progress& progress)
{
    auto found = identify(data, linearOptions(options, *options.alpha), progress);
    FractionalIdentification result;
    result.model = {*options.alpha, std::move(found.model)};
    result.cost = found.cost;
    result.errorDb = found.errorDb;
    result.chiSquared = found.chiSquared;
    result.start = found.start;
    result.refinement = found.refinement;
    return result;
}

FractionalIdentification freeAlpha(const FrequencyData& data, const FractionalOptions& options,
                                   const Progress& progress)
{
    AlphaCurve curve(data, options);
    curve.search(progress.part(0.0, 0.85));
    progress.at(0.85, "searching alpha");
    const auto best = curve.lowest();

    const double freedom = freedomOf(data, options.order);
    const bool known = data.deviation.size() != 0;
    const double unit = known ? 1.0 : best.V / freedom;
    const double second = curvatureInAlpha(best.fit, data);

    FractionalIdentification result;
    auto found = judged(realize(best.fit.sections, best.fit.C, best.fit.D), data, best.alpha);
    result.model = {best.alpha, std::move(found.model)};
    result.cost = best.fit.cost;
    result.errorDb = found.errorDb;
    result.chiSquared = found.chiSquared;
    result.start = best.start;
    result.refinement = best.refinement;
    for (const auto& point : curve.points())
        result.curve.push_back({point.alpha, point.V / unit});
    const auto above = std::find_if(result.curve.begin(), result.curve.end(),
                                    [&](const auto& p) { return p.alpha > best.alpha; });
    result.curve.insert(above, {best.alpha, best.V / unit});

    const bool inside = best.alpha > options.leastAlpha + 1e-3 && best.alpha < options.mostAlpha - 1e-3;
    // Of the noise, or of what is left where that is more; without deviations V is the cost, over the power that
    // curvatureInAlpha() does not divide by.
    const double left = known ? best.V : best.V * weightsOf(data).cwiseProduct(data.value.cwiseAbs()).squaredNorm();
    const double spread = known ? std::max(1.0, left / freedom) : left / freedom;
    result.alphaStandardError = inside && second > 0.0 ? std::sqrt(spread / second) : notKnown;
    const auto [low, high] = rangeOf(result.curve, best.V / unit);
    if (!inside)
        result.warning = "The error falls towards the end of the search at alpha " + plainText(best.alpha, 2)
                         + ", so alpha is not determined.";
    else if (!std::isfinite(result.alphaStandardError)
             || high > best.alpha + 3.0 * result.alphaStandardError + options.gridStep
             || low < best.alpha - 3.0 * result.alphaStandardError - options.gridStep)
        result.warning =
            "At order " + std::to_string(options.order) + " any alpha from " + plainText(low, 2) + " to "
            + plainText(high, 2)
            + " explains the data within two standard errors, so alpha is not determined; a lower order may tell.";
    if (!result.warning.empty())
        result.alphaStandardError = notKnown;
    return result;
}

}  // namespace

FractionalIdentification identifyFractional(const FrequencyData& data, const FractionalOptions& options,
                                            const Progress& progress)
{
    std::string reason;
    if (!options.isValid(&reason))
        throw Error(Error::Kind::usage, "The frequency response cannot be identified: " + reason + ".");
    if (data.inputs != 1)
        throw Error(Error::Kind::data, "Fractional models are identified from responses to one input; these are to "
                                           + std::to_string(data.inputs) + ".");
    auto result = options.alpha ? fixedAlpha(data, options, progress) : freeAlpha(data, options, progress);
    result.sectorMargin = sectorMargin(result.model);
    result.stable = result.sectorMargin > 0.0;
    return result;
}

FractionalSweep sweepFractional(const FrequencyData& data, const std::vector<int>& orders,
                                const FractionalOptions& options, const Progress& progress)
{
    if (orders.empty() || !std::is_sorted(orders.begin(), orders.end(), std::less_equal<> {}))
        throw Error(Error::Kind::usage, "The orders of a sweep must ascend.");
    FractionalSweep sweep;
    const double values = 2.0 * static_cast<double>(data.value.size()), count = static_cast<double>(orders.size());
    for (std::size_t k = 0; k < orders.size(); ++k) {
        auto single = options;
        single.order = orders[k];
        FractionalSweep::Entry entry;
        entry.order = orders[k];
        entry.found = identifyFractional(
            data, single, progress.part(static_cast<double>(k) / count, static_cast<double>(k + 1) / count));
        entry.mdl = (data.deviation.size() != 0 ? 2.0 * entry.found.chiSquared
                                                : values * std::log(std::max(entry.found.cost, 1e-26)))
                    + static_cast<double>(parametersOf(data, orders[k], !options.alpha)) * std::log(values);
        sweep.entries.push_back(std::move(entry));
    }
    for (std::size_t k = 1; k < sweep.entries.size(); ++k)
        if (sweep.entries[k].mdl < sweep.entries[sweep.chosen].mdl)
            sweep.chosen = k;
    const auto& chosen = sweep.entries[sweep.chosen];
    sweep.sentence = "Order " + std::to_string(chosen.order) + " has the lowest description length.";
    if (options.alpha)
        return sweep;
    // V of all entries in the unit of the chosen one
    const bool deviations = data.deviation.size() != 0;
    const double least = deviations ? chosen.found.chiSquared : freedomOf(data, chosen.order);
    const double alpha = chosen.found.model.alpha,
                 away = std::isfinite(chosen.found.alphaStandardError) ? 3.0 * chosen.found.alphaStandardError : 0.0;
    for (const auto& entry : sweep.entries) {
        const double unit = deviations ? 1.0
                                       : entry.found.cost / freedomOf(data, entry.order) * freedomOf(data, chosen.order)
                                             / chosen.found.cost;
        const auto [low, high] = rangeOf(entry.found.curve, least, unit);
        if (&entry == &chosen || low > high || (high <= alpha + away && low >= alpha - away))
            continue;
        sweep.warning = "Order and alpha are ambiguous: order " + std::to_string(entry.order)
                        + " explains the data as well with alpha from " + plainText(low, 2) + " to "
                        + plainText(high, 2) + "; order " + std::to_string(chosen.order) + " says "
                        + plainText(alpha, 2) + ".";
        break;
    }
    return sweep;
}

}  // namespace excursion
