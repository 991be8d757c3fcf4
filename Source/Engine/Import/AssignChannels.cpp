// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Import/AssignChannels.h"

#include "Engine/Error.h"

#include <algorithm>

namespace excursion {
namespace {

/// Where a mapping points to. Numbers without a file count through all files.
AssignedChannel locate(const ChannelMapping& mapping, const std::vector<RecordingShape>& recordings)
{
    const auto refuse = [&](const std::string& why) {
        throw Error(Error::Kind::usage, "--map " + mapping.text + ": " + why);
    };
    AssignedChannel place;
    place.quantity = mapping.quantity;
    auto number = static_cast<std::size_t>(mapping.channel - 1);
    if (!mapping.file.empty()) {
        std::vector<std::size_t> matching;
        for (std::size_t f = 0; f < recordings.size(); ++f)
            if (const auto& path = recordings[f].path;
                path == mapping.file || path.filename() == mapping.file || path.stem() == mapping.file)
                matching.push_back(f);
        if (matching.size() != 1)
            refuse(matching.empty()
                       ? "none of the recordings is '" + mapping.file + "'."
                       : "more than one of the recordings is '" + mapping.file + "'; give its whole path.");
        place.file = matching.front();
    } else {
        while (place.file + 1 < recordings.size() && number >= recordings[place.file].channels)
            number -= recordings[place.file++].channels;
    }
    if (number >= recordings[place.file].channels) {
        std::size_t all = 0;
        for (const auto& recording : recordings)
            all += recording.channels;
        const bool one = !mapping.file.empty() || recordings.size() == 1;
        refuse((one ? "'" + recordings[place.file].path.string() + "' has "
                          + std::to_string(recordings[place.file].channels)
                    : "the recordings have " + std::to_string(all))
               + " channels; they are counted from 1.");
    }
    place.channel = number;
    return place;
}

std::vector<ChannelMapping> mappingsOf(const RecordingOptions& options)
{
    if (!options.map.empty())
        return options.map;
    std::vector<ChannelMapping> mappings;
    if (options.calibration)
        for (const auto& c : options.calibration->channels)
            if (c.quantity) {
                const auto text = std::to_string(c.channel) + "=" + std::string(name(*c.quantity));
                mappings.push_back({"", c.channel, c.quantity, {}, {}, text});
            }
    if (mappings.empty())
        throw Error(Error::Kind::usage, "A recording does not say what its channels hold; give --map, for example "
                                        "--map 1=voltage:32 --map 2=current:4.");
    return mappings;
}

}  // namespace

std::vector<AssignedChannel> assignChannels(const RecordingOptions& options,
                                            const std::vector<RecordingShape>& recordings)
{
    std::vector<AssignedChannel> assigned;
    for (const auto& mapping : mappingsOf(options)) {
        auto place = locate(mapping, recordings);
        for (const auto& other : assigned) {
            if (other.file == place.file && other.channel == place.channel)
                throw Error(Error::Kind::usage, "--map " + mapping.text + ": that channel is mapped already.");
            if (other.quantity == place.quantity && (place.quantity || other.file == place.file))
                throw Error(Error::Kind::usage, "--map " + mapping.text + ": there is a "
                                                    + (place.quantity ? std::string(name(*place.quantity)) : "loopback")
                                                    + " already; a take holds each quantity once.");
        }
        if (place.quantity) {
            int number = static_cast<int>(place.channel) + 1;
            for (std::size_t f = 0; f < place.file; ++f)
                number += static_cast<int>(recordings[f].channels);
            const auto* calibrated = options.calibration ? options.calibration->find(number) : nullptr;
            if (!mapping.fullScale && !calibrated)
                throw Error(
                    Error::Kind::usage,
                    "--map " + mapping.text
                        + ": what a sample of 1.0 stands for is not known; write it behind a colon, for example "
                        + mapping.text + ":4, or give a --calibration that has channel " + std::to_string(number)
                        + ".");
            place.factor = mapping.fullScale
                               ? *mapping.fullScale
                               : calibrated->quantityAtFullScale(*place.quantity, options.calibrationFile);
            place.latency = mapping.latency.value_or(calibrated ? calibrated->latency : 0.0);
            if (calibrated && !calibrated->curve.empty()) {
                place.curve = options.calibration->folder / calibrated->curve;
                place.referenceFrequency = calibrated->referenceFrequency;
            }
        }
        assigned.push_back(place);
    }
    return assigned;
}

void requireInput(const std::vector<AssignedChannel>& assigned, double gain)
{
    const bool voltage = std::any_of(assigned.begin(), assigned.end(),
                                     [](const AssignedChannel& a) { return a.quantity == Quantity::voltage; });
    if (!voltage && !(gain > 0))
        throw Error(Error::Kind::usage, "None of the channels is the voltage at the loudspeaker; map it, or give "
                                        "--gain, the volts at the loudspeaker for a "
                                        "played sample of 1.0, to take the plan's.");
    if (voltage && gain > 0)
        throw Error(Error::Kind::usage,
                    "The voltage was recorded, so --gain has nothing to say; leave one of them out.");
    if (std::none_of(assigned.begin(), assigned.end(), [](const AssignedChannel& a) { return a.quantity.has_value(); }))
        throw Error(Error::Kind::usage, "No channel but a loopback is mapped, so there is no take in this recording.");
}

}  // namespace excursion
