// SPDX-License-Identifier: GPL-3.0-or-later
#include "Plugin/Processor.h"

#include "Engine/BlackBox/BlackBoxEngine.h"
#include "Engine/Error.h"

#include <chrono>
#include <utility>

namespace excursion::plugin {
namespace {

constexpr auto patience = std::chrono::milliseconds(20);  // how long a moved switch may wait

Model firstModel()
{
    const auto& drivers = factoryDrivers();
    return modelFromText(drivers[drivers.size() / 2].text, "factory driver");
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
      worker_([this](const std::stop_token& stop) { work(stop); }),
      rehearsing_([this](const LoadedBoxPointer& box, const std::stop_token& stop) {
          put(box, stop);
          tellsState_ = true;  // whether a window is open or not
          triggerAsyncUpdate();
      })
{
    latency_ = Chain(model_, options(), {}).latency();  // the same at every rate
    setLatency();
}

Processor::~Processor()
{
    rehearsing_.cancel();
    rehearsing_.wait();
    cancelPendingUpdate();
    worker_.request_stop();
    worker_.join();
}

/// With the mutex held: at the rate that was prepared, or at one at which any model runs where the engine cannot run at
/// that.
RealTimeOptions Processor::options() const
{
    const auto coupling = couplingOf(parameters_.settings());
    const RealTimeOptions asked {sampleRate_, oversampling, coupling};
    return asked.isValid(nullptr) ? asked : RealTimeOptions {48000.0, oversampling, coupling};
}

/// With the mutex held: one chain a channel, with the switches as they are.
Processor::Chains Processor::chains(const AnyModel& model, std::size_t channels)
{
    built_ = toBuild();
    const auto realTime = options();
    Chains result;
    if (const auto* box = std::get_if<LoadedBoxPointer>(&model)) {
        const double measured = measuredDisplacement((*box)->played);
        const auto controls = parameters_.controls(measured);
        for (std::size_t k = 0; k < channels; ++k)
            result.push_back(std::make_unique<ModelChain>(
                measured,
                std::make_unique<BlackBoxEngine>((*box)->played, realTime.sampleRate, controls.predistortion,
                                                 realTime.coupling),
                realTime.sampleRate, controls));
    } else {
        const auto& loaded = std::get<Model>(model);
        const auto running = asSwitched(loaded, parameters_.recipe(), realTime);
        // An effect that is switched off takes no limit with it.
        const double measured = measuredDisplacement(loaded);
        for (std::size_t k = 0; k < channels; ++k)
            result.push_back(std::make_unique<ModelChain>(measured, running, realTime, parameters_.controls(measured)));
    }
    return result;
}

/// With the mutex held: offers new chains for the model.
/// @returns their latency
int Processor::build(const AnyModel& model)
{
    auto fresh = chains(model, std::max<std::size_t>(channels_.size(), 1));
    const int latency = fresh.front()->latency();
    for (auto& chain : fresh) {
        // Warm: its memory has been touched before the audio thread gets it.
        std::array<double, 256> silence {};
        chain->process(silence.data(), silence.data(), silence.size());
        chain->reset();
    }
    // Offered together at the end, so that no channel switches before another.
    for (std::size_t k = 0; k < channels_.size(); ++k)
        channels_[k]->offer(std::move(fresh[k]), latency);
    return latency;
}

/// With the mutex held, while no audio runs: chains that play from the first sample on. A coil stays as warm as it is.
void Processor::playAlone(Chains fresh)
{
    std::vector<std::unique_ptr<Crossfade<ModelChain>>> channels;
    for (std::size_t k = 0; k < fresh.size(); ++k) {
        if (k < channels_.size() && channels_[k]->current() != nullptr)
            fresh[k]->takeOver(*channels_[k]->current());
        channels.push_back(std::make_unique<Crossfade<ModelChain>>(static_cast<int>(fadeTime * sampleRate_),
                                                                   static_cast<int>(warmTime * sampleRate_)));
        channels.back()->start(std::move(fresh[k]));
    }
    channels_ = std::move(channels);
}

std::pair<std::uint64_t, AmplifierCoupling> Processor::toBuild() const
{
    return {parameters_.switches(), couplingOf(parameters_.settings())};
}

/// With the mutex held: new chains where effects have been switched, or the amplifier is another.
void Processor::followSwitches()
{
    if (channels_.empty() || parameters_.areBeingSet())
        return;
    auto wanted = toBuild();
    if (box_)
        wanted.first = built_.first;  // it has no effects
    if (wanted == built_)
        return;
    try {
        build(box_ ? AnyModel(box_) : AnyModel(model_));
    } catch (const std::exception&) {
        // Without some effect the model cannot be run: what plays goes on.
    }
}

void Processor::work(const std::stop_token& stop)
{
    std::unique_lock lock(mutex_);
    while (!stop.stop_requested()) {
        for (const auto& channel : channels_)
            channel->collect();
        followSwitches();
        wake_.wait_for(lock, stop, patience, [] { return false; });
    }
}

void Processor::setModel(const AnyModel& model)
{
    rehearsing_.cancel();
    put(model);
}

/// With the mutex held. Throws Error for a model that cannot be played at the rate, with the switches of the recipe.
void Processor::requirePlayable(const AnyModel& model, const Recipe& recipe) const
{
    if (const auto* box = std::get_if<LoadedBoxPointer>(&model)) {
        BlackBoxEngine((*box)->played, options().sampleRate, PredistortionControls {});
        return;
    }
    requireRunnable(std::get<Model>(model), options());
    requireRunnable(withoutOff(std::get<Model>(model), recipe), options());
}

/// @param stop  is asked when its turn has come: a newer model may have been set meanwhile, whose cancelling came first
void Processor::put(const AnyModel& model, const std::stop_token& stop)
{
    {
        const std::lock_guard lock(mutex_);
        if (stop.stop_requested())
            throw Error(Error::Kind::cancelled, "The model is not wanted any more.");
        requirePlayable(model, parameters_.recipe());
        const auto* box = std::get_if<LoadedBoxPointer>(&model);
        int latency = build(model);
        box_ = box != nullptr ? *box : nullptr;
        if (box == nullptr)
            model_ = std::get<Model>(model);
        if (!delays_.empty()) {
            // From a standstill: the model before could not be run at this rate, this one may.
            const juce::ScopedLock still(getCallbackLock());
            latency = start();
        }
        latency_ = latency;
        modelVersion_.fetch_add(1, std::memory_order_release);
    }
    tellLatency();
}

/// A host may prepare on another thread while the message thread tells what it knows already.
void Processor::setLatency()
{
    const int now = latency_;
    if (setLatency_.exchange(now) != now)
        setLatencySamples(now);
}

/// At once on the message thread, else there as soon as it can.
void Processor::tellLatency()
{
    if (juce::MessageManager::existsAndIsCurrentThread())
        handleAsyncUpdate();
    else
        triggerAsyncUpdate();
}

void Processor::handleAsyncUpdate()
{
    setLatency();
    if (tellsState_.exchange(false))
        tellHostOfState();
}

AnyModel Processor::anyModel() const
{
    const std::lock_guard lock(mutex_);
    return box_ ? AnyModel(box_) : AnyModel(model_);
}

LoadedBoxPointer Processor::box() const
{
    const std::lock_guard lock(mutex_);
    return box_;
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
    {
        const std::lock_guard lock(mutex_);
        sampleRate_ = sampleRate;
        latency_ = start();
    }
    // Whoever prepares asks for it next, whichever thread that is, and may have no message loop.
    cancelPendingUpdate();
    setLatency();
    if (tellsState_)  // which was cancelled with it
        triggerAsyncUpdate();
}

/// With the mutex held, while no audio runs: chains that play at once, or delays.
/// @returns the latency
int Processor::start()
{
    delays_.clear();
    standstill_.clear();
    heard_.store(false);
    parameters_.read(settings_);
    const auto count = static_cast<std::size_t>(getMainBusNumOutputChannels());
    try {
        if (std::string reason; !RealTimeOptions {sampleRate_, oversampling}.isValid(&reason))
            throw Error(Error::Kind::usage, reason + ".");
        auto first = chains(box_ ? AnyModel(box_) : AnyModel(model_), std::max<std::size_t>(count, 1));
        const int latency = first.front()->latency();
        first.resize(count);
        playAlone(std::move(first));
        return latency;
    } catch (const std::exception& error) {
        // No host expects an exception here.
        standstill_ = std::string("The signal goes through as it is: ") + error.what();
        channels_.clear();
        delays_.assign(count, Delay(latency_));
        return latency_;
    }
}

void Processor::reset()
{
    heard_.store(false);  // what plays may only be touched where it plays
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
    if (buffer.getNumSamples() == 0)  // some hosts only bring parameters
        return;
    const bool offline = isNonRealtime();
    if (offline && !channels_.empty()) {  // what is rendered does not depend on when another thread finds time
        const std::lock_guard lock(mutex_);
        followSwitches();
    }
    parameters_.read(settings_);
    const bool first = !heard_.exchange(true), begins = std::exchange(offline_, offline) != offline || first;
    int faults = 0;
    const std::size_t channels = std::max(channels_.size(), delays_.size());
    for (std::size_t c = 0; c < channels && static_cast<int>(c) < buffer.getNumChannels(); ++c) {
        auto* const channel = channels_.empty() ? nullptr : channels_[c].get();
        if (begins && channel == nullptr)
            delays_[c].reset();
        if (begins && channel != nullptr)
            channel->jump();
        if (channel != nullptr)
            channel->each([&](ModelChain& chain) {
                auto controls = chainControls(settings_, chain.measuredDisplacement);
                if (bypassed) {
                    controls.mode = Mode::bypass;
                    controls.trim = 1.0;
                }
                chain.set(controls);
                if (begins && offline)
                    chain.reset();
                else if (begins)
                    chain.settle();
            });
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
            const auto meters = chain->collectMeters();
            region_.raise(meters.region);
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

Processor::Meters Processor::collectMeters()
{
    return {displacement_.readAndReset(),
            voltage_.readAndReset(),
            power_.readAndReset(),
            displacementReduction_.readAndReset(),
            voltageReduction_.readAndReset(),
            powerReduction_.readAndReset(),
            region_.readAndReset(),
            faults_.load(std::memory_order_relaxed)};
}

std::string Processor::stateBytes() const { return bytesOf({parameters_.recipe(), anyModel(), parameters_.between()}); }

std::string Processor::refusal() const
{
    const std::lock_guard lock(mutex_);
    return refused_.reason;
}

void Processor::getStateInformation(juce::MemoryBlock& block)
{
    auto bytes = stateBytes();
    {
        // A host saves over what it had: as long as nothing was changed, that is the state that could not be used.
        const std::lock_guard lock(mutex_);
        if (bytes == refused_.instead)
            bytes = refused_.bytes;
        else
            refused_ = {};
    }
    block.replaceAll(bytes.data(), bytes.size());
}

void Processor::setStateInformation(const void* data, int size)
{
    if (data == nullptr || size <= 0)
        return;
    const std::string_view bytes(static_cast<const char*>(data), static_cast<std::size_t>(size));
    const auto refuse = [&](const std::exception& error) {
        const auto instead = stateBytes();
        const std::lock_guard lock(mutex_);
        refused_ = {std::string(bytes), std::string("What was saved is not used: ") + error.what(), instead};
    };
    try {
        const auto state = stateFrom(bytes, box());
        {
            // All of it is used or nothing, so what may be refused is asked first.
            const std::lock_guard lock(mutex_);
            requirePlayable(state.model, state.recipe);
        }
        parameters_.set(state.recipe, state.between);
        setModel(state.model);
        const std::lock_guard lock(mutex_);
        refused_ = {};
    } catch (const std::exception& error) {
        refuse(error);  // what is there stays
    }
}

}  // namespace excursion::plugin
