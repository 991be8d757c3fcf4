// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Check/PreparedTake.h"

#include "Engine/Error.h"
#include "Engine/Estimate/MakeRecord.h"
#include "Engine/Estimate/MainsHum.h"
#include "Engine/Estimate/SectionEnds.h"
#include "Engine/Take/FindExcitation.h"

#include <mutex>
#include <optional>
#include <utility>
#include <variant>

namespace excursion {
namespace {

Take completed(Take take)
{
    if (auto* measurement = std::get_if<Measurement>(&take))
        completeExcitation(*measurement);
    return take;
}

}  // namespace

struct PreparedTake::State {
    explicit State(Take given) : take(completed(std::move(given)))
    {
        if (const auto* measurement = std::get_if<Measurement>(&take))
            averages.emplace(*measurement);
    }

    const Take take;
    std::optional<AveragedPeriods> averages;  // what the check and the record ask for, of a take in time
    mutable std::once_flag checked, cut, settledOnce;
    mutable std::optional<Measurement> settled;  // where it is another
    mutable CheckReport report;
    mutable Record record;
};

PreparedTake::PreparedTake(Take take) : state_(std::make_shared<const State>(std::move(take))) {}

PreparedTake::PreparedTake(Measurement measurement) : PreparedTake(Take(std::move(measurement))) {}

PreparedTake::PreparedTake(Spectra spectra) : PreparedTake(Take(std::move(spectra))) {}

const Take& PreparedTake::either() const { return state_->take; }

const Measurement* PreparedTake::inTime() const { return std::get_if<Measurement>(&state_->take); }

const Spectra* PreparedTake::asResponses() const { return std::get_if<Spectra>(&state_->take); }

const Measurement& PreparedTake::measurement() const
{
    if (const auto* measurement = inTime())
        return *measurement;
    throw Error(Error::Kind::data, "This take is a frequency response; waveforms are needed here.");
}

const Measurement& PreparedTake::settled() const
{
    const auto& raw = measurement();
    std::call_once(state_->settledOnce, [&] {
        auto settled = raw;
        const int ends = settleEnds(settled), sinusoids = takeOffHum(settled);
        if (ends + sinusoids > 0)
            state_->settled = std::move(settled);
    });
    return state_->settled ? *state_->settled : raw;
}

const CheckReport& PreparedTake::report() const
{
    std::call_once(state_->checked, [this] {
        state_->report = state_->averages ? check(*state_->averages) : check(std::get<Spectra>(state_->take));
    });
    return state_->report;
}

const Record& PreparedTake::record() const
{
    measurement();  // refuses a frequency response
    std::call_once(state_->cut, [this] {
        RecordOptions options;
        if (const auto& sound = report().sound) {
            options.setAside = sound->isOpen() ? std::vector {Quantity::pressure} : std::vector<Quantity> {};
            options.microphoneCorner = sound->rollOff;
        }
        state_->record = &settled() == inTime() ? makeRecord(*state_->averages, options)
                                                : makeRecord(settled(), options);
    });
    return state_->record;
}

}  // namespace excursion
