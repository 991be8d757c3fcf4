// SPDX-License-Identifier: GPL-3.0-or-later
// Ladders of a batch as improve() would leave them, without a take.
#pragma once

#include "Engine/Batch/Units.h"
#include "Engine/Loudspeaker/Catalogue.h"

#include <cmath>
#include <string>
#include <vector>

namespace excursion::test {

/// A midbass whose K, m and Bl are so many times those of the first one, with those effects.
inline Model midbassOf(double K, double m = 1.0, double Bl = 1.0,
                       const std::vector<std::string>& effects = {"stiffness"})
{
    auto model = makeModel("electrodynamic");
    model.name = "midbass";
    model.baseParameter("K").value = 1800.0 * K;
    model.baseParameter("m").value = 0.0143 * m;
    model.baseParameter("Bl").value = 5.0 * Bl;
    model.path.parameters[0].value = 0.0132;
    for (const auto& id : effects) {
        const OperatingRange operatingRange {.displacement = 3.03e-3,
                                             .velocity = 0.5,
                                             .current = 2.0,
                                             .lowFrequency = 20.0,
                                             .highFrequency = 5000.0,
                                             .degree = 2};
        model = withEffect(std::move(model), effectNamed(id), operatingRange);
        model.components.back().parameters[1].value = id == "stiffness" ? 300.0 * K : -0.3;
    }
    const auto theta = parameterVector(model);
    model.covariance = Eigen::MatrixXd::Zero(theta.size(), theta.size());
    for (Eigen::Index k = 0; k < theta.size(); ++k)
        model.covariance(k, k) = std::pow(1e-5 * theta[k], 2);
    return model;
}

inline Unit unitOf(const std::string& name, Model model, Verdict verdict = Verdict::complete, double error = -60.0)
{
    Unit unit;
    unit.name = name;
    unit.file.take.driver = "midbass";
    unit.file.take.path = "somewhere/" + name;
    auto& ladder = unit.file.ladder;
    ladder.verdict = verdict;
    ladder.sentence = verdict == Verdict::complete ? "The model is complete." : "Something is left.";
    if (verdict == Verdict::badMeasurement)
        return unit;
    Rung rung;
    rung.model = std::move(model);
    rung.comparison.levels = {1.0};
    rung.comparison.noiseKnown = true;
    rung.comparison.chiSquaredPerValue = 1.1;
    ChannelComparison channel;
    channel.quantity = Quantity::current;
    channel.total.db = error;
    channel.total.noiseFloorDb = error - 0.5;
    channel.total.chiSquaredPerValue = 1.1;
    rung.comparison.channels.push_back(channel);
    rung.diagnosis.verdict = verdict;
    ladder.rungs.push_back(std::move(rung));
    return unit;
}

}  // namespace excursion::test
