// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Take/Measurement.h"

#include <nlohmann/json_fwd.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace excursion {

/// How a sensor turns its quantity into volts: "50 mV/Pa", "10.2 mV/g", "1 V/mm", "0.1 V/A".
struct Sensitivity {
    double value = 0.0;
    std::string unit;  ///< "mV/Pa"

    /// V per SI unit of the quantity. Throws Error (input) naming `source` when the unit is not one of volts over one
    /// of the quantity's.
    double voltsPer(Quantity, const std::string& source) const;
};

/// Reads "50mV/Pa"; throws Error (usage).
Sensitivity parseSensitivity(std::string_view);

/// One input of a converter, and what is connected to it.
struct ChannelCalibration {
    int channel = 1;  ///< of the converter, from 1
    std::optional<Quantity> quantity;
    double fullScale = 1.0;               ///< at a sample of 1.0: V at the input, or the quantity itself
    std::string unit = "V";               ///< of fullScale
    std::optional<double> relativeError;  ///< standard error of fullScale over it
    double referenceFrequency = 1000.0;   ///< Hz, where it holds, when there is a curve
    bool inverted = false;
    std::optional<double> divider;        ///< voltage at the loudspeaker over that at the input, 1 or more
    std::optional<double> senseResistor;  ///< ohm: the current flows through it, its voltage is recorded
    std::optional<Sensitivity> sensitivity;
    std::optional<double> preampGainDb;
    double latency = 0.0;  ///< s, by which the sensor is late, 0 to 1
    /// file of a microphone's response, beside the calibration; empty: none
    std::string curve;

    /// What a sample of 1.0 stands for, in the quantity's SI unit; negative when inverted. With U = fullScale
    /// 10^(-preampGainDb/20) where its unit is V:
    ///     voltage U divider,  current U/senseResistor or U/sensitivity,  others U/sensitivity
    /// and fullScale itself where its unit is one of the quantity's (which for a voltage is V).
    /// Throws Error (input) naming `source` when something is missing or contradicts itself.
    double quantityAtFullScale(Quantity, const std::string& source) const;
};

/// The inputs of a converter, for all recordings made with it.
struct Calibration {
    std::vector<ChannelCalibration> channels;  ///< each channel once, ascending
    std::filesystem::path folder;              ///< where the curves are

    const ChannelCalibration* find(int channel) const;
    void put(const ChannelCalibration&);  ///< in the place of what was known of that channel
};

/// Format "excursion-calibration", version 1. Throws Error (input).
Calibration readCalibration(const std::filesystem::path&);
nlohmann::ordered_json calibrationJson(const Calibration&);

}  // namespace excursion
