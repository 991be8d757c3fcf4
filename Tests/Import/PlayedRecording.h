// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Import/ImportRecording.h"
#include "Engine/Take/WavFile.h"
#include "Import/FaultSimulator.h"
#include "Scratch.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

namespace excursion::test {

inline const Played& smallPlay()
{
    static const Played played = play({});
    return played;
}

inline std::filesystem::path save(const Scratch& scratch, const std::string& name, const Recorded& recorded)
{
    writeWav(scratch / name, static_cast<int>(recorded.sampleRate), recorded.channels, SampleFormat::float32);
    return scratch / name;
}

inline RecordingOptions optionsFor(const Played& played, std::vector<std::filesystem::path> files,
                                   const std::vector<std::string>& map)
{
    RecordingOptions options;
    options.files = std::move(files);
    options.plan = played.plan;
    for (const auto& mapping : map)
        options.map.push_back(parseChannelMapping(mapping));
    return options;
}

struct Likeness {
    double late = 0.0, gain = 0.0, left = 0.0;  ///< samples; ratio; rms of what is left over rms of the signal
};

/// How a channel of a take differs from what was played, by least squares: y = g x - g d x'.
inline Likeness against(const std::vector<double>& y, const std::vector<double>& truth, std::size_t lead,
                        std::size_t from, std::size_t to)
{
    double xx = 0, xd = 0, dd = 0, yx = 0, yd = 0, yy = 0;
    for (auto n = from; n < to; ++n) {
        const auto at = 2 * (n + lead);
        const double x = truth[at], d = truth[at + 1] - truth[at - 1];
        xx += x * x;
        xd += x * d;
        dd += d * d;
        yx += y[n] * x;
        yd += y[n] * d;
        yy += y[n] * y[n];
    }
    const double determinant = xx * dd - xd * xd, g = (yx * dd - yd * xd) / determinant,
                 s = (yd * xx - yx * xd) / determinant;
    return {-s / g, g, std::sqrt(std::max(0.0, yy - g * yx - s * yd) / yy)};
}

}  // namespace excursion::test
