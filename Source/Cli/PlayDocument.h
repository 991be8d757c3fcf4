// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include <functional>
#include <optional>
#include <string>

namespace excursion::cli {

/// A model of one input and one output that knows no physics, read from its document.
struct PlayedDocument {
    std::string input, output;  ///< quantities, "voltage"
    double sampleRate = 0.0;    ///< Hz, the only one at which it plays; 0: any
    /// N x 1 to N x 1, from rest, at a sample rate
    std::function<Eigen::MatrixXd(const Eigen::MatrixXd&, double sampleRate)> play;
};

/// Reads a linear state space of whole or fractional order, a parallel Hammerstein, block, NARX or polynomial
/// state-space model or a Volterra series; none for another document. Of a fractional model the integrators are ladders
/// from a tenth of the slowest frequency in the record to its sample rate. Throws Error (input) for one that is broken,
/// (data) for one of several inputs or outputs or of continuous time.
std::optional<PlayedDocument> playedDocument(const std::string& path);

}  // namespace excursion::cli
