// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Linear/LargeOrderStarts.h"

#include "Engine/Error.h"
#include "Engine/Linear/Bilinear.h"
#include "Engine/Linear/LeastSection.h"
#include "Engine/Linear/ResidualWhiteness.h"
#include "Engine/Linear/Response.h"
#include "Engine/Linear/Subspace.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace excursion {
namespace {

using Eigen::Index;

constexpr int fewSteps = 4;
constexpr int determinedSteps = 8;   // near a minimum that the data determines Newton's steps are few
constexpr double noticeable = 1.02;  // a cost grown by this factor is worth refining

class LargeOrderSearch {
public:
    LargeOrderSearch(const FrequencyData& data, const IdentifyOptions& options, double floor, const Progress& progress)
        : data_(data),
          options_(options),
          floor_(floor),
          progress_(progress),
          scale_(sectionScaleOf(data, options)),
          larger_(largerOrder())
    {
        pruned_.cost = std::numeric_limits<double>::infinity();
        few_ = options.refinement;
        few_.maximumIterations = std::min(fewSteps, options.refinement.maximumIterations);
    }

    std::vector<PoleStart> run()
    {
        // Subspace and vector fitting by turns: each of them fails where the other does not.
        const auto rates = options_.sampleRate > 0.0 ? std::vector<double> {options_.sampleRate}
                                                     : warpingRates(data_, options_.thorough);
        progress_.at(0.0, "identifying by subspace");
        for (std::size_t k = 0; k < rates.size(); ++k) {
            const bool met = tryRange(rates[k]);
            if (met || (k == 0 && tryVectors(false, true))) {
                if (!determined_)
                    tryVectors(false, false);
                return std::move(starts_);
            }
        }
        if (!tryVectors(true, true) && options_.thorough)
            tryPruned();
        return std::move(starts_);
    }

private:
    Index largerOrder() const
    {
        const Index n = options_.order;
        Index larger = std::min(std::min<Index>(2 * n + 10, std::max<Index>(100, n + 30)), data_.lines() / 8);
        return larger + (larger - n) % 2;
    }

    /// Keeps these poles, refined by a few steps, and to the end where they explain all but noise. @returns whether
    /// they do
    bool add(const char* name, SecondOrderSections sections)
    {
        if (!sections.factors.allFinite())
            return false;
        if (options_.refinement.stable)
            sections = mirrored(sections);
        auto fit = refinePoles(sections, data_, few_).fit;
        if (!std::isfinite(fit.cost))
            return false;
        const bool met = explainsAllButNoise(fit, data_, floor_);
        if (met) {
            auto refined = refinePoles(fit.sections, data_, options_.refinement);
            determined_ = refined.converged() && refined.iterations <= determinedSteps;
            fit = std::move(refined.fit);
        }
        starts_.push_back({name, std::move(fit)});
        return met;
    }

    /// The range of the observability matrix, on the circle or, of fractional order, on the arc that the transform
    /// makes of the lines.
    ObservabilityRange rangeAt(double rate) const
    {
        const Index rows = std::max(blockRowsFor(options_.order, data_.lines()),
                                    std::min(blockRowsFor(larger_, data_.lines()), larger_ + larger_ / 3));
        if (options_.sampleRate > 0.0)
            return observabilityRange(data_, rate, rows);
        if (options_.alpha == 1.0) {
            auto warped = data_;
            for (auto& f : warped.frequency)
                f = warpedFrequency(f, rate);
            return observabilityRange(warped, rate, rows);
        }
        const double a = std::pow(2.0 * rate, options_.alpha);
        const Eigen::VectorXcd lambda = evaluationPoints(data_.frequency, 0.0, options_.alpha);
        auto range = observabilityRange(data_, (a + lambda.array()) / (a - lambda.array()), rows);
        range.sampleRate = 0.5 * a;
        return range;
    }

    SecondOrderSections polesOf(const ObservabilityRange& range, Index order) const
    {
        auto model = dynamicsOf(range, order, 1, false);
        if (options_.sampleRate == 0.0)
            model = toContinuous(model);
        return sectionsOf(poles(model), options_.sampleRate, scale_, options_.alpha);
    }

    bool tryRange(double rate)
    {
        try {
            const auto range = rangeAt(rate);
            if (add("subspace", polesOf(range, options_.order)))
                return true;
            if (options_.thorough && larger_ >= options_.order + 2 && larger_ < range.U.cols())
                keepLarger(polesOf(range, larger_));
        } catch (const Error& e) {  // a transform that does not exist
            if (e.kind() != Error::Kind::numerical)
                throw;
        }
        return false;
    }

    void keepLarger(const SecondOrderSections& sections)
    {
        if (!sections.factors.allFinite())
            return;
        auto fit = fitPartialFractions(sections, data_);
        if (fit.cost < pruned_.cost)
            pruned_ = std::move(fit);
    }

    /// Relocates poles until their error settles. @param untilNoise  or until it is no more than noise
    bool tryVectors(bool logarithmic, bool untilNoise)
    {
        progress_.at(0.4, "fitting vectors");
        constexpr int most = 60, patience = 8;
        constexpr double progressing = 1.002;
        auto sections = spreadPoles(options_.order, data_, options_.sampleRate, scale_, logarithmic, options_.alpha);
        PartialFractionFit best;
        best.cost = std::numeric_limits<double>::infinity();
        double settled = best.cost;
        for (int k = 0, since = 0; k < most && since < patience; ++k, ++since) {
            sections = relocatePoles(sections, data_);
            if (!sections.factors.allFinite())
                break;
            auto fit = fitPartialFractions(sections, data_);
            if (!(fit.cost < best.cost))
                continue;
            best = std::move(fit);
            if (untilNoise && explainsAllButNoise(best, data_, floor_))
                break;
            if (progressing * best.cost < settled) {
                settled = best.cost;
                since = 0;
            }
        }
        return std::isfinite(best.cost) && add("vector fitting", best.sections);
    }

    void tryPruned()
    {
        progress_.at(0.7, "pruning a larger model");
        if (!std::isfinite(pruned_.cost))
            return;
        double settled = pruned_.cost;
        while (pruned_.sections.order() >= options_.order + 2) {
            pruned_ = fitPartialFractions(withoutLeast(pruned_, data_, false), data_);
            if (pruned_.cost > noticeable * settled && isStable(pruned_.sections)) {
                pruned_ = refinePoles(pruned_.sections, data_, few_).fit;
                settled = pruned_.cost;
            }
        }
        add("pruned", pruned_.sections);
    }

    const FrequencyData& data_;
    const IdentifyOptions& options_;
    double floor_;
    const Progress& progress_;
    double scale_;
    Index larger_;
    PoleRefinementOptions few_;
    std::vector<PoleStart> starts_;
    PartialFractionFit pruned_;
    bool determined_ = false;  // the poles that met the noise were the only ones nearby
};

}  // namespace

double sectionScaleOf(const FrequencyData& data, const IdentifyOptions& options)
{
    return options.sampleRate > 0.0 ? 1.0 : std::pow(2.0 * std::numbers::pi * data.frequency.back(), options.alpha);
}

std::vector<double> warpingRates(const FrequencyData& data, bool thorough)
{
    const double high = data.frequency.back();
    const double middle = std::sqrt(std::max(data.frequency.front(), 1e-4 * high) * high);
    std::vector<double> rates {std::numbers::pi * 0.18 * high, std::numbers::pi * 0.5 * high};
    if (thorough)
        rates.insert(rates.end(), {std::numbers::pi * 0.1 * high, std::numbers::pi * 0.3 * high});
    if (middle < 0.1 * high)
        rates.push_back(std::numbers::pi * 0.5 * middle);
    return rates;
}

bool explainsAllButNoise(const PartialFractionFit& fit, const FrequencyData& data, double floor)
{
    return fit.cost < floor || leavesWhiteNoise(fit, data);
}

std::vector<PoleStart> startsOfLargeOrder(const FrequencyData& data, const IdentifyOptions& options, double floor,
                                          const Progress& progress)
{
    return LargeOrderSearch(data, options, floor, progress).run();
}

}  // namespace excursion
