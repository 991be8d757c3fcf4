// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "BlackBox/RandomModels.h"

#include "Engine/Polynomial/Block/BlockModelFile.h"
#include "Engine/Polynomial/FractionalPnlss/FractionalPnlssFile.h"
#include "Engine/Polynomial/Hammerstein/ParallelHammersteinFile.h"
#include "Engine/Polynomial/Narx/NarxFile.h"
#include "Engine/Polynomial/Pnlss/PnlssFile.h"

#include <nlohmann/json.hpp>

#include <vector>

namespace excursion {

/// One model of each class without physics, and its document.

inline FractionalGrid oneGrid() { return {48000.0, 1, {1.0, 24000.0, 3.0}}; }

inline FractionalPnlss oneFractionalPnlss()
{
    FractionalPnlss model;
    StateSpace form;
    const double w0 = 2.0 * std::numbers::pi * 60.0, L = 0.02;
    form.A = Eigen::MatrixXd {{0.0, 1.0, 0.0}, {-w0 * w0, -w0 / 2.0, 800.0}, {0.0, -1.0 / L, -4.0 / L}};
    form.B = Eigen::MatrixXd {{0.0}, {0.0}, {1.0 / L}};
    form.C = Eigen::MatrixXd {{0.0, 0.0, 1.0}};
    form.D = Eigen::MatrixXd::Zero(1, 1);
    form.sampleRate = 1.0;
    model.alpha = 0.6;
    model.fractional.resize(3);
    model.fractional << false, false, true;
    model.form = withTerms(form, monomialsNamed("x1^2,x1^3,x1*x2", 3, 1));
    model.form.linear.sampleRate = 0.0;
    // So strong that stiffness and induced voltage change by some tenths
    model.form.E(1, 0) = -0.3 * w0 * w0 / 3e-3;
    model.form.E(1, 1) = -0.3 * w0 * w0 / 9e-6;
    model.form.E(2, 2) = -0.2 / (L * 3e-3);
    return model;
}

inline BlockModel oneBlockModel()
{
    BlockModel block;
    block.linear = randomPnlss(7, 48000.0, pinkStimulus(2.0)).linear;
    block.hammerstein = Eigen::Vector2d(0.02, 0.005);
    block.wiener = Eigen::Vector2d(20.0, 3e3);
    block.feedback = Eigen::Vector2d(5.0, 1e3);
    block.offset = 1e-5;
    return block;
}

inline Narx oneNarx()
{
    Narx narx;
    narx.sampleRate = 48000.0;
    narx.outputLags = 2;
    narx.inputLags = 2;
    narx.exponents = Exponents::Zero(6, 5);
    narx.coefficients.resize(6);
    const double pole = 0.99, angle = 0.02;
    for (int k = 0; k < 3; ++k)
        narx.exponents(k, k) = 1;
    narx.coefficients << 2.0 * pole * std::cos(angle), -pole * pole, 1e-3, -1e-5, -1e-6, 1e-6;
    narx.exponents(3, 0) = 2;
    narx.exponents(4, 0) = 1;
    narx.exponents(4, 4) = 2;  // y(t-1) u(t)^2; the last one is a constant
    return narx;
}

inline ParallelHammerstein oneHammerstein()
{
    ParallelHammerstein hammerstein;
    hammerstein.sampleRate = 48000.0;
    hammerstein.filters = Eigen::MatrixXd::Zero(256, 3);
    for (int k = 0; k < 256; ++k) {
        hammerstein.filters(k, 0) = std::exp(-k / 25.0) * std::cos(0.1 * k);
        hammerstein.filters(k, 1) = 0.05 * std::exp(-k / 20.0) * std::sin(0.07 * k);
        hammerstein.filters(k, 2) = 0.01 * std::exp(-k / 15.0);
    }
    hammerstein.offset = 0.01;
    return hammerstein;
}

inline nlohmann::ordered_json withStimulus(nlohmann::ordered_json document, const Stimulus& stimulus)
{
    document["stimulus"] = toJson(stimulus);
    return document;
}

inline nlohmann::ordered_json documentOf(const Pnlss& model, const Stimulus& stimulus)
{
    return withStimulus(toJson(NamedPnlss {"pnlss", {"voltage"}, {"displacement"}, model}), stimulus);
}

/// Fitted with 2 V rms.
inline std::vector<nlohmann::ordered_json> everyClass()
{
    const auto stimulus = pinkStimulus(2.0);
    return {
        documentOf(randomPnlss(11, 48000.0, stimulus), stimulus),
        withStimulus(
            toJson(NamedFractionalPnlss {"fractional", {"voltage"}, {"current"}, oneFractionalPnlss(), oneGrid()}),
            stimulus),
        withStimulus(toJson(Named<BlockModel> {"block", "voltage", "displacement", oneBlockModel()}), stimulus),
        withStimulus(toJson(Named<Narx> {"narx", "voltage", "displacement", oneNarx()}), stimulus),
        withStimulus(toJson(Named<ParallelHammerstein> {"powers", "voltage", "pressure", oneHammerstein()}), stimulus)};
}

}  // namespace excursion
