// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Fractional/FractionalIdentificationFile.h"
#include "Engine/GreyBox/MotorConeFile.h"
#include "Engine/Linear/IdentificationFile.h"
#include "Engine/Ranking/PolynomialFitFile.h"
#include "Engine/Ranking/RankingFile.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <vector>

namespace excursion::test {

/// w0^2/(s^2 + 2 z w0 s + w0^2), in continuous time, or sampled by its poles.
inline StateSpace resonance(double f0, double z, double sampleRate = 0.0)
{
    const double w0 = 2.0 * std::numbers::pi * f0;
    StateSpace model;
    if (sampleRate == 0.0) {
        model.A = Eigen::MatrixXd {{0.0, 1.0}, {-w0 * w0, -2.0 * z * w0}};
        model.B = Eigen::MatrixXd {{0.0}, {w0 * w0}};
    } else {
        const auto p = std::exp(std::polar(w0, std::acos(-z)) / sampleRate);
        model.A = Eigen::MatrixXd {{0.0, 1.0}, {-std::norm(p), 2.0 * p.real()}};
        model.B = Eigen::MatrixXd {{0.0}, {1.0}};
    }
    model.C = Eigen::MatrixXd {{1.0, 0.0}};
    model.D = Eigen::MatrixXd::Zero(1, 1);
    model.sampleRate = sampleRate;
    return model;
}

/// One of each kind of document that has a page, with text that must be escaped.
struct SampleDocuments {
    nlohmann::json linear, fractional, sweep, fractionalSweep, fit, ranking, halves, harmonics;

    std::vector<nlohmann::json> all() const
    {
        return {linear, fractional, sweep, fractionalSweep, fit, ranking, halves, harmonics};
    }
};

inline SampleDocuments sampleDocuments()
{
    const auto linear = nlohmann::json(
        toJson(NamedStateSpace {"driver", {"voltage"}, {"current"}, resonance(80.0, 0.25), 0.0}));
    const auto fractional = nlohmann::json(
        toJson(NamedFractionalStateSpace {"coil", {"current"}, {"voltage"}, {0.5, resonance(80.0, 0.25)}}));
    const NamedStateSpace driver {"driver", {"voltage"}, {"current"}, resonance(80.0, 0.25), 0.0};
    OrderSweepEntry entry;
    entry.order = 2;
    entry.found.errorDb = -20.0;
    entry.found.cost = 0.0063;
    entry.found.stable = true;
    auto larger = entry;
    larger.order = 3;
    const auto sweep = nlohmann::json(
        toJson(IdentifiedModel {"take", 40, {{larger, entry}, 1, "order 2 <it> is"}, driver}));
    FractionalSweep::Entry bent;
    bent.order = 2;
    bent.found.model.alpha = 0.5;
    bent.found.errorDb = -20.0;
    bent.found.cost = 0.0063;
    bent.found.stable = true;
    bent.found.curve = {{0.4, 30.0}, {0.5, 10.0}, {0.6, 20.0}};
    const auto fractionalSweep = nlohmann::json(
        toJson(IdentifiedFractionalModel {"take",
                                          40,
                                          {{bent}, 0, "order 2 <it> is", ""},
                                          {"coil", {"current"}, {"voltage"}, {0.5, resonance(80.0, 0.25)}}}));
    PolynomialFit polynomial;
    polynomial.take = "take";
    polynomial.estimationDb = -40.0;
    polynomial.stable = true;
    polynomial.stopped = "the error no longer falls";
    polynomial.history = {-20.0, -35.0, -40.0};
    polynomial.laws = {{"stiffness"}, -20.0, -38.0, "as K(x) has it"};
    polynomial.model = {{"format", "excursion-pnlss"}, {"linear", linear}};
    const auto fit = nlohmann::json(toJson(polynomial));
    RankedModel straight;
    straight.name = "linear";
    straight.description = "order 3";
    straight.parameters = 7;
    straight.estimationDb = -30.0;
    straight.validationDb = -29.0;
    straight.load = 0.001;
    straight.stable = true;
    straight.predistortion.trouble = "nothing <to> correct";
    auto curved = straight;
    curved.name = "pnlss";
    curved.predistortion = {-25.0, -66.0, -47.5, 0.011, 0.0017, ""};
    RankedModel lost;
    lost.name = "narx";
    lost.trouble = "ran & away";
    auto runaway = curved;
    runaway.name = "block";
    runaway.estimationDb = std::numeric_limits<double>::infinity();
    runaway.validationDb = std::numeric_limits<double>::quiet_NaN();
    runaway.stable = false;
    runaway.kept = "models/block.json";
    Ranking classes;
    classes.take = "take";
    classes.noiseDb = -70.0;
    classes.models = {straight, curved, runaway, lost};
    classes.sentence = "s";
    classes.straightest = "pnlss";
    classes.straightSentence = "pnlss & co";
    const auto ranking = nlohmann::json(toJson(classes));
    NamedMotorCone both;
    both.source = both.name = "take";
    both.motorErrorDb = -50.0;
    both.coneErrorDb = -40.0;
    both.errorDb = -39.0;
    both.sentence = "told <it> all";
    both.stable = true;
    both.motor = both.cone = both.cascade = driver;
    both.cascade.delay = -1e-3;
    const auto halves = nlohmann::json(toJson(both));
    const nlohmann::json curve {
        {"channel", "pressure"},
        {"unit", "Pa"},
        {"level", 2.0},
        {"frequency", {100.0, 200.0, 400.0}},
        {"fundamental", {1.0, 1.0, 1.0}},
        {"harmonics",
         {{{"order", 2}, {"db", {-40.0, -41.0, nullptr}}, {"floorDb", {-90.0, -90.0, -90.0}}},
          {{"order", 3}, {"db", {nullptr, nullptr, nullptr}}, {"floorDb", {-90.0, -90.0, -90.0}}}}},
        {"thd", {{"db", {-40.0, -41.0, nullptr}}, {"floorDb", {-87.0, -87.0, -87.0}}}}};
    const nlohmann::json harmonics {
        {"format", "excursion-harmonics"}, {"version", 1}, {"remarks", {"<it> may be noise"}}, {"curves", {curve}}};
    return {linear, fractional, sweep, fractionalSweep, fit, ranking, halves, harmonics};
}

}  // namespace excursion::test
