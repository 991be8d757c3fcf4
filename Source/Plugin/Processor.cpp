// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/Processor.h"

#include "Engine/Error.h"
#include "Plugin/Editor.h"

#include <chrono>

namespace excursion::plugin {
namespace {

constexpr auto patience = std::chrono::milliseconds(20);   // how long a moved switch may wait

Model firstModel()
{
    const auto& drivers = factoryDrivers();
    return modelFromText(drivers[drivers.size() / 2].text, "factory driver");
}

RealTimeOptions options(double sampleRate) { return {sampleRate, Processor::oversampling}; }

} // namespace

Processor::Processor()
    : AudioProcessor(BusesProperties().withInput("Input", juce::AudioChannelSet::stereo(), true).withOutput("Output", juce::AudioChannelSet::stereo(), true)),
      parameters_(*this), model_(firstModel()), measuredDisplacement_(measuredDisplacement(model_)),
      worker_([this](const std::stop_token& stop) { work(stop); })
{
    setLatencySamples(Chain(model_, options(48000.0), {}).latency());   // the same at every rate
}

Processor::~Processor()
{
    worker_.request_stop();
    worker_.join();
}

std::vector<std::unique_ptr<Chain>> Processor::chains(const Model& model) const
{
    const auto running = withoutOff(model, parameters_.recipe());
    std::vector<std::unique_ptr<Chain>> result;
    for (std::size_t k = 0; k < channels_.size(); ++k)
        result.push_back(std::make_unique<Chain>(running, options(sampleRate_), parameters_.controls(measuredDisplacement(running))));
    return result;
}

/// With the mutex held: new chains for the model and the switches as they are.
void Processor::build()
{
    auto fresh = chains(model_);
    measuredDisplacement_.store(measuredDisplacement(withoutOff(model_, parameters_.recipe())), std::memory_order_relaxed);
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
        if (parameters_.takeSwitched() && sampleRate_ > 0.0) {
            try {
                build();
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
    requireRunnable(model, options(sampleRate_ > 0.0 ? sampleRate_ : 48000.0));
    requireRunnable(withoutOff(model, parameters_.recipe()), options(sampleRate_ > 0.0 ? sampleRate_ : 48000.0));
    model_ = model;
    modelVersion_.fetch_add(1, std::memory_order_release);
    build();
}

Model Processor::model() const
{
    const std::lock_guard lock(mutex_);
    return model_;
}

void Processor::prepareToPlay(double sampleRate, int)
{
    const std::lock_guard lock(mutex_);
    sampleRate_ = sampleRate;
    channels_.clear();
    for (int k = 0; k < getMainBusNumOutputChannels(); ++k)
        channels_.push_back(std::make_unique<Crossfade<Chain>>(static_cast<int>(fadeTime * sampleRate)));
    parameters_.takeSwitched();
    auto first = chains(model_);
    measuredDisplacement_.store(measuredDisplacement(withoutOff(model_, parameters_.recipe())), std::memory_order_relaxed);
    for (std::size_t k = 0; k < first.size(); ++k) {
        setLatencySamples(first[k]->latency());
        channels_[k]->start(std::move(first[k]));
    }
}

void Processor::reset()
{
    for (const auto& channel : channels_)
        channel->each([](Chain& chain) { chain.reset(); });
}

bool Processor::isBusesLayoutSupported(const BusesLayout& layout) const
{
    const auto& out = layout.getMainOutputChannelSet();
    return out == layout.getMainInputChannelSet() && (out == juce::AudioChannelSet::mono() || out == juce::AudioChannelSet::stereo());
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
    for (std::size_t c = 0; c < channels_.size() && static_cast<int>(c) < buffer.getNumChannels(); ++c) {
        auto& channel = *channels_[c];
        channel.each([&controls](Chain& chain) { chain.set(controls); });
        Sample* const samples = buffer.getWritePointer(static_cast<int>(c));
        const auto length = static_cast<std::size_t>(buffer.getNumSamples());
        for (std::size_t n = 0; n < length; n += block_.size()) {
            const std::size_t count = std::min(block_.size(), length - n);
            std::copy(samples + n, samples + n + count, block_.begin());
            channel.process(block_.data(), block_.data(), count);
            for (std::size_t k = 0; k < count; ++k)
                samples[n + k] = static_cast<Sample>(block_[k]);
        }
        if (auto* chain = channel.current()) {
            const auto meters = chain->take();
            displacement_.raise(std::max(meters.predistorter.displacement, meters.speaker.displacement));
            displacementReduction_.raise(meters.predistorter.displacementReduction);
            voltage_.raise(meters.predistorter.voltage);
            voltageReduction_.raise(meters.predistorter.voltageReduction);
            faults += meters.faults;
        }
    }
    faults_.store(faults, std::memory_order_relaxed);
    for (int c = static_cast<int>(channels_.size()); c < buffer.getNumChannels(); ++c)
        buffer.clear(c, 0, buffer.getNumSamples());
}

Processor::Meters Processor::take()
{
    return {displacement_.take(), displacementReduction_.take(), voltage_.take(), voltageReduction_.take(), faults_.load(std::memory_order_relaxed)};
}

void Processor::getStateInformation(juce::MemoryBlock& block)
{
    const auto bytes = bytesOf({parameters_.recipe(), model()});
    block.replaceAll(bytes.data(), bytes.size());
}

void Processor::setStateInformation(const void* data, int size)
{
    try {
        const auto state = stateFrom({static_cast<const char*>(data), static_cast<std::size_t>(std::max(size, 0))});
        requireRunnable(withoutOff(state.model, state.recipe), options(48000.0));
        parameters_.set(state.recipe);
        setModel(state.model);
    } catch (const Error&) {
        // A state that cannot be used is none: what is there stays.
    }
}

juce::AudioProcessorEditor* Processor::createEditor() { return new Editor(*this); }

} // namespace excursion::plugin

juce::AudioProcessor* JUCE_CALLTYPE createPluginFilter() { return new excursion::plugin::Processor(); }
