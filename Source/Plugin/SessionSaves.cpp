// SPDX-License-Identifier: GPL-3.0-or-later
// What a session writes to files.
#include "Engine/Document/DraftFile.h"
#include "Engine/Document/Figures.h"
#include "Engine/Error.h"
#include "Engine/Take/SweepTake.h"
#include "Engine/Take/TakeFile.h"
#include "Plugin/Session.h"
#include "Report/Report.h"

#include <filesystem>
#include <utility>

namespace excursion::plugin {

void Session::saveReport(std::shared_ptr<const Findings> now, const std::string& path)
{
    order(
        [this, now = std::move(now), path](const Progress& progress) {
            if (!now || now->file.ladder.rungs.empty())
                throw Error(Error::Kind::usage,
                            "There is no model of a take to report on: open a take that is fit for use first.");
            progress.at(0.0, "drawing the report");
            writeReport(now->file, path);
            say("Wrote " + path + ".");
        },
        true);
}

void Session::saveTake(std::shared_ptr<const Findings> now, const std::string& folder)
{
    order(
        [this, now = std::move(now), folder](const Progress& progress) {
            const auto* measurement = now ? now->take->inTime() : nullptr;
            if (measurement == nullptr)
                throw Error(Error::Kind::usage, "There is no take of time signals to save.");
            progress.at(0.0, "writing the take");
            writeSweepTake({*measurement, now->sweep}, folder);
            {
                const std::lock_guard lock(mutex_);
                savedTake_ = now->take;
            }
            say("Wrote " + folder + ".");
        },
        true);
}

std::shared_ptr<const RecordingOptions> Session::recordingWithoutTake() const
{
    const std::lock_guard lock(mutex_);
    return recording_;
}

void Session::saveRecording(std::shared_ptr<const RecordingOptions> recording, const std::string& folder)
{
    order(
        [this, recording = std::move(recording), folder](const Progress& progress) {
            if (!recording || recording->sounds.empty() || !recording->plan)
                throw Error(Error::Kind::usage, "There is no recording to save.");
            progress.at(0.0, "writing the recording");
            const auto place = std::filesystem::path(folder);
            const auto& sound = recording->sounds.front().sound;
            writePlan(*recording->plan, place / "plan");
            writeWav(place / "recording.wav", sound.sampleRate, sound.channels, SampleFormat::float32);
            std::string command = "excursion import recording.wav --plan plan";
            for (const auto& channel : recording->map)
                command += " --map " + std::to_string(channel.channel) + "=" + std::string(name(*channel.quantity))
                           + ":" + figure(channel.fullScale.value_or(1.0), "%.9g");
            DraftFile draft(place / "import.txt");
            draft.write(command + " --out take\n");
            draft.publish();
            {
                const std::lock_guard lock(mutex_);
                if (recording_ == recording && !keeps_)
                    recording_ = nullptr;
            }
            say("Wrote " + folder + ": the recording, its plan, and how it is imported.");
        },
        true);
}

void Session::noteSaved(const std::shared_ptr<const FittedPnlss>& pnlss)
{
    const std::lock_guard lock(mutex_);
    savedPnlss_ = pnlss;
}

std::string Session::unsaved(bool withRecording) const
{
    const std::lock_guard lock(mutex_);
    std::string words;
    const auto add = [&words](const char* what) { words += (words.empty() ? "" : " and ") + std::string(what); };
    // of a take that is not fit for use the recording is what counts
    if (findings_ && findings_->measured && findings_->report.fitForUse() && findings_->take != savedTake_.lock())
        add("the take that was measured");
    if (identification_.pnlss && identification_.pnlss != savedPnlss_.lock())
        add("the PNLSS that was fitted");
    if (withRecording && recording_)
        add("the last recording");
    return words;
}

}  // namespace excursion::plugin
