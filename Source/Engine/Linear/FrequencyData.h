// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Error.h"
#include "Engine/Estimate/Frf.h"

#include <Eigen/Core>

#include <string>
#include <vector>

namespace excursion {

/// The frequency response matrix of p outputs by m inputs on K frequencies, as the identification takes it.
/// Column e = o + p i belongs to output o and input i.
struct FrequencyData {
    std::vector<double> frequency;  ///< Hz, ascending, at least 0
    Eigen::MatrixXcd value;         ///< K x p m, output unit / input unit
    /// K x p m, standard deviation of the complex value; empty: not known, taken as equal on all lines
    Eigen::MatrixXd deviation;
    Eigen::Index outputs = 1, inputs = 1;

    Eigen::Index lines() const { return value.rows(); }

    /// @param reason  where not null: one sentence that says what is wrong
    bool isValid(std::string* reason = nullptr) const;
};

/// Of one frequency response. The deviation is the square root of the total variance, else of the noise variance, else
/// empty. Of a few realizations a line's variance is told so roughly that neighbouring lines share theirs: the more
/// they scatter from line to line the more lines do, about 36 for two realizations, 18 for three; what sticks out from
/// them keeps a sixth of its own at least. Variances of zero, which a short record can show by chance, count as the
/// smallest one above zero.
FrequencyData frequencyDataOf(const Frf&);

/// The weights 1/deviation (K x p m), scaled so that they are dimensionless: the largest weight of each entry times its
/// rms response is 1. Without deviations 1 over the rms response. So neither units nor the level of the noise enter a
/// numerical decision.
Eigen::MatrixXd weightsOf(const FrequencyData&);

/// Before a fit to a frequency response. Throws Error: usage for options that are not valid, data for responses.
/// @param refusal  what a sentence begins with: "A delay cannot be fitted"
template <class Options>
void requireFitting(const Options& options, const FrequencyData& data, const std::string& refusal)
{
    std::string reason;
    if (!options.isValid(&reason))
        throw Error(Error::Kind::usage, refusal + ": " + reason + ".");
    if (!data.isValid(&reason))
        throw Error(Error::Kind::data, refusal + ": " + reason + ".");
}

}  // namespace excursion
