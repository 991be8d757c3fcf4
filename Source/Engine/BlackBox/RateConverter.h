// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace excursion {

/// Converts a signal to another rate, sample by sample, for an audio thread. The filter is a sinc under a Kaiser
/// window, read from a table of its phases with linear interpolation. Output k lies exactly at the time of input k
/// from/to, however long it runs. Flat to 0.41 of the lower of the two rates, -90 dB from 0.5 of it on; or, for a
/// listener that knows less, flat to a highest frequency and -90 dB from twice that on (from further up where that
/// would take more than 20 ms). If the rates are equal and the highest frequency leaves nothing out, the signal passes
/// unchanged.
///
/// libsoxr, which resamples records elsewhere in this project, allocates as it runs and delivers output in lumps. An
/// audio thread can use neither.
class RateConverter {
public:
    /// Throws Error (usage) if the rates differ by more than a factor of 16.
    /// @param from, to  Hz, to the thousandth
    /// @param highest   Hz, what the listener knows; what is above is left out
    RateConverter(double from, double to, double highest = std::numeric_limits<double>::infinity());

    /// The delay: number of inputs after an output's time that are needed for it.
    int reach() const { return reach_; }
    void reset();

    void push(double sample);
    /// The next output, if all inputs that it needs have come.
    bool pull(double& out);

private:
    static constexpr int phases = 512;

    std::int64_t from_, to_;  ///< without a common factor
    bool unchanged_ = false;  ///< the signal passes
    int reach_ = 0;
    std::vector<double> table_;  ///< phases + 1 rows of 2 reach_ taps
    std::vector<double> history_;
    std::size_t at_ = 0;
    std::int64_t ahead_ = 0;     ///< inputs since the one at or before the next output
    std::int64_t fraction_ = 0;  ///< time from that input to the output, in 1/to_
};

}  // namespace excursion
