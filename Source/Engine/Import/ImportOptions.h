// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Import/ResponseColumns.h"
#include "Engine/Take/Measurement.h"

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace excursion {

/// Which column of a CSV, or variable of a MAT file, holds which quantity.
struct ColumnQuantity {
    std::string column;
    Quantity quantity = Quantity::voltage;
    std::string unit;  ///< as in the file; empty: the SI unit
};

/// Which column is the frequency or the time.
struct AxisColumn {
    std::string column;
    double factor = 1.0;  ///< to Hz or s
    bool isTime = false;
};

struct ImportOptions {
    std::vector<ColumnQuantity> columns;    ///< of time signals; empty: the names in the file say it
    std::vector<ResponseColumn> responses;  ///< of a table over frequency; empty: the titles in the file say it
    std::optional<AxisColumn> axis;         ///< absent: the titles in the file say it
    std::optional<ResponseName> as;         ///< what a response is whose title does not say it
    bool minimumPhase = false;              ///< a magnitude without a phase gets its minimum phase
    double sampleRate = 0.0;                ///< Hz; 0: from the file
    std::size_t from = 0;                   ///< first sample to take
    std::optional<std::size_t> to;          ///< one beyond the last; absent: to the end
    bool removeMean = false;                ///< of each channel, over the samples taken
};

/// What a column name such as "voltage", "current [A]", "displacement_mm", "i" or "u (mV)" says.
/// The short names are u (voltage), i, x, a, p, and v, which is a velocity or, in volts, a voltage.
/// The unit is that of the name, or empty. nullopt when the name is not understood.
std::optional<ColumnQuantity> columnNamed(std::string_view);

/// "V1=force:V" or "I=current": one mapping of a command line. Throws Error (usage).
ColumnQuantity parseColumnQuantity(std::string_view);

/// Any mapping of a command line, COLUMN=WHAT or COLUMN=WHAT:UNIT: a quantity, "time", "frequency", or a part of a
/// response such as "G_re=impedance.re", "2=displacement/voltage.magnitude:mm/V", "3=pressure/voltage.dB:dBSPL",
/// "4=impedance.phase:rad". A column is told by its title, else by its number from 1. Throws Error (usage).
void addMapping(ImportOptions&, std::string_view);

/// The sample rate in Hz of times that run evenly, to 1 % of a step. Throws Error (data) naming `source`.
/// @param unit  s for each unit of the times
double sampleRateOf(const std::vector<double>& times, double unit, const std::string& source);

/// Makes a take of raw columns: takes the range, scales to SI, removes means, sets full scales a tenth
/// above the peaks or more (powers of two). Throws Error (input, usage or data) naming `source`.
/// @param samples  one vector a column, in the file's units
Measurement measurementOfColumns(const std::vector<ColumnQuantity>& columns,
                                 const std::vector<std::vector<double>>& samples, double sampleRate,
                                 const ImportOptions&, const std::string& source);

}  // namespace excursion
