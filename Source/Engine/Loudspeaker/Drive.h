// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace excursion {

/// A voltage (or force) record, upsampled to give steps the band-limited input between the samples.
class Drive {
public:
    /// @param samples     V (or N), starting from silence
    /// @param sampleRate  Hz
    /// @param substeps    integration steps per sample
    Drive(std::span<const double> samples, double sampleRate, int substeps);

    std::size_t length() const { return length_; }  ///< samples
    int substeps() const { return substeps_; }
    double step() const { return step_; }  ///< s
    double at(std::size_t halfStep) const { return halfStep < fine_.size() ? fine_[halfStep] : 0.0; }

    /// Coefficients of the input on the step that starts there, u(s) = sum u_k s^k, 0 <= s <= 1: the polynomial through
    /// the values at half steps from one step before to one step after it. Beyond the ends the record has odd
    /// reflection, as in upsample().
    std::array<double, 7> polynomial(std::size_t halfStep) const;

private:
    std::size_t length_;
    int substeps_;
    double step_;
    std::vector<double> fine_;  // two values per step
};

}  // namespace excursion
