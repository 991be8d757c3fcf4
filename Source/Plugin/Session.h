// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Check/PreparedTake.h"
#include "Engine/Diagnosis/Improvement.h"
#include "Engine/Diagnosis/LadderFile.h"
#include "Engine/Import/RecordingOptions.h"
#include "Engine/Take/Measurement.h"
#include "Engine/Take/SweepExcitation.h"
#include "Plugin/FittedPnlss.h"
#include "Plugin/Identifying.h"

#include <condition_variable>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace excursion::plugin {

/// What the pages show of a take and its ladder. It does not change once it is handed out.
struct Findings {
    std::string source;                ///< where the take is from, in words
    std::vector<std::string> remarks;  ///< on the recording: what is odd in it, in sentences
    std::string truth;                 ///< what the virtual loudspeaker hides; empty for a real one
    bool measured = false;             ///< here, of a loudspeaker: it is in no file until it is saved
    /// V at the loudspeaker for an output sample of 1.0, as it was measured; 0: not known
    double fullScale = 0.0;
    std::shared_ptr<const PreparedTake> take;
    std::optional<SweepExcitation> sweep;  ///< what the take was played with, where its file says so
    CheckReport report;
    LadderFile file;                               ///< without rungs until the first fit is done
    std::vector<std::vector<Waveform>> waveforms;  ///< [level][channel], of the last rung
};

/// A virtual loudspeaker to be measured: one that the seed draws, with one effect hidden that the seed chooses.
struct VirtualOrder {
    std::string driver;  ///< class, see bench::driverClasses()
    std::uint64_t seed = 1;
};

/// Models of the take that know no physics; null: none yet.
struct Identification {
    std::shared_ptr<const Identified> linear;
    std::shared_ptr<const FittedPnlss> pnlss;  ///< that began at this linear model
    bool operator==(const Identification&) const = default;
};

/// A model that has followed what drifted, and what that is, for a person.
struct Adapted {
    Model model;
    std::string words;
    std::uint64_t version = 0;  ///< as it was ordered with
};

/// The work on one take, done on a thread of its own: open it, fit the first model, add effects, take them back,
/// identify models without physics. Every
/// method may be called from any thread but the audio thread, and returns at once; orders are carried out one after the
/// other. A new take makes what is under way stop; each file is read on a thread of its own, so that one that is no
/// take does not, and one that never comes holds up neither the next file nor a save.
class Session {
public:
    /// What a file holds, and the sweeps that it says it was played with; throws Error.
    using Opened = std::pair<Take, std::optional<SweepExcitation>>;
    using Open = std::function<Opened(const std::string& path)>;
    static Opened openFile(const std::string& path);

    explicit Session(Open = openFile);
    ~Session();

    /// As readSweepTake(), or readTake() for responses. What is under way goes on until the take has been read, and for
    /// good where it cannot be; that is a failure, see Status.
    void open(const std::string& path);
    void open(const VirtualOrder&);
    /// Keeps a recording that was just made until openKept(), whatever else is opened meanwhile.
    /// @param fullScale  V at the loudspeaker for an output sample of 1.0; 0: not known
    void keep(RecordingOptions, const std::string& source, std::vector<std::string> remarks, double fullScale = 0.0);
    bool keeps() const;
    void openKept();  ///< as importRecording(); nothing where none is kept
    void add(const std::string& effect);
    void undo();
    void begin();  ///< the first model of the take, where that was cancelled or went wrong
    void identify(const IdentifyWish&);
    void shape(const ShapeWish&);  ///< of the model that was identified; in place of a wish that waits
    void fitPnlss(const PnlssWish&);
    void put(const Identification&);  ///< what there was before; not an order
    /// To the take, by what drifts with temperature and age.
    /// @param version  comes back with what comes of it
    void adapt(const Model&, std::uint64_t version);
    // Saves what it is given, which a page takes when Save is pressed: while a file dialog is open, what is there may
    // become another. Neither cancel() nor another take drops the order; the destructor waits for it.
    void saveReport(std::shared_ptr<const Findings>, const std::string& path);
    void saveTake(std::shared_ptr<const Findings>, const std::string& folder);
    /// with its plan and how it is imported
    void saveRecording(std::shared_ptr<const RecordingOptions>, const std::string& folder);

    /// What is in no file and would be lost, in words: "the take that was measured"; empty: nothing.
    /// @param withRecording  whether a recording of which no take has come would be lost, too
    std::string unsaved(bool withRecording) const;
    void noteSaved(const std::shared_ptr<const FittedPnlss>&);  ///< a page has written it

    void cancel();  ///< stops what is under way, and drops all waiting orders except saves

    struct Status {
        bool busy = false;
        double fraction = 0.0;
        std::string words;     ///< what is being done, or what the last order came to
        bool trouble = false;  ///< the last order failed
        /// why the last save failed, or the last file could not be opened, both beside the other orders
        std::string failure;
        std::uint64_t failures = 0;
        std::uint64_t version = 0;  ///< counts the findings
        std::uint64_t models = 0;   ///< counts the identifications
    };
    Status status() const;
    std::shared_ptr<const Findings> findings() const;  ///< null before the first take
    /// The last recording, until a take that is fit for use is made of it, or it is saved; another take leaves it.
    /// Null: none.
    std::shared_ptr<const RecordingOptions> recordingWithoutTake() const;
    Identification identification() const;
    /// What came of the latest order to adapt, once.
    std::optional<Adapted> takeAdapted();

    void wait() const;  ///< until nothing is under way

private:
    using Work = std::function<void(const Progress&)>;
    /// A file that is to be opened.
    struct Reading {
        std::string path;
        std::optional<Opened> opened;
        std::exception_ptr thrown;  ///< null where it could be read
        bool done = false;
    };
    using ReadingPointer = std::shared_ptr<Reading>;
    struct Order {
        Work work;
        bool saves = false;
        ReadingPointer reading = nullptr;  ///< that it waits for
        bool ready() const { return !reading || reading->done; }
    };
    /// Where threads that read files leave them: one that hangs may outlive the session.
    struct Inbox {
        std::mutex mutex;  ///< before that of the session, where both are held
        std::condition_variable changed;
        Session* session = nullptr;
        int readers = 0;
    };
    void order(Work, bool saves = false);
    void run(const std::stop_token&);
    std::vector<Order>::iterator next();
    static void read(const std::shared_ptr<Inbox>&, const ReadingPointer&, const Open&);
    void came(const ReadingPointer&);
    void fail(const std::string& trouble);
    /// @param told  Findings without a take
    /// @param of    the recording that the take is made of, which leaves where the check finds it fit for use
    void take(PreparedTake, const Findings& told, const Progress&,
              const std::shared_ptr<const RecordingOptions>& of = nullptr);
    void publish(std::shared_ptr<Findings>);
    void publishLadder();
    std::shared_ptr<const Findings> taken() const;
    void say(const std::string&);
    Improvement& improvement();

    std::optional<Improvement> improvement_;  ///< of the thread
    mutable std::mutex mutex_;                ///< of what follows
    mutable std::condition_variable_any changed_;
    std::vector<Order> orders_;
    std::optional<ShapeWish> shape_;  ///< of the order to shape that waits
    std::stop_source stop_;           ///< of the order under way
    bool working_ = false;
    Status status_;
    std::shared_ptr<const Findings> findings_;
    std::shared_ptr<const RecordingOptions> recording_;
    Findings recorded_;   ///< what is told of it
    bool keeps_ = false;  ///< it has not been opened yet
    Identification identification_;
    std::optional<Adapted> adapted_;
    std::weak_ptr<const PreparedTake> savedTake_;  ///< the last one that was
    std::weak_ptr<const FittedPnlss> savedPnlss_;
    const Open open_;
    const std::shared_ptr<Inbox> inbox_ = std::make_shared<Inbox>();
    std::jthread thread_;
};

}  // namespace excursion::plugin
