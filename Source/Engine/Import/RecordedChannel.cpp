// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Import/RecordedChannel.h"

#include "Engine/Error.h"

namespace excursion {
namespace {

/// Where a mapping points to. Numbers without a file count through all files.
RecordedChannel locate(const ChannelMapping& mapping, const std::vector<RecordedFile>& files)
{
    const auto refuse = [&](const std::string& why) {
        throw Error(Error::Kind::usage, "--map " + mapping.text + ": " + why);
    };
    RecordedChannel place;
    place.quantity = mapping.quantity;
    auto number = static_cast<std::size_t>(mapping.channel - 1);
    if (!mapping.file.empty()) {
        std::vector<std::size_t> matching;
        for (std::size_t f = 0; f < files.size(); ++f)
            if (const auto& path = files[f].path;
                path == mapping.file || path.filename() == mapping.file || path.stem() == mapping.file)
                matching.push_back(f);
        if (matching.size() != 1)
            refuse(matching.empty()
                       ? "none of the recordings is '" + mapping.file + "'."
                       : "more than one of the recordings is '" + mapping.file + "'; give its whole path.");
        place.file = matching.front();
    } else {
        while (place.file + 1 < files.size() && number >= files[place.file].sound.channels.size())
            number -= files[place.file++].sound.channels.size();
    }
    if (number >= files[place.file].sound.channels.size()) {
        std::size_t all = 0;
        for (const auto& source : files)
            all += source.sound.channels.size();
        const bool one = !mapping.file.empty() || files.size() == 1;
        refuse((one ? "'" + files[place.file].path.string() + "' has "
                          + std::to_string(files[place.file].sound.channels.size())
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
            if (c.quantity)
                mappings.push_back(
                    {"", c.channel, c.quantity, {}, std::to_string(c.channel) + "=" + std::string(name(*c.quantity))});
    if (mappings.empty())
        throw Error(Error::Kind::usage, "A recording does not say what its channels hold; give --map, for example "
                                        "--map 1=voltage:16 --map 2=current:4.");
    return mappings;
}

}  // namespace

std::string labelOf(const RecordedChannel& a, const std::vector<RecordedFile>& files)
{
    return "channel " + std::to_string(a.channel + 1) + " of '" + files[a.file].path.string() + "' ("
           + (a.quantity ? std::string(name(*a.quantity)) : std::string("loopback")) + ")";
}

std::vector<RecordedFile> readFiles(const RecordingOptions& options)
{
    std::vector<RecordedFile> files;
    for (const auto& path : options.files)
        files.push_back({path, readSound(path)});
    return files;
}

std::vector<RecordedChannel> recordedChannels(const RecordingOptions& options, const std::vector<RecordedFile>& files)
{
    std::vector<RecordedChannel> assigned;
    for (const auto& mapping : mappingsOf(options)) {
        auto place = locate(mapping, files);
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
                number += static_cast<int>(files[f].sound.channels.size());
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
            if (calibrated && !calibrated->curve.empty()) {
                place.curve = options.calibration->folder / calibrated->curve;
                place.referenceFrequency = calibrated->referenceFrequency;
            }
        }
        assigned.push_back(place);
    }
    return assigned;
}

}  // namespace excursion
