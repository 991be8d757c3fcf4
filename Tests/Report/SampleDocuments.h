// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Fractional/FractionalStateSpaceFile.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <complex>
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
    nlohmann::json entry {
        {"order", 2}, {"errorDb", -20.0}, {"weightedErrorDb", -22.0}, {"validationDb", nullptr}, {"stable", true}};
    nlohmann::json sweep {{"format", "excursion-identification"},
                          {"version", 1},
                          {"sentence", "order 2 <it> is"},
                          {"chosen", 2},
                          {"model", linear}};
    sweep["orders"] = {entry, entry};
    auto fractionalSweep = sweep;
    fractionalSweep["format"] = "excursion-fractional-identification";
    fractionalSweep["model"] = fractional;
    fractionalSweep["orders"][0]["curve"] = {{0.4, 30.0}, {0.5, 10.0}, {0.6, 20.0}};
    const nlohmann::json fit {{"format", "excursion-pnlss-fit"},
                              {"version", 1},
                              {"estimationDb", -40.0},
                              {"validationDb", nullptr},
                              {"stable", true},
                              {"stopped", "the error no longer falls"},
                              {"history", {-20.0, -35.0, -40.0}},
                              {"model", {{"format", "excursion-pnlss"}, {"linear", linear}}}};
    const nlohmann::json good {{"class", "linear"},     {"description", "order 3"},
                               {"parameters", 7},       {"estimationDb", -30.0},
                               {"validationDb", -29.0}, {"load", 0.001},
                               {"stable", true},        {"linearization", {{"trouble", "nothing <to> correct"}}}};
    auto bent = good;
    bent["class"] = "pnlss";
    bent["linearization"] = {
        {"beforeDb", -25.0}, {"modelDb", -66.0}, {"leftDb", -47.5}, {"load", 0.011}, {"latency", 0.0017}};
    const nlohmann::json ranking {{"format", "excursion-ranking"},
                                  {"version", 1},
                                  {"sentence", "s"},
                                  {"input", "voltage"},
                                  {"output", "current"},
                                  {"noiseDb", -70.0},
                                  {"linearizesBest", "pnlss"},
                                  {"linearizationSentence", "pnlss & co"},
                                  {"models", {good, bent, {{"class", "narx"}, {"trouble", "ran & away"}}}}};
    const nlohmann::json halves {{"format", "excursion-motor-cone"},
                                 {"version", 1},
                                 {"sentence", "told <it> all"},
                                 {"motorErrorDb", -50.0},
                                 {"coneErrorDb", -40.0},
                                 {"errorDb", -39.0},
                                 {"stable", true},
                                 {"motor", linear},
                                 {"cone", linear}};
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
