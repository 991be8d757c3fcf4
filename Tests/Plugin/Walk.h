// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Diagnosis/SyntheticLadder.h"
#include "Plugin/Editor.h"
#include "Plugin/Text.h"

#include <cmath>
#include <complex>
#include <functional>
#include <memory>
#include <vector>

namespace excursion::plugin {

/// The component and all below it that are visible.
inline void walk(juce::Component& root, const std::function<void(juce::Component&)>& seen)
{
    seen(root);
    for (auto* child : root.getChildren())
        if (child->isVisible())
            walk(*child, seen);
}

/// All of a kind that are visible.
template <class Kind>
std::vector<Kind*> all(juce::Component& root)
{
    std::vector<Kind*> found;
    walk(root, [&found](juce::Component& one) {
        if (auto* kind = dynamic_cast<Kind*>(&one))
            found.push_back(kind);
    });
    return found;
}

/// What the pages show of a take of three levels and a ladder of so many rungs, as a session could have made it.
inline std::shared_ptr<const Findings> syntheticFindings(std::size_t rungs)
{
    auto findings = std::make_shared<Findings>();
    findings->source = "Virtual midbass, seed 7";
    findings->truth = "Stiffness K(x), Force factor Bl(x)";
    findings->file = test::syntheticLadder();
    auto& ladder = findings->file.ladder;
    ladder.rungs.resize(rungs);
    if (rungs < 4) {
        ladder.verdict = Verdict::missingEffect;
        ladder.sentence =
            "Missing: the stiffness depends on the displacement, K(x) (96 % sure). With it the displacement "
            "error falls by 27.0 dB to -55.3 dB, and the noise stands at -74.2 dB.";
    }
    Measurement take;
    take.sampleRate = 48000.0;
    take.channels.emplace_back().samples.assign(64, 0.0);
    findings->take = std::make_shared<const PreparedTake>(take);
    findings->file.take.sampleRate = 48000.0;
    findings->file.take.seconds = 12.3;
    findings->file.take.realizations = 3;
    for (const auto quantity : {Quantity::voltage, Quantity::current, Quantity::displacement, Quantity::pressure}) {
        ChannelFigures channel;
        channel.quantity = quantity;
        channel.unit = siUnit(quantity);
        channel.rms = 0.3;
        channel.peak = 1.2;
        channel.snrDb = 71.5;
        for (double f = 16.0; f < 16000.0; f *= 2.0)
            channel.bands.push_back({f, 2.0 * f, 70.0 - 3.0 * std::log2(f / 16.0)});
        findings->report.channels.push_back(channel);
    }
    for (std::size_t level = 0; level < 3; ++level) {
        std::vector<Waveform> waves;
        for (const auto& channel : ladder.rungs.back().comparison.channels) {
            Waveform wave {channel.quantity, channel.unit, 48000.0, {}, {}};
            for (int n = 0; n < 9600; ++n) {
                wave.measured.push_back(1e-3 * std::sin(0.011 * n) * std::cos(0.0007 * n));
                wave.model.push_back(0.98 * wave.measured.back());
            }
            waves.push_back(std::move(wave));
        }
        findings->waveforms.push_back(std::move(waves));
    }
    return findings;
}

/// What the page Identify shows of an impedance, and of a polynomial model that began there.
inline Identification identifiedForPictures(ModelTime time)
{
    Spectra spectra;
    Spectra::Channel voltage {Quantity::voltage, "V", {}}, current {Quantity::current, "A", {}};
    for (double f = 10.0; f < 20000.0; f *= 1.02) {
        const std::complex<double> s(0.0, 2.0 * 3.14159265358979 * f);
        spectra.frequency.push_back(f);
        voltage.values.push_back(3.3 + 0.03 * std::pow(s, 0.7) + 1700.0 * s / (s * s + 55.0 * s + 129000.0));
        current.values.emplace_back(1.0);
    }
    spectra.channels = {voltage, current};
    IdentifyWish wish;
    wish.order = 4;
    wish.time = time;
    wish.alpha = 0.7;
    auto pnlss = std::make_shared<FittedPnlss>();
    pnlss->startDb = -24.3;
    pnlss->estimationDb = -71.2;
    pnlss->validationDb = -70.9;
    pnlss->noiseDb = -73.1;
    for (int k = 0; k < 40; ++k)
        pnlss->history.push_back(-24.3 - 47.0 * (1.0 - std::exp(-0.15 * k)));
    pnlss->terms = 120;
    pnlss->stable = true;
    pnlss->words = "PNLSS of 120 terms.";
    return {std::make_shared<const Identified>(identifiedOf(PreparedTake(spectra), wish, "midbass")), pnlss};
}

}  // namespace excursion::plugin
