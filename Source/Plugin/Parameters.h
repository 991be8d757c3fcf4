// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Predistortion/Chain.h"
#include "Plugin/Number.h"
#include "Plugin/State.h"

#include <array>
#include <atomic>
#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

namespace excursion::plugin {

/// @param measuredDisplacement  m, of which the limit of the excursion is a share; infinite: no limit
ChainControls chainControls(const Settings&, double measuredDisplacement);

/// The parameters that a host sees and automates: those of a Recipe, and a switch for every effect of the catalogue.
///     mode, fullScale (V), amount (%), displacementLimit (% of what the model was measured at), voltageLimit (V),
///     trim (dB), effect-<id>, powerLimit (W), margin (%), effect-<id> of later effects, target, targetF0 (Hz),
///     targetQ, targetVolume (l), effect-<id> of still later ones, coilResistance (ohm), targetLow, targetHigh (Hz),
///     coupling (Hz), couplingOrder of the amplifier
/// and, which no host sees, the curve of a target.
/// No listener hangs at them, as those are called on the audio thread: who wants to know reads them, now and then.
class Parameters {
public:
    /// Adds them to the processor, which owns them from then on and must outlive this.
    explicit Parameters(juce::AudioProcessor&);

    Recipe recipe() const;  ///< title and words are of the one that was set last; not for the audio thread
    /// A valid one, whole before anybody is called; tells the host; not for the audio thread.
    void set(const Recipe&, const Between& = {});
    /// The same for a person: each parameter that changes is told as a gesture, which a host records, and no other.
    void choose(const Recipe&, const Between& = {});
    void setCurve(const ThirdOctaves&);  ///< of a target, and nothing else; not for the audio thread

    /// Of the parameters with steps those that a host has put between two: id and number. Kept with a state, see
    /// Stepped.
    Between between() const;

    /// For the audio thread as well.
    Settings settings() const;
    /// The same, unless a recipe is being set, of which it would see a part: then they stay as they are, and it
    /// returns false. Wait-free.
    bool read(Settings&) const;
    bool areBeingSet() const { return beginsAndEnds_.load(std::memory_order_acquire) % 2 != 0; }
    ChainControls controls(double measuredDisplacement) const;
    std::uint64_t switches() const;  ///< a bit for every effect that is on

    Choice& mode() { return *mode_; }
    std::vector<Number*> numbers() const
    {
        return {fullScale_,      amount_, displacementLimit_, voltageLimit_, powerLimit_,
                coilResistance_, margin_, coupling_,          trim_};
    }
    Choice& couplingOrder() { return *couplingOrder_; }
    Choice& target() { return *target_; }
    std::vector<Number*> targetNumbers() const { return {targetF0_, targetQ_, targetVolume_, targetLow_, targetHigh_}; }
    const std::vector<OnOff*>& effects() const { return effects_; }

private:
    class Setting;
    void store(const Recipe&, const Between&);
    template <class Visit>
    void visit(const Visit&) const;
    void storeCurve(const ThirdOctaves&);

    Choice *mode_, *target_, *couplingOrder_;
    Number *fullScale_, *amount_, *displacementLimit_, *voltageLimit_, *trim_, *powerLimit_, *margin_, *coilResistance_,
        *coupling_;
    Number *targetF0_, *targetQ_, *targetVolume_, *targetLow_, *targetHigh_;
    std::vector<OnOff*> effects_;  ///< in the order of the catalogue
    std::array<std::atomic<double>, std::tuple_size_v<ThirdOctaves>> curve_ {};
    std::atomic<unsigned> beginsAndEnds_ {0};  ///< of recipes that were set; odd while one is
    /// of what follows, and of a recipe as a whole; nothing is called while it is held, and no other is locked
    mutable std::mutex mutex_;
    std::string title_, words_;
};

}  // namespace excursion::plugin
