// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Take/ExcitationPlan.h"

#include "Engine/Error.h"
#include "Engine/Validity.h"

#include <algorithm>
#include <cmath>

namespace excursion {

bool ExcitationPlanOptions::isValid(std::string* reason) const
{
    if (!multisine.isValid(reason))
        return false;
    if (levels.empty() || levels.size() > 1000)
        return refuse(reason, "An excitation needs 1 to 1000 levels.");
    for (std::size_t i = 0; i < levels.size(); ++i)
        if (!(std::isfinite(levels[i]) && levels[i] > 0 && (i == 0 || levels[i] > levels[i - 1])))
            return refuse(reason, "The levels of an excitation must be positive numbers of V rms that ascend.");
    if (settlePeriods < 0 || periods < 1 || realizations < 1 || settlePeriods > 1000 || periods > 10000
        || realizations > 10000)
        return refuse(reason,
                      "An excitation has 0 to 1000 settling periods, 1 to 10000 periods and 1 to 10000 realizations.");
    const double samples = static_cast<double>(multisine.period) * (settlePeriods + periods) * realizations
                           * static_cast<double>(levels.size());
    if (samples > 500e6)
        return refuse(
            reason, "An excitation must not be longer than 500 million samples; take a shorter period, fewer periods, "
                    "realizations or levels.");
    return true;
}

Measurement planExcitation(const ExcitationPlanOptions& options)
{
    std::string reason;
    if (!options.isValid(&reason))
        throw Error(Error::Kind::usage, reason);

    Excitation excitation;
    excitation.period = options.multisine.period;
    excitation.settlePeriods = options.settlePeriods;
    excitation.periods = options.periods;
    excitation.realizations = options.realizations;
    excitation.levels = options.levels;
    excitation.grid = name(options.multisine.grid);
    excitation.shape = name(options.multisine.shape);
    excitation.bandLow = options.multisine.bandLow;
    excitation.bandHigh = options.multisine.bandHigh;
    excitation.lines = chooseLines(options.multisine);

    auto unit = options.multisine;
    unit.rms = 1.0;
    std::vector<std::vector<double>> realizations;
    for (int m = 0; m < options.realizations; ++m)
        realizations.push_back(multisine(unit, excitation.lines, m));

    Channel voltage;
    voltage.samples.reserve(static_cast<std::size_t>(excitation.totalSamples()));
    for (const double level : options.levels)
        for (const auto& period : realizations)
            for (int p = 0; p < excitation.periodsPerRealization(); ++p)
                for (const double u : period)
                    voltage.samples.push_back(level * u);
    voltage.fullScale = roundFullScale(voltage.samples);

    Measurement plan;
    plan.sampleRate = options.multisine.sampleRate;
    plan.channels.push_back(std::move(voltage));
    plan.excitation = std::move(excitation);
    return plan;
}

double roundFullScale(const std::vector<double>& samples, double margin)
{
    double peak = 0.0;
    for (const double x : samples)
        peak = std::max(peak, std::abs(x));
    if (!(peak > 0) || !std::isfinite(peak))
        return 1.0;
    return std::exp2(std::ceil(std::log2(peak * margin)));
}

}  // namespace excursion
