// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Predistortion/Chain.h"
#include "Engine/Predistortion/Crossfade.h"
#include "Engine/Predistortion/Peak.h"
#include "Plugin/Delay.h"
#include "Plugin/Juce.h"
#include "Plugin/Parameters.h"
#include "Plugin/Rehearsing.h"
#include "Plugin/Session.h"
#include "Plugin/State.h"

#include <array>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace excursion::plugin {

/// The plugin without its window. One Chain a channel plays; a thread of its own builds new chains when the model or
/// the switches of the effects or the amplifier change, and frees the old ones. The audio thread sees parameters
/// (atomics) and the hand-over, nothing else. A driver and a model without physics are loaded, played and handed over
/// in the same way; their latencies differ, and the host is told on the message thread, as JUCE keeps the latency in a
/// plain int and calls the host from whoever sets it. At a rate at which no chain can run the signal goes through as it
/// is, as late as ever.
class Processor : public juce::AudioProcessor, private juce::AsyncUpdater {
public:
    static constexpr int oversampling = 2;
    static constexpr double fadeTime = 0.05;  ///< s, from model to model
    /// s, in which a new model runs unheard after its delay lines are full: a driver forgets in that
    static constexpr double warmTime = 0.05;

    Processor();
    ~Processor() override;

    Parameters& parameters() { return parameters_; }

    /// The work on a take; it goes on while no window is open.
    Session& session() { return session_; }

    /// Any thread but the audio thread. Throws Error for a model that cannot be run; then the one before stays.
    void setModel(const AnyModel&);
    /// On the message thread, where a person has changed what no parameter shows: a host asks whether to save it.
    void tellHostOfState() { updateHostDisplay(ChangeDetails {}.withNonParameterStateChanged(true)); }
    AnyModel anyModel() const;
    Model model() const;           ///< the driver that was loaded last, while a model without physics plays as well
    LoadedBoxPointer box() const;  ///< the model without physics that plays; null while a driver does

    /// Makes a model without physics ready on another thread, and then plays it. What it is worth is told by the
    /// status, in dB, before anything is bent with it.
    Rehearsing& rehearsing() { return rehearsing_; }
    /// counts the models, from 1
    std::uint64_t modelVersion() const { return modelVersion_.load(std::memory_order_acquire); }

    /// Why the signal goes through as it is, in a sentence; empty while the engine runs.
    std::string standstill() const;
    /// Why the state that a host has given last is not used, in a sentence. Until something is changed, or another
    /// state given, it is what the host gets back. Empty: it is used.
    std::string refusal() const;

    /// Since the last call, over all channels; see Predistorter::Meters.
    struct Meters {
        double displacement = 0.0;  ///< m, of the predistorter's plan or of the modelled speaker
        double voltage = 0.0, power = 0.0;
        double displacementReduction = 0.0, voltageReduction = 0.0, powerReduction = 0.0;  ///< dB
        double region = 0.0;  ///< of a model without physics: 1 is as far out as its fit has been
        int faults = 0;       ///< of the chains that play now
    };
    Meters collectMeters();

    void prepareToPlay(double sampleRate, int longestBlock) override;
    void releaseResources() override {}
    void reset() override;
    bool isBusesLayoutSupported(const BusesLayout&) const override;
    bool supportsDoublePrecisionProcessing() const override { return true; }
    void processBlock(juce::AudioBuffer<float>& buffer, juce::MidiBuffer&) override { play(buffer, false); }
    void processBlock(juce::AudioBuffer<double>& buffer, juce::MidiBuffer&) override { play(buffer, false); }
    void processBlockBypassed(juce::AudioBuffer<float>& buffer, juce::MidiBuffer&) override { play(buffer, true); }
    void processBlockBypassed(juce::AudioBuffer<double>& buffer, juce::MidiBuffer&) override { play(buffer, true); }

    juce::AudioProcessorEditor* createEditor() override;
    bool hasEditor() const override { return true; }
    const juce::String getName() const override { return "Excursion"; }
    bool acceptsMidi() const override { return false; }
    bool producesMidi() const override { return false; }
    double getTailLengthSeconds() const override { return 0.5; }
    int getNumPrograms() override { return 1; }
    int getCurrentProgram() override { return 0; }
    void setCurrentProgram(int) override {}
    const juce::String getProgramName(int) override { return {}; }
    void changeProgramName(int, const juce::String&) override {}
    void getStateInformation(juce::MemoryBlock&) override;
    void setStateInformation(const void*, int) override;

private:
    struct ModelChain : Chain {
        template <class... Arguments>
        explicit ModelChain(double measured, Arguments&&... arguments)
            : Chain(std::forward<Arguments>(arguments)...), measuredDisplacement(measured)
        {
        }
        double measuredDisplacement;  ///< m, of which the limit of the excursion is a share
    };
    using Chains = std::vector<std::unique_ptr<ModelChain>>;

    template <class Sample>
    void play(juce::AudioBuffer<Sample>&, bool bypassed);
    void put(const AnyModel&, const std::stop_token& = {});
    void requirePlayable(const AnyModel&, const Recipe&) const;
    int build(const AnyModel&);
    Chains chains(const AnyModel&, std::size_t channels);
    void playAlone(Chains);
    std::pair<std::uint64_t, AmplifierCoupling> toBuild() const;
    void followSwitches();
    int start();
    void setLatency();
    void tellLatency();
    void handleAsyncUpdate() override;
    void work(const std::stop_token&);
    RealTimeOptions options() const;
    std::string stateBytes() const;

    Parameters parameters_;
    /// of what follows; locked on the audio thread in a render alone, where the host's lock of that thread is held:
    /// whoever holds this one waits for that one only while no chain runs
    mutable std::mutex mutex_;
    Model model_;
    LoadedBoxPointer box_;  ///< null: the driver plays
    std::atomic<std::uint64_t> modelVersion_ {1};
    double sampleRate_ = 0.0;           ///< 0: not prepared
    std::atomic<int> latency_ {0};      ///< samples; what the host has been told, or is about to be
    std::atomic<int> setLatency_ {-1};  ///< the last that was set
    /// what chains were built with: the switches of the effects, and the amplifier
    std::pair<std::uint64_t, AmplifierCoupling> built_ {};
    std::string standstill_;
    /// A state that could not be used, as it was given, and that of the plugin at that time.
    struct Refused {
        std::string bytes, reason, instead;
    } refused_;
    std::vector<std::unique_ptr<Crossfade<ModelChain>>> channels_;  ///< these two are changed only while no audio runs
    /// in place of the channels, where no chain can run
    std::vector<Delay> delays_;
    /// Something was played since the preparation or the last reset. If not, the next block plays the newest model
    /// and settings at once, without a fade.
    std::atomic<bool> heard_ {false};
    Settings settings_;     ///< as the audio thread has read them last
    bool offline_ = false;  ///< of the last block
    std::array<double, 256> block_ {};
    Peak displacement_, region_, voltage_, power_, displacementReduction_, voltageReduction_, powerReduction_;
    std::atomic<int> faults_ {0};
    std::atomic<bool> tellsState_ {false};  ///< the host is still to be told of it, on the message thread
    std::condition_variable_any wake_;
    std::jthread worker_;
    Session session_;
    Rehearsing rehearsing_;
};

}  // namespace excursion::plugin
