// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

namespace excursion {

/// What a WAV, or another file of uncompressed or losslessly compressed sound, holds: sample values, full scale 1.0,
/// one vector a channel, all of the same length.
struct Wav {
    int sampleRate = 0;  ///< Hz; a WAV has whole ones only
    std::vector<std::vector<double>> channels;
};

/// Reads a WAV (RIFF or RF64; PCM or float) by libsndfile. Throws Error (input) when it is not one, holds no
/// samples, or its header claims more than the file has; that is checked before memory is taken.
/// Samples that are not finite are returned as they are.
Wav readWav(const std::filesystem::path&);

/// Throws Error (input) when a sample of channel c, counted from 0, is not a finite number.
void requireFinite(const Wav&, std::size_t c, const std::filesystem::path&);

/// As readWav, and AIFF, CAF and FLAC as well. What a FLAC claims is not believed before it has been read.
Wav readSound(const std::filesystem::path&);

enum class SampleFormat { float32, float64 };

/// Writes a WAV at that very path (see DraftFile). Same samples, same bytes. Throws Error (input).
void writeWav(const std::filesystem::path&, int sampleRate, std::span<const std::vector<double>> channels,
              SampleFormat);

}  // namespace excursion
