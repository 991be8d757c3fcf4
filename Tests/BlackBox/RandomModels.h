// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/BlackBox/BlackBoxPredistorter.h"
#include "Engine/Linear/Simulation.h"
#include "Engine/Signal/Level.h"

#include <Eigen/Core>

#include <cmath>
#include <numbers>
#include <random>
#include <span>

namespace excursion {

/// What a fit of a loudspeaker might have been made under: pink, 20 Hz to 5 kHz.
inline Stimulus pinkStimulus(double rms)
{
    Stimulus stimulus;
    stimulus.rms = rms;
    stimulus.peak = 4.5 * rms;
    for (int band = -17; band <= 7; ++band)
        stimulus.frequency.push_back(1000.0 * std::exp2(band / 3.0));
    stimulus.power.assign(stimulus.frequency.size(), rms * rms / static_cast<double>(stimulus.frequency.size()));
    return stimulus;
}

inline double variance(const Eigen::VectorXd& v) { return (v.array() - v.mean()).square().mean(); }

/// A resonance behind a coil, with random monomials of degree 2 and 3 in its state equation, scaled until they make
/// `distortionDb` of the output at the level of the stimulus; states in random units.
inline Pnlss randomPnlss(std::uint64_t seed, double sampleRate, const Stimulus& stimulus, double distortionDb = -25.0)
{
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> draw(-1.0, 1.0);
    const double f0 = 70.0 * std::exp2(draw(random)), w0 = 2.0 * std::numbers::pi * f0,
                 quality = std::exp2(0.5 * draw(random)),
                 coil = 2.0 * std::numbers::pi * 1500.0 * std::exp2(draw(random));
    Eigen::MatrixXd A {{0.0, 1.0, 0.0}, {-w0 * w0, -w0 / quality, w0 * w0}, {0.0, 0.0, -coil}};
    // By steps of a 64th of a sample, with the input held: a system like those that fits find, whatever the rule.
    Eigen::MatrixXd Ad = Eigen::MatrixXd::Identity(3, 3), B = Eigen::MatrixXd::Zero(3, 1);
    const Eigen::Vector3d b(0.0, 0.0, coil);
    for (int k = 0; k < 64; ++k) {
        const double h = 1.0 / (64.0 * sampleRate);
        B += h * (A * B + b);
        Ad += h * A * Ad;
    }
    StateSpace linear {Ad, B, Eigen::MatrixXd {{1e-3, 0.0, 0.0}}, Eigen::MatrixXd::Zero(1, 1), sampleRate};
    // Velocity over the resonance's angular frequency, then units of each state's own.
    Eigen::Vector3d scale(std::exp(draw(random)), w0 * std::exp(draw(random)), std::exp(draw(random)));
    auto model = withTerms(transformed(linear, Eigen::MatrixXd(scale.asDiagonal())), 3);
    for (Eigen::Index k = 0; k < model.terms(); ++k)
        for (Eigen::Index i = 0; i < 3; ++i) {
            const double cubes = model.exponents.row(k).sum() == 3 ? 0.3 : 1.0;
            // The force balance takes most, as in a loudspeaker.
            model.E(i, k) = i == 1 ? cubes * draw(random) / stimulus.rms : 0.0;
            if (model.exponents.row(k).tail(2).sum() > 0)
                model.E(i, k) *= 0.1;
        }
    const auto period = playedAs(stimulus, sampleRate, 16384, 99);
    Eigen::VectorXd u(2 * 16384);
    u << Eigen::Map<const Eigen::VectorXd>(period.data(), 16384),
        Eigen::Map<const Eigen::VectorXd>(period.data(), 16384);
    const Eigen::VectorXd straight = simulate(model.linear, u).col(0);
    // Small at first, so that it stays finite; then what it makes there is proportional to the coefficients.
    double factor = 1e-6;
    for (int k = 0; k < 12; ++k) {
        auto trial = model;
        trial.E *= factor;
        const Eigen::VectorXd y = simulate(trial, u).col(0);
        const double made = y.allFinite() ? variance(y - straight) / variance(straight) : 1e6;
        factor *= std::pow(10.0, std::clamp((distortionDb - decibelsOf(made)) / 20.0, -2.0, 2.0));
    }
    model.E *= factor;
    return model;
}

/// One that cannot be inverted: what is odd in the output alone and delayed cannot be made undone where the linear
/// part is silent, and this one passes nothing but a resonance far below the distortion.
inline Pnlss oneWay(double sampleRate, const Stimulus& stimulus)
{
    auto model = randomPnlss(12, sampleRate, stimulus);
    model.E.setZero();
    model.linear.C.setZero();
    model.linear.C(0, 0) = 1e-9;
    for (Eigen::Index k = 0; k < model.terms(); ++k)
        if (model.exponents(k, 3) == 2 && model.exponents.row(k).sum() == 2)
            model.F(0, k) = 1.0;
    return model;
}

inline BlackBox boxOf(const Pnlss& model, const Stimulus& stimulus)
{
    auto box = blackBoxOf(model);
    box.input = "voltage";
    box.output = "displacement";
    box.stimulus = stimulus;
    return box;
}

/// The last `judged` samples: power of what the model adds to its linear part, of the linear part's, in dB.
inline double distortionDb(const Eigen::VectorXd& played, const Eigen::VectorXd& straight, Eigen::Index judged)
{
    return decibelsOf(variance(played.tail(judged) - straight.tail(judged)) / variance(straight.tail(judged)));
}

}  // namespace excursion
