// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Audio/Ring.h"
#include "Audio/Stream.h"
#include "Engine/Take/Measurement.h"

#include <atomic>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace excursion::audio {

/// An input that something is connected to.
struct WatchedInput {
    int input = 0;                     ///< of the stream, from 0
    std::optional<Quantity> quantity;  ///< absent: a loopback
    double factor = 1.0;               ///< quantity at a sample of 1.0, in its SI unit
    std::optional<double> limit;       ///< of the quantity's magnitude, positive; of a displacement from where it rests
};

enum class Stage { listening, rising, pausing, playing, trailing, fading, ended };
std::string_view name(Stage);
bool isRecorded(Stage);  ///< the inputs are kept

/// How a procedure ended, and what was seen.
struct Ending {
    enum class Kind {
        complete,
        stopped,   ///< as it was asked to
        limit,     ///< a quantity reached its limit
        clipping,  ///< an input reached its own, or is no number
        unheard,   ///< nothing of what is played arrives
        unseen,    ///< an input that has a limit does not answer what is played
        noInput,   ///< the device gives no inputs
        frozen,    ///< no input moves any more
        broken,    ///< samples were lost
        overrun    ///< recorded samples were not taken away in time
    };
    Kind kind = Kind::complete;
    Stage stage = Stage::listening;  ///< in which it was decided
    std::size_t watched = 0;         ///< limit, clipping, unseen: which of the watched inputs
    double value = 0.0;              ///< limit: what it reached, SI
    double gain = 0.0;               ///< of what was played then; 1: in full
    double seconds = 0.0;            ///< since the stage began
};

struct ProcedureOptions {
    double sampleRate = 0.0;     ///< Hz
    std::vector<float> sound;    ///< what is played, -1 .. 1
    std::vector<float> loudest;  ///< one period with the peak of `sound`; the rise repeats it
    std::vector<WatchedInput> inputs;
    std::vector<int> outputs {0};                                           ///< that play, from 0
    int recorded = 1;                                                       ///< inputs 0 .. recorded - 1 are recorded
    double listen = 0.5, rise = 4.0, pause = 0.5, tail = 1.0, fade = 0.03;  ///< s; rise 0: none
    double ringSeconds = 4.0;
    /// `sound` repeats the spectrum of `loudest`, at other levels: what an input answers to it is known from the rise
    bool repeats = false;
    double latency = 1.0;  ///< s, at most, until what is played comes back
    /// Procedure::heard() of a rise before, for a procedure without one; may be empty
    std::vector<double> heard;

    bool isValid(std::string* reason = nullptr) const;
};

/// The sound of a measurement, sample by sample, a state machine that knows no device:
///
///  - listening: silence; where each input rests and how loud its noise is;
///  - rising: the loudest period again and again, by 40 dB from quiet to full in `rise` seconds, then one period
///    and 0.2 s in full, and a fade;
///  - pausing: silence; from here on the inputs are recorded;
///  - playing: the sound, once;
///  - trailing: silence, as converters deliver later than they are fed;
///  - ended: silence.
///
/// It ends early, after a fade (a cosine of `fade` seconds) where something is being played:
///  - when it is told to stop, an input reaches its limit or clips, or the device gives no inputs;
///  - in the rise, within 12 dB of its end, when no input is twice as loud (rms over a period) as in silence, or
///    one with a limit is not 1.2 times as loud;
///  - when samples are lost while the inputs are recorded, or no input moves for half a second of sound;
///  - while a sound is played that repeats the loudest period, when an input with a limit that was heard in the rise
///    falls silent: over two periods it is not 1.2 times as loud as in silence, where after the rise it should have
///    been four times as loud all the time since what is played is late at most.
///
/// process() is for the thread of the device: it neither allocates nor locks nor calls the system.
class Procedure : public Client {
public:
    explicit Procedure(ProcedureOptions);  ///< throws Error (usage)

    void process(const Block&) noexcept override;

    // Any thread:
    void stop() noexcept { stopAsked_.store(true, std::memory_order_relaxed); }
    Stage stage() const { return stage_.load(std::memory_order_acquire); }
    bool ended() const { return stage() == Stage::ended; }
    std::size_t frames() const { return frames_.load(std::memory_order_acquire); }  ///< that were processed
    double fraction() const;  ///< how much of it is done, when nothing intervenes
    int breaks() const { return breaks_.load(std::memory_order_relaxed); }  ///< blocks that were broken, in any stage

    struct Meter {
        float peak = 0.0f;     ///< largest magnitude of a sample since the last call
        bool clipped = false;  ///< ever
    };
    Meter meter(std::size_t watched);

    /// One thread: appends what was recorded since the last call, one vector an input. @return the frames
    std::size_t readRecorded(std::vector<std::vector<float>>& channels) { return ring_.read(channels); }

    // Once it has ended:
    const Ending& ending() const { return ending_; }
    /// rms of each watched input over a period at full level, over that in silence; ProcedureOptions::heard where
    /// there was no rise
    const std::vector<double>& heard() const { return heard_; }

    const ProcedureOptions& options() const { return options_; }

private:
    struct Watch {
        double offset = 0.0, power = 0.0;  ///< sums while listening, then mean and variance
        double window = 0.0;               ///< sum of squares of the present window
        double windowSum = 0.0;
        bool silent = false;  ///< in the window before, though it should not
        float last = 0.0f;
        std::atomic<float> peak {0.0f};
        std::atomic<bool> clipped {false};
    };

    std::size_t lengthOf(Stage) const;
    double gainAt(std::size_t n) const;  ///< of the rise
    float soundOf(Stage, std::size_t n) const;
    float next();
    void look(const Block&, std::size_t frame);
    void record(const Block&, std::size_t frame);
    void closeListening();
    void closeWindow();
    double closeWindow(std::size_t watched);
    void closePlayed();
    void emptyWindows();
    void advance();
    void enter(Stage);
    void end(Ending::Kind, std::size_t watched = 0, double value = 0.0);

    const ProcedureOptions options_;
    const std::size_t fadeLength_, riseLength_;
    Ring ring_;
    std::vector<float> frame_;
    std::vector<Watch> watches_;
    std::vector<double> heard_;
    double loudestPower_ = 0.0;        // mean square of the loudest period; 0: what is heard tells nothing
    double soundSquares_ = 0.0;        // sum over the present window
    std::vector<double> soundBefore_;  // mean squares in as many windows before as may not have come back yet
    std::size_t oldestSound_ = 0;      // of them

    std::atomic<Stage> stage_ {Stage::listening};
    Stage now_ = Stage::listening, under_ = Stage::listening;  ///< under_: what is faded
    std::size_t at_ = 0, underAt_ = 0, still_ = 0;
    double windowGain_ = 0.0;
    Ending ending_;

    std::atomic<std::size_t> frames_ {0};
    std::atomic<int> breaks_ {0};
    std::atomic<bool> stopAsked_ {false};
    static_assert(std::atomic<float>::is_always_lock_free && std::atomic<Stage>::is_always_lock_free);
};

}  // namespace excursion::audio
