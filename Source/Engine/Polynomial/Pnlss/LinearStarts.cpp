// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Polynomial/Pnlss/LinearStarts.h"

#include "Engine/Error.h"
#include "Engine/Linear/Identify.h"
#include "Engine/Linear/LocalRational.h"
#include "Engine/Linear/SteiglitzMcBride.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

namespace excursion {
namespace {

using Eigen::VectorXd;

constexpr double alikeDb = 0.01;

Pnlss linearOnly(const StateSpace& linear) { return withTerms(linear, Exponents(0, linear.order() + linear.inputs())); }

std::span<const double> samplesOf(const Eigen::MatrixXd& column)
{
    return {column.data(), static_cast<std::size_t>(column.rows())};
}

LinearStart refinedOn(const StateSpace& linear, const InputOutputRecord& record)
{
    PnlssFitOptions options;
    options.search = PnlssSearch::plain;
    options.maximumIterations = 20;
    options.costTolerance = 1e-5;
    options.estimateInitialStates = true;
    const auto fit = fitPnlss(linearOnly(linear), {record}, {}, options);
    if (!std::isfinite(fit.estimationDb))
        return {linear, VectorXd::Zero(linear.order()), fit.estimationDb};
    return {fit.model.linear, fit.initialStates.front(), fit.estimationDb};
}

}  // namespace

std::vector<LinearStart> linearStarts(const InputOutputRecord& record, double sampleRate, int order)
{
    requireFitting({record}, {}, 1, 1);
    IdentifyOptions identifying;
    identifying.order = order;
    identifying.sampleRate = sampleRate;
    std::vector<LinearStart> starts, raw;
    std::optional<Error> trouble;
    const auto consider = [&](const auto& find) {
        try {
            const StateSpace linear = find();
            const auto start = refinedOn(linear, record);
            raw.push_back({linear, VectorXd::Zero(order), start.errorDb});
            const bool known = std::any_of(starts.begin(), starts.end(), [&](const LinearStart& other) {
                return std::abs(other.errorDb - start.errorDb) < alikeDb;
            });
            if (std::isfinite(start.errorDb) && !known)
                starts.push_back(start);
        } catch (const Error& error) {
            if (error.kind() == Error::Kind::cancelled)
                throw;
            trouble = error;
        }
    };
    const auto u = samplesOf(record.input), y = samplesOf(record.output);
    consider([&] { return identify(localRationalResponse(u, y, sampleRate), identifying).model; });
    consider([&] { return steiglitzMcBride(u, y, sampleRate, order); });
    std::stable_sort(starts.begin(), starts.end(), [](const auto& a, const auto& b) { return a.errorDb < b.errorDb; });
    starts.insert(starts.end(), raw.begin(), raw.end());
    if (starts.empty())
        throw *trouble;
    return starts;
}

VectorXd initialStateOf(const Pnlss& model, const InputOutputRecord& record)
{
    auto kept = model;
    kept.free.setConstant(false);
    PnlssFitOptions options;
    options.search = PnlssSearch::plain;
    options.maximumIterations = 20;
    options.linearFree = false;
    options.estimateInitialStates = true;
    const auto fit = fitPnlss(kept, {record}, {}, options);
    return std::isfinite(fit.estimationDb) ? fit.initialStates.front() : VectorXd::Zero(model.linear.order());
}

}  // namespace excursion
