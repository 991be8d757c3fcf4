// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Diagnosis/ComparisonFile.h"
#include "Engine/Diagnosis/LadderFile.h"
#include "Engine/Loudspeaker/Catalogue.h"
#include "Engine/Loudspeaker/SmallSignal.h"

#include <cmath>
#include <limits>

namespace excursion::test {

/// The model of rung k: the base and the first k effects of the catalogue, with plausible errors.
inline Model syntheticModel(std::size_t effects)
{
    auto model = makeModel(electrodynamicBase().id());
    model.name = "synthetic";
    OperatingRange operatingRange;
    operatingRange.displacement = 6e-3;
    operatingRange.degree = 4;
    for (std::size_t k = 0; k < effects; ++k)
        model = withEffect(model, *catalogue()[k], operatingRange);
    for (std::size_t k = 1; k < model.components.size(); ++k) {
        auto& component = model.components[k];
        const auto law = component.effect->law();
        const double scale = law ? model.baseParameter(law->base).value : 1.0;
        double share = -0.08;
        for (auto& p : component.parameters)
            if (p.strength && law) {
                p.value = scale * share;
                share *= share < 0 ? -2.2 : -0.15;
            }
    }
    const auto all = parametersOf(model);
    const auto size = static_cast<Eigen::Index>(all.size());
    model.covariance = Eigen::MatrixXd::Zero(size, size);
    for (Eigen::Index k = 0; k < size; ++k) {
        auto& p = *all[static_cast<std::size_t>(k)];
        p.standardError = p.value != 0.0 ? std::abs(p.value) * 0.021 : std::numeric_limits<double>::quiet_NaN();
        model.covariance(k, k) = p.value * p.value * 4.4e-4;
    }
    return model;
}

/// What a compare of rung k could have found: errors that fall by 18 dB a rung, down to a noise at -72 dB.
inline Comparison syntheticComparison(std::size_t rung)
{
    Comparison c;
    c.levels = {0.44, 1.7, 4.4};
    c.noiseKnown = c.validated = true;
    c.chiSquaredPerValue = std::pow(10.0, 3.0 - static_cast<double>(rung));
    const struct {
        Quantity quantity;
        double size;
    } channels[] = {{Quantity::current, 0.4}, {Quantity::displacement, 1.5e-3}, {Quantity::pressure, 1.2}};
    for (const auto& [quantity, size] : channels) {
        ChannelComparison channel;
        channel.quantity = quantity;
        channel.unit = siUnit(quantity);
        for (std::size_t l = 0; l < c.levels.size(); ++l) {
            const double gain = c.levels[l] / 4.4;
            const double relative = std::pow(10.0, -1.4 - 0.9 * static_cast<double>(rung)) * gain * gain;
            const double noise = 2.5e-4 / gain;
            ErrorSpectrum s;
            for (double f = 16.0; f < 8000.0; f *= 1.03) {
                const double resonance = 1.0 / std::hypot(1.0 - f * f / 3025.0, f / 120.0);
                const double shape = quantity == Quantity::pressure  ? resonance * f * f / 3025.0 / (1.0 + f / 3000.0)
                                     : quantity == Quantity::current ? 1.0 / (1.0 + resonance)
                                                                     : resonance;
                const double measured = size * gain * shape * (1.0 + 0.1 * std::sin(f / 37.0)) / std::sqrt(f);
                s.frequency.push_back(f);
                s.measured.push_back(measured);
                s.error.push_back(measured * relative * (0.4 + resonance) + measured * noise);
                s.model.push_back(measured * (1.0 + relative * std::cos(f / 11.0)));
                s.noise.push_back(size * gain * noise / std::sqrt(f));
            }
            ErrorLevel e;
            e.db = 20.0 * std::log10(std::hypot(relative, noise));
            e.noiseFloorDb = 20.0 * std::log10(noise);
            e.chiSquaredPerValue = relative * relative / (noise * noise) + 1.0;
            channel.byLevel.push_back(e);
            channel.kindsByLevel.push_back({e.db - 4.0, e.db - 3.0, e.db - 9.0, e.noiseFloorDb});
            channel.spectrumByLevel.push_back(std::move(s));
        }
        channel.total = channel.byLevel.back();
        c.channels.push_back(std::move(channel));
    }
    const struct {
        const char *residual, *unit, *against, *againstUnit;
        double range, size;
    } curves[] = {{"force", "N", "x", "m", 6e-3, 2.0},    {"force", "N", "v", "m/s", 1.1, 0.4},
                  {"force", "N", "i", "A", 2.0, 0.5},     {"voltage", "V", "x", "m", 6e-3, 0.3},
                  {"voltage", "V", "v", "m/s", 1.1, 0.6}, {"voltage", "V", "i", "A", 2.0, 0.2}};
    for (const auto& k : curves) {
        ResidualCurve r {k.residual, k.unit, k.against, k.againstUnit, {}, {}, {}, k.size > 1.0 ? -20.0 : -40.0};
        for (int n = -20; n <= 20; ++n) {
            const double q = n / 20.0, left = std::pow(0.12, static_cast<double>(rung));
            r.argument.push_back(q * k.range);
            r.mean.push_back(k.size * left * (q * q * q + 0.2 * q * q));
            r.scatter.push_back(k.size * (0.04 + 0.15 * left * std::abs(q)));
        }
        c.residuals.push_back(std::move(r));
    }
    return c;
}

/// A ladder of four rungs as improve() could have made it.
inline LadderFile syntheticLadder()
{
    LadderFile file;
    file.take = {"takes/mid \u00b5 <b>&",
                 "Midbass <script>alert(1)</script>",
                 48000.0,
                 12.3,
                 {"voltage", "current", "displacement", "pressure"},
                 {0.44, 1.7, 4.4},
                 4,
                 3};
    auto& ladder = file.ladder;
    ladder.verdict = Verdict::complete;
    ladder.sentence = "The model is complete: what it leaves is at the noise of the take.";
    ladder.problems = {{"hum", Quantity::pressure, -48.2, "dB", false,
                        "The pressure channel holds hum of 50 Hz, 48 dB below its signal."}};
    ladder.withdrawn = {catalogue().back()->id()};
    for (std::size_t k = 0; k < 4; ++k) {
        Rung rung;
        rung.comparison = syntheticComparison(k);
        rung.model = syntheticModel(k);
        rung.fit.end(Termination::costSettled);
        rung.fit.iterations = 7;
        rung.diagnosis.error = errorByChannel(rung.comparison);
        rung.diagnosis.remainder = remainderOf(rung.comparison);
        rung.diagnosis.verdict = k < 3 ? Verdict::missingEffect : Verdict::complete;
        rung.diagnosis.sentence = k < 3 ? "Missing: " + catalogue()[k]->title() + "." : ladder.sentence;
        if (k > 0) {
            rung.added = catalogue()[k - 1]->id();
            for (const auto& [quantity, error] : rung.diagnosis.error)
                rung.predictedErrorDb[quantity] = error.db + 1.7;
        }
        for (std::size_t j = k; j < catalogue().size(); ++j) {
            RankedEffect ranked;
            ranked.effect = catalogue()[j]->id();
            ranked.confidence = k < 3 ? std::pow(0.08, static_cast<double>(j - k)) * 0.96 : 0.05;
            for (const auto& [quantity, error] : rung.diagnosis.error) {
                ranked.predictedErrorDb[quantity] = error.db - 16.0 / static_cast<double>(1 + j - k);
                if (j < k + 2)
                    ranked.confirmedErrorDb[quantity] = error.db - 17.5 / static_cast<double>(1 + j - k);
            }
            ranked.significant = j == k && k < 3;
            ranked.reason = "The residual bends like a cube at all levels; odd detection lines stand at -23 dB, even "
                            "ones at the noise.";
            rung.diagnosis.ranking.push_back(std::move(ranked));
        }
        if (k == 1) {
            rung.diagnosis.indistinguishable = {catalogue()[2]->id()};
            rung.diagnosis.measureNext = "Measure again with a displacement channel.";
        }
        ladder.rungs.push_back(std::move(rung));
    }
    ResponseTarget impedance;
    impedance.impedance = true;
    for (double f = 16.0; f < 8000.0; f *= 1.03)
        impedance.frequency.push_back(f);
    const auto response = respond(ladder.model(), {Quantity::current}, impedance.frequency);
    for (std::size_t k = 0; k < impedance.frequency.size(); ++k)
        impedance.value.push_back((1.0 + 0.02 * std::sin(0.3 * static_cast<double>(k))) / response[0].value[k]);
    file.responses.push_back(std::move(impedance));
    return file;
}

}  // namespace excursion::test
