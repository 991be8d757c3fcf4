// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Check/PreparedTake.h"
#include "Engine/Diagnosis/Improvement.h"
#include "Engine/Diagnosis/LadderFile.h"
#include "Engine/Import/RecordingOptions.h"
#include "Engine/Take/Measurement.h"
#include "Plugin/FittedPnlss.h"
#include "Plugin/Identifying.h"

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace excursion::plugin {

/// What the pages show of a take and its ladder. It does not change once it is handed out.
struct Findings {
    std::string source;                ///< where the take is from, in words
    std::vector<std::string> remarks;  ///< on the recording: what is odd in it, in sentences
    std::string truth;                 ///< what the virtual loudspeaker hides; empty for a real one
    std::shared_ptr<const PreparedTake> take;
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
/// other. A new take makes what is under way stop.
class Session {
public:
    Session();
    ~Session();

    void open(const std::string& path);  ///< as readTake()
    void open(const VirtualOrder&);
    /// Keeps a recording that was just made until openKept(), whatever else is opened meanwhile.
    void keep(RecordingOptions, const std::string& source, std::vector<std::string> remarks);
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
    // Saves what is there when the method is called. Neither cancel() nor another take drops the order; the destructor
    // waits for it.
    void saveReport(const std::string& path);
    void saveTake(const std::string& folder);
    void saveRecording(const std::string& folder);  ///< recordingWithoutTake(), with its plan and how it is imported

    void cancel();  ///< stops what is under way, and drops all waiting orders except saves

    struct Status {
        bool busy = false;
        double fraction = 0.0;
        std::string words;     ///< what is being done, or what the last order came to
        bool trouble = false;  ///< the last order failed
        std::string notSaved;  ///< why the last save failed that did
        std::uint64_t failedSaves = 0;
        std::uint64_t version = 0;  ///< counts the findings
        std::uint64_t models = 0;   ///< counts the identifications
    };
    Status status() const;
    std::shared_ptr<const Findings> findings() const;  ///< null before the first take
    /// The last recording, until a take that is fit for use is made, or it is saved. Null: none.
    std::shared_ptr<const RecordingOptions> recordingWithoutTake() const;
    Identification identification() const;
    /// What came of the latest order to adapt, once.
    std::optional<Adapted> takeAdapted();

    void wait() const;  ///< until nothing is under way

private:
    using Work = std::function<void(const Progress&)>;
    struct Order {
        Work work;
        bool saves = false;
    };
    void order(Work, bool saves = false);
    void run(const std::stop_token&);
    /// @param told  Findings without a take
    void take(PreparedTake, const Findings& told, const Progress&);
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
    std::jthread thread_;
};

}  // namespace excursion::plugin
