// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Signal/Fft.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>
#include <string>
#include <vector>

namespace excursion {

/// Random numbers that are the same everywhere.
class Draw {
public:
    explicit Draw(unsigned seed) : random_(seed) {}
    double within(double least, double most)
    {
        return least + (most - least) * static_cast<double>(random_() >> 11) * 0x1p-53;
    }

private:
    std::mt19937_64 random_;
};

/// Noise that falls by 3 dB an octave from 10 Hz on, of rms 1: white noise through low-passes of first order, one each
/// two octaves.
inline std::vector<double> pinkNoise(Draw& draw, std::size_t length)
{
    std::vector<double> sum(length, 0.0);
    for (double corner = 2e-4; corner < 0.5; corner *= 4.0) {
        const double share = 1.0 - std::exp(-2.0 * std::numbers::pi * corner), gain = 1.0 / std::sqrt(corner);
        double low = 0.0;
        for (auto& sample : sum) {
            low += share * (draw.within(-1.0, 1.0) - low);
            sample += gain * low;
        }
    }
    double power = 0.0;
    for (const double sample : sum)
        power += sample * sample;
    for (auto& sample : sum)
        sample /= std::sqrt(power / static_cast<double>(length));
    return sum;
}

struct Programme {
    std::string name;
    std::vector<double> samples;  ///< peaks about 1 to 2; the first 5 ms are silent
    bool repeats = false;         ///< within a second
};

/// Something that is played: a tone, noise, bursts, a square wave, 5 Hz, steps, drums with noise, two tones.
inline Programme drawnProgramme(Draw& draw, double resonance, double rate, double seconds)
{
    Programme programme;
    auto& out = programme.samples;
    out.resize(static_cast<std::size_t>(seconds * rate));
    const auto kind = static_cast<int>(draw.within(0.0, 7.999));
    const double f = resonance * std::exp(draw.within(-1.5, 2.0)), pause = draw.within(0.2, 0.7),
                 step = draw.within(0.1, 0.4) * seconds;
    const auto tone = [](double frequency, double t) { return std::sin(2.0 * std::numbers::pi * frequency * t); };
    const auto noise = pinkNoise(draw, out.size());
    static const char* const names[] {"tone", "pink noise", "bursts", "square wave",
                                      "5 Hz", "steps",      "drums",  "two tones"};
    programme.name = names[kind];
    programme.repeats = kind != 1 && kind != 5 && kind != 6;
    for (auto n = static_cast<std::size_t>(0.005 * rate); n < out.size(); ++n) {
        const double t = static_cast<double>(n) / rate;
        switch (kind) {
        case 0: out[n] = tone(f, t); break;
        case 1: out[n] = 0.5 * noise[n]; break;
        case 2: out[n] = std::fmod(t, pause) < 0.3 * pause ? tone(f, t) : 0.0; break;
        case 3: out[n] = tone(0.5 * f, t) > 0.0 ? 1.0 : -1.0; break;
        case 4: out[n] = tone(5.0, t); break;
        case 5: out[n] = std::fmod(t, 2.0 * step) > step ? 1.0 : -0.3; break;
        case 6:
            out[n] = 0.5 * noise[n] * std::exp(-8.0 * std::fmod(t, 0.7 * pause))
                     + 0.7 * tone(1.1 * resonance, t) * std::exp(-6.0 * std::fmod(t, pause));
            break;
        default: out[n] = 0.6 * tone(f, t) + 0.4 * tone(11.3 * f, t); break;
        }
    }
    return programme;
}

/// Mean square of what a signal, faded in and out over a quarter of a second at most, has above a frequency.
inline double powerAbove(double frequency, const std::vector<double>& signal, double rate)
{
    auto faded = signal;
    const auto fade = std::min(signal.size() / 2, static_cast<std::size_t>(0.25 * rate));
    for (std::size_t n = 0; n < fade; ++n) {
        const double share = 0.5
                             - 0.5 * std::cos(std::numbers::pi * static_cast<double>(n) / static_cast<double>(fade));
        faded[n] *= share * share;
        faded[faded.size() - 1 - n] *= share * share;
    }
    const auto spectrum = fft(faded);
    const auto length = static_cast<double>(signal.size());
    double sum = 0.0;
    for (std::size_t k = 0; k < signal.size() / 2; ++k)
        if (static_cast<double>(k) * rate / length > frequency)
            sum += 2.0 * std::norm(spectrum[k]);
    return sum / (length * length);
}

}  // namespace excursion
