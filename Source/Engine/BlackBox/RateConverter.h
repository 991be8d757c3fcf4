// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace excursion {

/// A signal at another rate, sample by sample, for an audio thread: the sinc under a Kaiser window, read from a table
/// of its phases with linear interpolation between them. Output k lies at the time of input k from/to, exactly, however
/// long it runs. Flat to 0.41 of the lower of the two rates, -90 dB from 0.5 of it on. Of equal rates the signal goes
/// through as it is.
///
/// libsoxr, which resamples records here, allocates as it runs and gives out what it has in lumps; an audio thread
/// needs neither.
class RateConverter {
public:
    RateConverter(double from,
                  double to);  ///< Hz, to the thousandth; Error (usage) where they differ by more than 16 times

    /// Inputs beyond an output's time that have to be there before it comes: the delay.
    int reach() const { return reach_; }
    void reset();

    void push(double sample);
    /// The next output, where all inputs that it needs are there.
    bool pull(double& out);

private:
    static constexpr int phases = 512;

    std::int64_t from_, to_;  ///< without a common factor
    int reach_ = 0;
    std::vector<double> table_;  ///< phases + 1 rows of 2 reach_ taps
    std::vector<double> history_;
    std::size_t at_ = 0;
    std::int64_t ahead_ = 0;     ///< inputs that came since the one at or before the next output
    std::int64_t fraction_ = 0;  ///< of it, in 1/to_
};

}  // namespace excursion
