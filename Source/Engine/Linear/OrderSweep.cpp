// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Linear/OrderSweep.h"

#include "Engine/Error.h"
#include "Engine/Linear/LeastSection.h"
#include "Engine/Validity.h"

#include <algorithm>
#include <cmath>

namespace excursion {
namespace {

double mdlOf(const LinearIdentification& found, const FrequencyData& data)
{
    const double values = 2.0 * static_cast<double>(data.value.size());
    const auto n = found.model.order(), m = data.inputs, p = data.outputs;
    const double price = static_cast<double>(n * (m + p) + m * p) * std::log(values);
    if (data.deviation.size() != 0)
        return 2.0 * found.chiSquared + price;
    return values * std::log(std::max(found.cost, 1e-26)) + price;  // below that there is rounding only
}

std::string inDecibels(double db)
{
    const auto tenths = static_cast<long>(std::lround(10.0 * db));
    return (tenths < 0 ? "-" : "") + std::to_string(std::labs(tenths) / 10) + "."
           + std::to_string(std::labs(tenths) % 10) + " dB";
}

void choose(OrderSweep& sweep, bool validated, bool deviations)
{
    const auto& entries = sweep.entries;
    const auto text = [&entries](std::size_t k) { return std::to_string(entries[k].order); };
    std::size_t best = 0;
    if (validated) {
        for (std::size_t k = 1; k < entries.size(); ++k)
            if (*entries[k].validationDb < *entries[best].validationDb)
                best = k;
        sweep.chosen = best;
        for (std::size_t k = best; k-- > 0;)
            if (*entries[k].validationDb <= *entries[best].validationDb + 0.5)
                sweep.chosen = k;
        sweep.sentence = "Order " + text(sweep.chosen)
                         + " is the smallest within 0.5 dB of the lowest validation error ("
                         + inDecibels(*entries[best].validationDb) + " at order " + text(best) + ").";
        return;
    }
    for (std::size_t k = 1; k < entries.size(); ++k)
        if (entries[k].mdl < entries[best].mdl)
            best = k;
    sweep.chosen = best;
    sweep.sentence =
        "Order " + text(best)
        + " has the lowest description length: higher orders lower the error by less than their parameters cost";
    if (deviations)
        sweep.sentence += ", lower ones leave more than the noise";
    sweep.sentence += entries.size() > 1 && best + 1 == entries.size()
                          ? "; it is the largest that was tried, so a larger one may be better."
                          : ".";
}

}  // namespace

bool OrderSweepOptions::isValid(std::string* reason) const
{
    if (orders.empty() || !std::is_sorted(orders.begin(), orders.end(), std::less_equal<> {}) || orders.front() < 0)
        return refuse(reason, "the orders of a sweep must ascend from 0 or above");
    return identify.isValid(reason);
}

std::vector<int> ordersWithin(const std::vector<int>& orders, const FrequencyData& data)
{
    std::vector<int> within;
    for (const int order : orders) {
        const auto parameters = order * (data.inputs + data.outputs) + data.inputs * data.outputs;
        if (within.empty() || parameters <= data.value.size())
            within.push_back(order);
    }
    return within;
}

OrderSweep sweepOrders(const FrequencyData& data, const OrderSweepOptions& options, const FrequencyData* validation,
                       const Progress& progress)
{
    std::string reason;
    if (!options.isValid(&reason))
        throw Error(Error::Kind::usage, "The orders cannot be swept: " + reason + ".");
    if (validation
        && (validation->inputs != data.inputs || validation->outputs != data.outputs || !validation->isValid(&reason)))
        throw Error(Error::Kind::data, "The validation response does not fit the one that is identified.");
    OrderSweep sweep;
    const auto count = options.orders.size();
    std::vector<std::optional<PartialFractionFit>> fits(static_cast<std::size_t>(options.orders.back()) + 1);
    for (std::size_t back = count; back-- > 0;) {
        const int order = options.orders[back];
        const double done = static_cast<double>(count - 1 - back) / static_cast<double>(count);
        const auto part = progress.part(done, done + 1.0 / static_cast<double>(count));
        auto identifying = options.identify;
        identifying.order = order;
        OrderSweepEntry entry;
        entry.order = order;
        entry.found = identify(data, identifying, part);
        // Two orders up a pair goes; one up, from an odd order, the lone pole.
        for (const int above : {order + 1, order + 2}) {
            if (!identifying.refine || above > options.orders.back() || !fits[static_cast<std::size_t>(above)]
                || (above == order + 1 && above % 2 == 0))
                continue;
            const auto start = withoutLeast(*fits[static_cast<std::size_t>(above)], data, above == order + 1);
            if (!isStable(start))
                continue;
            const auto refined = refinePoles(start, data, identifying.refinement);
            if (refined.fit.cost < entry.found.cost) {
                entry.found = judged(realize(refined.fit.sections, refined.fit.C, refined.fit.D), data,
                                     identifying.alpha);
                entry.found.cost = refined.fit.cost;
                entry.found.sections = refined.fit.sections;
                entry.found.start = "pruned";
                entry.found.refinement = refined;
            }
        }
        if (entry.found.sections)
            fits[static_cast<std::size_t>(order)] = fitPartialFractions(*entry.found.sections, data);
        entry.mdl = mdlOf(entry.found, data);
        if (validation)
            entry.validationDb = judged(entry.found.model, *validation, identifying.alpha).errorDb;
        sweep.entries.push_back(std::move(entry));
    }
    std::reverse(sweep.entries.begin(), sweep.entries.end());
    choose(sweep, validation != nullptr, data.deviation.size() != 0);
    return sweep;
}

}  // namespace excursion
