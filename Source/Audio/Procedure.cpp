// SPDX-License-Identifier: GPL-3.0-or-later
#include "Audio/Procedure.h"

#include "Engine/Document/Figures.h"
#include "Engine/Error.h"
#include "Engine/Validity.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace excursion::audio {
namespace {

constexpr double riseDb = 40.0;       // from quiet to full
constexpr double holdSeconds = 0.2;   // in full, before the period that is judged: devices deliver late
constexpr double judgedDb = 12.0;     // below full, from where on something must be heard
constexpr double heardRatio = 2.0;    // of the rms in silence
constexpr double seenRatio = 1.2;     // the same, of an input with a limit, which may be a quiet sensor
constexpr double certainRatio = 4.0;  // the same, that by the rise is expected of an input that must not be silent
constexpr double frozenSeconds = 0.5;
constexpr float clippingAt = 0.9999f;  // the largest sample of 16 bits is 0.99997

std::size_t framesOf(double seconds, double sampleRate)
{
    return static_cast<std::size_t>(std::lround(seconds * sampleRate));
}

ProcedureOptions valid(ProcedureOptions options)
{
    std::string reason;
    if (!options.isValid(&reason))
        throw Error(Error::Kind::usage, reason);
    return options;
}

}  // namespace

std::string_view name(Stage stage)
{
    switch (stage) {
    case Stage::listening: return "listening";
    case Stage::rising: return "rising";
    case Stage::pausing: return "pausing";
    case Stage::playing: return "playing";
    case Stage::trailing: return "trailing";
    case Stage::fading: return "fading";
    case Stage::ended: return "ended";
    }
    return "";
}

bool isRecorded(Stage stage) { return stage == Stage::pausing || stage == Stage::playing || stage == Stage::trailing; }

bool ProcedureOptions::isValid(std::string* reason) const
{
    if (!(std::isfinite(sampleRate) && sampleRate > 0))
        return refuse(reason, "A measurement needs a sample rate above zero.");
    const auto playable = [](const std::vector<float>& samples) {
        return std::all_of(samples.begin(), samples.end(), [](float s) { return std::abs(s) <= 1.0f; });
    };
    if (sound.empty() || !playable(sound))
        return refuse(reason, "What is played must have samples, all of them within -1 and 1.");
    if (rise > 0 && (loudest.empty() || !playable(loudest)))
        return refuse(reason, "A rise needs a loudest period, all of it within -1 and 1.");
    if (recorded < 1 || inputs.empty() || outputs.empty()
        || std::any_of(outputs.begin(), outputs.end(), [](int o) { return o < 0; }))
        return refuse(reason, "A measurement needs an input and an output.");
    for (const auto& watched : inputs) {
        if (watched.input < 0 || watched.input >= recorded)
            return refuse(reason, "An input is watched that is not recorded.");
        if (watched.limit && !(std::isfinite(*watched.limit) && *watched.limit > 0))
            return refuse(reason, "A limit must be a number above zero.");
        if (watched.limit && !watched.quantity)
            return refuse(reason, "A limit is one of a quantity.");
        // an input clips at its full scale; a displacement counts from rest, which may be at the other end
        const double most = std::abs(watched.factor) * (watched.quantity == Quantity::displacement ? 2.0 : 1.0);
        if (watched.limit && !(*watched.limit < most))
            return refuse(reason, "The limit of the " + std::string(name(*watched.quantity)) + " is "
                                      + figure(*watched.limit, "%.4g") + " " + std::string(siUnit(*watched.quantity))
                                      + ", which its input cannot reach; give one below " + figure(most, "%.4g") + ".");
    }
    if (!heard.empty() && (heard.size() != inputs.size() || !std::all_of(heard.begin(), heard.end(), [](double ratio) {
                               return std::isfinite(ratio);
                           })))
        return refuse(reason, "What was heard in a rise before must be a number for each watched input.");
    for (const double seconds : {listen, rise, pause, tail, fade, ringSeconds, latency})
        if (!(seconds >= 0 && seconds <= 3600))
            return refuse(reason, "The stages of a measurement take 0 to 3600 s each.");
    if (!(listen > 0) || !(fade > 0) || !(ringSeconds > 0))
        return refuse(reason, "Listening, the fade and the buffer for recorded samples cannot be without length.");
    return true;
}

Procedure::Procedure(ProcedureOptions options)
    : options_(valid(std::move(options))),
      fadeLength_(std::max<std::size_t>(1, framesOf(options_.fade, options_.sampleRate))),
      riseLength_(framesOf(options_.rise, options_.sampleRate)),
      ring_(static_cast<std::size_t>(options_.recorded),
            std::max<std::size_t>(1, framesOf(options_.ringSeconds, options_.sampleRate))),
      frame_(static_cast<std::size_t>(options_.recorded)),
      watches_(options_.inputs.size())
{
    heard_ = options_.heard;
    if (riseLength_ > 0)
        heard_.assign(watches_.size(), 0.0);
    if (!options_.repeats || heard_.empty() || options_.loudest.empty())
        return;
    const auto period = static_cast<double>(options_.loudest.size());
    for (const double s : options_.loudest)
        loudestPower_ += s * s / period;
    soundBefore_.resize(
        std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(options_.latency * options_.sampleRate / period))));
}

std::size_t Procedure::lengthOf(Stage stage) const
{
    switch (stage) {
    case Stage::listening: return std::max<std::size_t>(1, framesOf(options_.listen, options_.sampleRate));
    case Stage::rising:
        return riseLength_ + framesOf(holdSeconds, options_.sampleRate) + options_.loudest.size() + fadeLength_;
    case Stage::pausing: return framesOf(options_.pause, options_.sampleRate);
    case Stage::playing: return options_.sound.size();
    case Stage::trailing: return framesOf(options_.tail, options_.sampleRate);
    case Stage::fading: return fadeLength_;
    case Stage::ended: break;
    }
    return 0;
}

double Procedure::fraction() const
{
    if (ended())
        return 1.0;
    std::size_t all = 0;
    for (const auto stage : {Stage::listening, Stage::pausing, Stage::playing, Stage::trailing})
        all += lengthOf(stage);
    if (riseLength_ > 0)
        all += lengthOf(Stage::rising);
    return std::min(1.0, static_cast<double>(frames()) / static_cast<double>(all));
}

Procedure::Meter Procedure::meter(std::size_t watched)
{
    auto& watch = watches_[watched];
    return {watch.peak.exchange(0.0f, std::memory_order_relaxed), watch.clipped.load(std::memory_order_relaxed)};
}

double Procedure::gainAt(std::size_t n) const
{
    if (n >= riseLength_)
        return 1.0;
    return std::pow(10.0, -riseDb / 20.0 * (1.0 - static_cast<double>(n) / static_cast<double>(riseLength_)));
}

float Procedure::soundOf(Stage stage, std::size_t n) const
{
    if (n >= lengthOf(stage))
        return 0.0f;
    if (stage == Stage::playing)
        return options_.sound[n];
    if (stage != Stage::rising)
        return 0.0f;
    const auto left = lengthOf(stage) - n;
    double gain = gainAt(n) * std::min(1.0, static_cast<double>(n) / static_cast<double>(fadeLength_));
    if (left <= fadeLength_)
        gain *= 0.5
                - 0.5 * std::cos(std::numbers::pi * static_cast<double>(left - 1) / static_cast<double>(fadeLength_));
    return static_cast<float>(gain) * options_.loudest[n % options_.loudest.size()];
}

float Procedure::next()
{
    if (now_ != Stage::fading)
        return soundOf(now_, at_);
    const double rest =
        0.5 + 0.5 * std::cos(std::numbers::pi * static_cast<double>(at_ + 1) / static_cast<double>(fadeLength_));
    return static_cast<float>(rest) * soundOf(under_, underAt_ + at_);
}

void Procedure::enter(Stage stage)
{
    now_ = stage;
    at_ = still_ = 0;
    stage_.store(stage, std::memory_order_release);
}

void Procedure::end(Ending::Kind kind, std::size_t watched, double value)
{
    if (now_ == Stage::fading || now_ == Stage::ended)
        return;
    ending_.kind = kind;
    ending_.stage = now_;
    ending_.watched = watched;
    ending_.value = value;
    ending_.gain = now_ == Stage::rising ? gainAt(at_) : now_ == Stage::playing ? 1.0 : 0.0;
    ending_.seconds = static_cast<double>(at_) / options_.sampleRate;
    under_ = now_;
    underAt_ = at_;
    enter(now_ == Stage::rising || now_ == Stage::playing ? Stage::fading : Stage::ended);
}

void Procedure::look(const Block& block, std::size_t frame)
{
    bool moved = false;
    for (std::size_t k = 0; k < watches_.size(); ++k) {
        const auto& watched = options_.inputs[k];
        auto& watch = watches_[k];
        const float x = block.in[watched.input][frame];
        moved = moved || x != watch.last;
        watch.last = x;
        const float size = std::abs(x);
        if (size > watch.peak.load(std::memory_order_relaxed))
            watch.peak.store(size, std::memory_order_relaxed);
        if (now_ == Stage::ended)
            continue;
        if (!(size < clippingAt)) {
            watch.clipped.store(true, std::memory_order_relaxed);
            end(Ending::Kind::clipping, k);
        }
        if (now_ == Stage::listening) {
            watch.offset += x;
            watch.power += static_cast<double>(x) * x;
        } else {
            const double beside = x - watch.offset;
            watch.window += beside * beside;
            watch.windowSum += beside;
        }
        if (watched.limit) {
            const bool fromRest = watched.quantity == Quantity::displacement;
            if (fromRest && now_ == Stage::listening)
                continue;
            const double value = std::abs(watched.factor * (fromRest ? x - watch.offset : x));
            if (value >= *watched.limit)
                end(Ending::Kind::limit, k, value);
        }
    }
    const bool sounds = now_ == Stage::playing && options_.sound[at_] != 0.0f;  // else nothing need move
    still_ = moved || !sounds ? 0 : still_ + 1;
    if (still_ > framesOf(frozenSeconds, options_.sampleRate))
        end(Ending::Kind::frozen);
}

void Procedure::closeListening()
{
    const auto count = static_cast<double>(lengthOf(Stage::listening));
    for (auto& watch : watches_) {
        watch.offset /= count;
        watch.power = std::max(0.0, watch.power / count - watch.offset * watch.offset);
    }
}

/// The rms of an input over a period, over that in silence.
double Procedure::closeWindow(std::size_t watched)
{
    auto& watch = watches_[watched];
    const auto count = static_cast<double>(options_.loudest.size());
    const double mean = watch.windowSum / count,  // where a sensor has drifted to
        power = std::max(0.0, watch.window / count - mean * mean);
    watch.window = watch.windowSum = 0.0;
    // as far as one sample of 24 bits, where the silence was perfect
    return std::sqrt(power / std::max(watch.power, 1e-14));
}

void Procedure::emptyWindows()
{
    for (auto& watch : watches_) {
        watch.window = watch.windowSum = 0.0;
        watch.silent = false;
    }
    soundSquares_ = 0.0;
    std::fill(soundBefore_.begin(), soundBefore_.end(), 0.0);
}

/// Judges as many samples of the sound as a period has.
void Procedure::closePlayed()
{
    const double power = std::exchange(soundSquares_, 0.0) / static_cast<double>(options_.loudest.size());
    const double before = *std::min_element(soundBefore_.begin(), soundBefore_.end());
    const double least = std::sqrt(std::min(power, before) / loudestPower_);
    soundBefore_[oldestSound_] = power;
    oldestSound_ = (oldestSound_ + 1) % soundBefore_.size();
    for (std::size_t k = 0; k < watches_.size(); ++k) {
        const bool silent = closeWindow(k) <= seenRatio && heard_[k] * least > certainRatio;
        if (std::exchange(watches_[k].silent, silent) && silent && options_.inputs[k].limit)
            end(Ending::Kind::unseen, k);
    }
}

/// Judges a period of the rise.
void Procedure::closeWindow()
{
    bool any = false;
    for (std::size_t k = 0; k < watches_.size(); ++k) {
        heard_[k] = closeWindow(k);
        any = any || heard_[k] > heardRatio;
    }
    if (windowGain_ <= std::pow(10.0, -judgedDb / 20.0))
        return;
    if (!any)
        end(Ending::Kind::unheard);
    for (std::size_t k = 0; k < watches_.size(); ++k)
        if (options_.inputs[k].limit && heard_[k] <= seenRatio)
            end(Ending::Kind::unseen, k);
}

void Procedure::record(const Block& block, std::size_t frame)
{
    for (std::size_t k = 0; k < frame_.size(); ++k)
        frame_[k] = block.in[k][frame];
    if (!ring_.write(frame_))
        end(Ending::Kind::overrun);
}

void Procedure::advance()
{
    ++at_;
    if (now_ == Stage::rising) {
        // the last window ends where the fade begins
        const auto toFade = lengthOf(Stage::rising) - fadeLength_;
        if (at_ <= toFade && (toFade - at_) % options_.loudest.size() == 0) {
            const auto begin = at_ >= options_.loudest.size() ? at_ - options_.loudest.size() : 0;
            windowGain_ = gainAt(begin);
            if (at_ >= options_.loudest.size())
                closeWindow();
            else
                emptyWindows();
        }
    }
    if (now_ == Stage::playing && loudestPower_ > 0.0) {
        const double s = options_.sound[at_ - 1];
        soundSquares_ += s * s;
        if (at_ % options_.loudest.size() == 0)
            closePlayed();
    }
    while (now_ != Stage::ended && at_ >= lengthOf(now_)) {
        switch (now_) {
        case Stage::listening:
            closeListening();
            enter(riseLength_ > 0 ? Stage::rising : Stage::pausing);
            emptyWindows();
            break;
        case Stage::rising: enter(Stage::pausing); break;
        case Stage::pausing:
            enter(Stage::playing);
            emptyWindows();
            break;
        case Stage::playing: enter(Stage::trailing); break;
        case Stage::trailing:
            ending_.kind = Ending::Kind::complete;
            ending_.stage = Stage::trailing;
            enter(Stage::ended);
            break;
        default: enter(Stage::ended);
        }
    }
}

void Procedure::process(const Block& block) noexcept
{
    if (block.broken || block.in == nullptr) {
        breaks_.fetch_add(1, std::memory_order_relaxed);
        if (block.in == nullptr)  // no limit can be kept
            end(Ending::Kind::noInput);
        else if (isRecorded(now_))
            end(Ending::Kind::broken);
    }
    if (stopAsked_.load(std::memory_order_relaxed))
        end(Ending::Kind::stopped);
    for (std::size_t n = 0; n < block.frames; ++n) {
        if (block.in != nullptr) {
            look(block, n);
            if (isRecorded(now_))
                record(block, n);
        }
        const float s = next();
        for (std::size_t c = 0; c < block.outputs; ++c)
            block.out[c][n] = 0.0f;
        for (const int output : options_.outputs)
            block.out[output][n] = s;
        if (now_ != Stage::ended)
            advance();
    }
    frames_.fetch_add(block.frames, std::memory_order_release);
}

}  // namespace excursion::audio
