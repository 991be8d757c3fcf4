// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include <functional>
#include <optional>
#include <string>

namespace excursion::cli {

/// A model of one input and one output that knows no physics, read from its document, in discrete time.
struct PlayedDocument {
    std::string input, output;                                    ///< quantities, "voltage"
    double sampleRate = 0.0;                                      ///< Hz, the only one at which it plays
    std::function<Eigen::MatrixXd(const Eigen::MatrixXd&)> play;  ///< N x 1 to N x 1, from rest
};

/// Reads a linear state space, a parallel Hammerstein, block, NARX or polynomial state-space model; none for another
/// document. Throws Error (input) for one that is broken, (data) for one of several inputs or outputs or of continuous
/// time.
std::optional<PlayedDocument> playedDocument(const std::string& path);

}  // namespace excursion::cli
