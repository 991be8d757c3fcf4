// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Linearization/Chain.h"
#include "Plugin/Juce.h"

#include <atomic>
#include <vector>

namespace excursion::plugin {

/// The parameters that a host sees and automates: those of a Recipe, and a switch for every effect of the catalogue.
///     mode, fullScale (V), amount (%), displacementLimit (% of what the model was measured at), voltageLimit (V), trim (dB),
///     effect-<id>
/// Reading them (recipe(), controls()) is safe on any thread; controls() is for the audio thread.
class Parameters : private juce::AudioProcessorParameter::Listener {
public:
    /// Adds them to the processor, which owns them from then on and must outlive this.
    explicit Parameters(juce::AudioProcessor&);
    ~Parameters() override;

    Recipe recipe() const;
    void set(const Recipe&);   ///< tells the host; not for the audio thread

    ChainControls controls(double measuredDisplacement) const;

    /// Whether a switch of an effect was moved since the last call.
    bool takeSwitched() { return switched_.exchange(false, std::memory_order_acq_rel); }

    juce::AudioParameterChoice& mode() { return *mode_; }
    std::vector<juce::AudioParameterFloat*> numbers() const { return {fullScale_, amount_, displacementLimit_, voltageLimit_, trim_}; }
    const std::vector<juce::AudioParameterBool*>& effects() const { return effects_; }

private:
    // May be called on the audio thread: sets a flag and leaves.
    void parameterValueChanged(int, float) override { switched_.store(true, std::memory_order_release); }
    void parameterGestureChanged(int, bool) override {}

    juce::AudioParameterChoice* mode_;
    juce::AudioParameterFloat *fullScale_, *amount_, *displacementLimit_, *voltageLimit_, *trim_;
    std::vector<juce::AudioParameterBool*> effects_;   ///< in the order of the catalogue
    std::atomic<bool> switched_ {false};
};

} // namespace excursion::plugin
