// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Import/ResponseName.h"
#include "Engine/Import/TextTable.h"

#include <optional>
#include <string>
#include <vector>

namespace excursion {

/// One real column of a complex one.
struct ResponseColumn {
    std::string column;  ///< title or number, as TextTable::find
    ResponseName response;
    ResponsePart part = ResponsePart::magnitude;
    std::string unit;  ///< empty: by default, see responseScale
};

/// The columns of a table over frequency.
struct ResponseColumns {
    std::string frequency;
    double frequencyFactor = 1.0;  ///< Hz
    std::vector<ResponseColumn> columns;
    std::vector<std::string> remarks;
};

/// What the titles say, such as "f_hz, u_re_v, u_im_v", "Freq(Hz) Z(Ohms) Phase(degrees)" or "f/Hz, Re(Z), Im(Z)".
/// Where the table holds several curves, each with a frequency of its own, the first is taken.
/// @param as     what a response is whose title does not say it
/// @param guess  the same, from the kind of the file: another response that a title names is believed
/// Throws Error (input) when a title is not understood that must be.
ResponseColumns responseColumnsOf(const TextTable&, const std::optional<ResponseName>& as,
                                  const std::optional<ResponseName>& guess, const std::string& source);

/// Reads the columns and makes complex channels of them. Responses to one quantity become channels beside that
/// quantity, which is 1; with responses to the voltage an impedance becomes the current 1/Z. A line at 0 Hz is left
/// out; lines that repeat the one before exactly are, too.
/// @param phaseless  magnitudes without a phase get the minimum phase that belongs to them (see minimumPhase)
/// Throws Error (input, usage or data) with one sentence.
Spectra spectraOf(const TextTable&, const ResponseColumns&, bool phaseless, const std::string& source);

}  // namespace excursion
