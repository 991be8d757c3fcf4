// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/Processor.h"

#include "Engine/Error.h"
#include "Plugin/Editor.h"

#include <chrono>

namespace excursion::plugin {
namespace {

constexpr auto patience = std::chrono::milliseconds(20);  // how long a moved switch may wait

Model firstModel()
{
    const auto& drivers = factoryDrivers();
    return modelFromText(drivers[drivers.size() / 2].text, "factory driver");
}

/// One chain a channel.
std::vector<std::unique_ptr<Chain>> chains(const Model& model, const RealTimeOptions& options,
                                           const ChainControls& controls, int channels)
{
    std::vector<std::unique_ptr<Chain>> result;
    for (int k = 0; k < channels; ++k)
        result.push_back(std::make_unique<Chain>(model, options, controls));
    return result;
}

/// Without the effects that are switched off; whole where it cannot be run without them.
Model asSwitched(const Model& model, const Recipe& recipe, const RealTimeOptions& options)
{
    auto result = withoutOff(model, recipe);
    try {
        requireRunnable(result, options);
    } catch (const Error&) {
        return model;
    }
    return result;
}

}  // namespace

Processor::Processor()
    : AudioProcessor(BusesProperties()
                         .withInput("Input", juce::AudioChannelSet::stereo(), true)
                         .withOutput("Output", juce::AudioChannelSet::stereo(), true)),
      parameters_(*this),
      model_(firstModel()),
      measuredDisplacement_(measuredDisplacement(model_)),
      worker_([this](const std::stop_token& stop) { work(stop); })
{
    setLatencySamples(Chain(model_, options(), {}).latency());  // the same at every rate
}

Processor::~Processor()
{
    worker_.request_stop();
    worker_.join();
}

/// With the mutex held: at the rate that was prepared, or at one at which any model runs where the engine cannot run at
/// that.
RealTimeOptions Processor::options() const
{
    const RealTimeOptions asked {sampleRate_, oversampling};
    return asked.isValid(nullptr) ? asked : RealTimeOptions {48000.0, oversampling};
}

/// With the mutex held: new chains for the model, and the switches as they are.
void Processor::build(const Model& model)
{
    switches_ = parameters_.switches();
    const auto running = withoutOff(model, parameters_.recipe());
    const double measured = measuredDisplacement(running);
    auto fresh = chains(running, options(), parameters_.controls(measured), static_cast<int>(channels_.size()));
    measuredDisplacement_.store(measured, std::memory_order_relaxed);
    for (std::size_t k = 0; k < fresh.size(); ++k) {
        // Warm: its memory has been touched before the audio thread gets it.
        std::array<double, 256> silence {};
        fresh[k]->process(silence.data(), silence.data(), silence.size());
        fresh[k]->reset();
        channels_[k]->offer(std::move(fresh[k]));
    }
}

void Processor::work(const std::stop_token& stop)
{
    std::unique_lock lock(mutex_);
    while (!stop.stop_requested()) {
        for (const auto& channel : channels_)
            channel->collect();
        if (!channels_.empty() && parameters_.switches() != switches_) {
            try {
                build(model_);
            } catch (const Error&) {
                // Without some effect the model cannot be run: what plays goes on.
            }
        }
        wake_.wait_for(lock, stop, patience, [] { return false; });
    }
}

void Processor::setModel(const Model& model)
{
    const std::lock_guard lock(mutex_);
    requireRunnable(model, options());
    requireRunnable(withoutOff(model, parameters_.recipe()), options());
    build(model);
    model_ = model;
    modelVersion_.fetch_add(1, std::memory_order_release);
}

Model Processor::model() const
{
    const std::lock_guard lock(mutex_);
    return model_;
}

std::string Processor::standstill() const
{
    const std::lock_guard lock(mutex_);
    return standstill_;
}

void Processor::prepareToPlay(double sampleRate, int)
{
    const std::lock_guard lock(mutex_);
    sampleRate_ = sampleRate;
    channels_.clear();
    delays_.clear();
    standstill_.clear();
    const int count = getMainBusNumOutputChannels();
    try {
        if (std::string reason; !RealTimeOptions {sampleRate, oversampling}.isValid(&reason))
            throw Error(Error::Kind::usage, reason + ".");
        switches_ = parameters_.switches();
        const auto running = asSwitched(model_, parameters_.recipe(), options());
        const double measured = measuredDisplacement(running);
        auto first = chains(running, options(), parameters_.controls(measured), count);
        measuredDisplacement_.store(measured, std::memory_order_relaxed);
        for (auto& chain : first) {
            channels_.push_back(
                std::make_unique<Crossfade<Chain>>(static_cast<int>(fadeTime * sampleRate),
                                                   getLatencySamples() + static_cast<int>(warmTime * sampleRate)));
            channels_.back()->start(std::move(chain));
        }
    } catch (const std::exception& error) {
        // No host expects an exception here.
        standstill_ = std::string("The signal goes through as it is: ") + error.what();
        channels_.clear();
        delays_.assign(static_cast<std::size_t>(count), Delay(getLatencySamples()));
    }
}

void Processor::reset()
{
    for (const auto& channel : channels_)
        channel->each([](Chain& chain) { chain.reset(); });
    for (auto& delay : delays_)
        delay.reset();
}

bool Processor::isBusesLayoutSupported(const BusesLayout& layout) const
{
    const auto& out = layout.getMainOutputChannelSet();
    return out == layout.getMainInputChannelSet()
           && (out == juce::AudioChannelSet::mono() || out == juce::AudioChannelSet::stereo());
}

template <class Sample>
void Processor::play(juce::AudioBuffer<Sample>& buffer, bool bypassed)
{
    auto controls = parameters_.controls(measuredDisplacement_.load(std::memory_order_relaxed));
    if (bypassed) {
        controls.mode = Mode::bypass;
        controls.trim = 1.0;
    }
    int faults = 0;
    const std::size_t channels = std::max(channels_.size(), delays_.size());
    for (std::size_t c = 0; c < channels && static_cast<int>(c) < buffer.getNumChannels(); ++c) {
        auto* const channel = channels_.empty() ? nullptr : channels_[c].get();
        if (channel != nullptr)
            channel->each([&controls](Chain& chain) { chain.set(controls); });
        Sample* const samples = buffer.getWritePointer(static_cast<int>(c));
        const auto length = static_cast<std::size_t>(buffer.getNumSamples());
        for (std::size_t n = 0; n < length; n += block_.size()) {
            const std::size_t count = std::min(block_.size(), length - n);
            std::copy(samples + n, samples + n + count, block_.begin());
            if (channel != nullptr)
                channel->process(block_.data(), block_.data(), count);
            else
                delays_[c].process(block_.data(), count);
            for (std::size_t k = 0; k < count; ++k)
                samples[n + k] = static_cast<Sample>(block_[k]);
        }
        if (auto* chain = channel != nullptr ? channel->current() : nullptr) {
            const auto meters = chain->take();
            displacement_.raise(std::max(meters.predistorter.displacement, meters.speaker.displacement));
            voltage_.raise(meters.predistorter.voltage);
            power_.raise(meters.predistorter.power);
            displacementReduction_.raise(meters.predistorter.displacementReduction);
            voltageReduction_.raise(meters.predistorter.voltageReduction);
            powerReduction_.raise(meters.predistorter.powerReduction);
            faults += meters.faults;
        }
    }
    faults_.store(faults, std::memory_order_relaxed);
    for (int c = static_cast<int>(channels); c < buffer.getNumChannels(); ++c)
        buffer.clear(c, 0, buffer.getNumSamples());
}

Processor::Meters Processor::take()
{
    return {displacement_.take(),
            voltage_.take(),
            power_.take(),
            displacementReduction_.take(),
            voltageReduction_.take(),
            powerReduction_.take(),
            faults_.load(std::memory_order_relaxed)};
}

void Processor::getStateInformation(juce::MemoryBlock& block)
{
    const auto bytes = bytesOf({parameters_.recipe(), model(), parameters_.between()});
    block.replaceAll(bytes.data(), bytes.size());
}

void Processor::setStateInformation(const void* data, int size)
{
    try {
        const auto state = stateFrom({static_cast<const char*>(data), static_cast<std::size_t>(std::max(size, 0))});
        requireRunnable(withoutOff(state.model, state.recipe), {48000.0, oversampling});
        parameters_.set(state.recipe, state.between);
        setModel(state.model);
    } catch (const Error&) {
        // A state that cannot be used is none: what is there stays.
    }
}

juce::AudioProcessorEditor* Processor::createEditor() { return new Editor(*this); }

}  // namespace excursion::plugin

juce::AudioProcessor* JUCE_CALLTYPE createPluginFilter() { return new excursion::plugin::Processor(); }
