// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Import/ImportRecording.h"

#include "Engine/Error.h"
#include "Engine/Import/RecordingAssembly.h"
#include "Engine/Signal/Level.h"

#include <cmath>

namespace excursion {
namespace {

std::vector<RecordingSource> readSources(const RecordingOptions& options)
{
    std::vector<RecordingSource> sources;
    for (const auto& path : options.files)
        sources.push_back({path, readSound(path)});
    for (const auto& recorded : options.sounds)
        sources.push_back({recorded.name, recorded.sound});
    return sources;
}

std::vector<RecordingShape> shapesOf(const std::vector<RecordingSource>& sources)
{
    std::vector<RecordingShape> shapes;
    for (const auto& source : sources)
        shapes.push_back({source.path, source.sound.channels.size()});
    return shapes;
}

/// One file as it is: nothing is known of what was played.
ImportedRecording asRecorded(const RecordingOptions& options, const std::vector<RecordingSource>& sources,
                             const std::vector<AssignedChannel>& assigned)
{
    if (sources.size() > 1)
        throw Error(Error::Kind::usage,
                    "Several recordings can only be laid beside one another by what was played; give its --plan.");
    if (options.gain > 0)
        throw Error(Error::Kind::usage, "--gain takes the voltage from a plan; give the --plan that was played.");
    const auto& source = sources.front();
    const auto length = source.sound.channels.front().size(), to = options.to.value_or(length);
    if (to > length || options.from >= to)
        throw Error(Error::Kind::usage, "'" + source.path.string() + "' has " + std::to_string(length)
                                            + " samples a channel, so samples " + std::to_string(options.from) + " to "
                                            + std::to_string(to) + " cannot be taken.");
    ImportedRecording result;
    result.take.sampleRate = source.sound.sampleRate;
    for (const auto& a : assigned) {
        if (!a.quantity)
            throw Error(Error::Kind::usage, "A loopback tells nothing without the --plan that was played.");
        if (!a.curve.empty() || a.latency > 0.0)
            throw Error(Error::Kind::usage, "The curve and the latency of a sensor are taken off where a --plan was "
                                            "played; leave them out for this recording.");
        Channel channel {*a.quantity, std::string(siUnit(*a.quantity)), std::abs(a.factor), {}};
        const auto& x = source.sound.channels[a.channel];
        channel.samples.assign(x.begin() + static_cast<std::ptrdiff_t>(options.from),
                               x.begin() + static_cast<std::ptrdiff_t>(to));
        for (double& value : channel.samples)
            value *= a.factor;
        result.take.channels.push_back(std::move(channel));
    }
    result.take.input();
    ImportedFile file;
    file.name = source.path.string();
    file.sampleRate = source.sound.sampleRate;
    file.seconds = static_cast<double>(length) / file.sampleRate;
    result.files.push_back(std::move(file));
    result.remarks.emplace_back(
        "No plan was given, so the recording was taken as it is, without looking for what was played.");
    return result;
}

}  // namespace

ImportedRecording importRecording(const RecordingOptions& options, const Progress& progress)
{
    if (options.files.empty() && options.sounds.empty())
        throw Error(Error::Kind::usage, "Give a recording.");
    const auto sources = readSources(options);
    const auto assigned = assignChannels(options, shapesOf(sources));
    for (const auto& a : assigned)
        requireFinite(sources[a.file].sound, a.channel, sources[a.file].path);
    auto imported = options.plan ? assembleRecording(options, sources, assigned, progress)
                                 : asRecorded(options, sources, assigned);
    for (const auto& channel : imported.take.channels)
        if (!isMeasurable(channel.samples))
            throw Error(Error::Kind::input, "The recording has samples for the " + std::string(name(channel.quantity))
                                                + " that are beyond any measurement; it is damaged, or in another "
                                                  "unit.");
    return imported;
}

}  // namespace excursion
