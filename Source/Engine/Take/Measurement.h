// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <complex>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace excursion {

/// What a channel holds. Samples are always in the SI unit of the quantity, except where an
/// electrical analogue gives force or displacement in volts (then Channel::unit is "V").
enum class Quantity { voltage, current, displacement, velocity, acceleration, pressure, force };

inline constexpr std::array quantities {Quantity::voltage,  Quantity::current,      Quantity::displacement,
                                        Quantity::velocity, Quantity::acceleration, Quantity::pressure,
                                        Quantity::force};

std::string_view name(Quantity);    ///< "voltage", as in the files
std::string_view siUnit(Quantity);  ///< "V", "A", "m", "m/s", "m/s^2", "Pa", "N"
std::optional<Quantity> quantityNamed(std::string_view);
std::vector<std::string> quantityNames();

/// How the record was excited. Time runs level by level (quiet to loud), in each level realization by
/// realization, in each realization settlePeriods + periods periods of the same multisine.
struct Excitation {
    int period = 0;  ///< samples of one period
    int settlePeriods = 1;
    int periods = 2;  ///< periods to be used, after the settling ones
    int realizations = 1;
    std::vector<double> levels;            ///< V rms
    std::string grid = "full";             ///< full, odd, odd-odd, odd-random, R10, R20, R40, R80
    std::string shape = "white";           ///< white, pink, red
    double bandLow = 0.0, bandHigh = 0.0;  ///< Hz
    std::vector<int> lines;                ///< excited DFT lines of one period, ascending; empty: not known yet

    int loudest() const { return static_cast<int>(levels.size()) - 1; }
    /// @param wanted  a place in `levels`; below 0: the loudest. Throws Error (usage) when there is no such level.
    int levelOf(int wanted) const;

    int periodsPerRealization() const { return settlePeriods + periods; }
    long samplesPerRealization() const { return static_cast<long>(period) * periodsPerRealization(); }
    long totalSamples() const { return samplesPerRealization() * realizations * static_cast<long>(levels.size()); }
};

struct Channel {
    Quantity quantity = Quantity::voltage;
    std::string unit = "V";
    double fullScale = 1.0;       ///< quantity at a WAV sample of 1.0; reaching it is clipping
    std::vector<double> samples;  ///< in `unit`
    bool assumed = false;         ///< not measured, but what was meant to be played
};

struct DriverInfo {
    std::string name;
    std::optional<double> coneArea;            ///< m^2
    std::optional<double> microphoneDistance;  ///< m
};

/// A take: what was played and what was measured, sampled at the same instants. All channels have
/// the same length.
struct Measurement {
    double sampleRate = 0.0;  ///< Hz
    std::vector<Channel> channels;
    std::optional<Excitation> excitation;  ///< absent: music, noise or someone else's record
    DriverInfo driver;
    /// Hz: corner of the high-pass jf/(jf + corner) that all inputs of the recorder share (Coupling.h); 0: none is
    /// known
    double coupling = 0.0;
    /// sentences: what the reader of a foreign file or a recording had to assume, left out, or doubts
    std::vector<std::string> remarks {};

    std::size_t length() const { return channels.empty() ? 0 : channels.front().samples.size(); }
    /// whether it repeats periods whose excited lines are known
    bool hasPeriods() const { return excitation && !excitation->lines.empty(); }
    /// Excitation::levelOf() of a take with periods. One without has a single level: -1 for it, and an Error (usage)
    /// for others.
    int levelOf(int wanted) const;
    const Channel* find(Quantity) const;     ///< nullptr when absent
    const Channel& channel(Quantity) const;  ///< throws Error (data) when absent
    /// the voltage, or the force of a mechanical-only driver; throws Error (data)
    const Channel& input() const;
};

/// A take that is a frequency response only (ZMA, or spectra of voltage, current and velocity).
struct Spectra {
    struct Channel {
        Quantity quantity = Quantity::voltage;
        std::string unit = "V";
        std::vector<std::complex<double>> values;  ///< one a frequency
    };
    std::vector<double> frequency;  ///< Hz, ascending
    std::vector<Channel> channels;  ///< an impedance is voltage Z against current 1
    DriverInfo driver;
    std::vector<std::string> remarks {};  ///< as of a Measurement

    const Channel* find(Quantity) const;

    /// What the others are responses to: the channel that is 1 at every frequency (the current of an impedance, the
    /// voltage of X/U), else the voltage, else the force; nullptr when there is none of these.
    const Channel* input() const;
};

using Take = std::variant<Measurement, Spectra>;

}  // namespace excursion
