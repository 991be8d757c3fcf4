// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Document/JsonField.h"
#include "Engine/Linear/StateSpace.h"

#include <nlohmann/json_fwd.hpp>

namespace excursion {

/// A linear model with the names of what it connects, as the document "excursion-state-space" 1 keeps it.
struct NamedStateSpace {
    std::string name;
    std::vector<std::string> inputs, outputs;  ///< quantities, "voltage"
    StateSpace model;
    /// s: the model has the response times exp(-j w delay); see Stabilization.h
    double delay = 0.0;
};

nlohmann::ordered_json toJson(const NamedStateSpace&);

/// Throws Error (input) naming the field when the document is none of these, or its shapes do not fit.
NamedStateSpace stateSpaceFromJson(const JsonField&);

/// A matrix as a list of rows; with no columns each row is an empty list.
nlohmann::ordered_json matrixJson(const Eigen::MatrixXd&);
Eigen::MatrixXd matrixFrom(const JsonField&, Eigen::Index rows, Eigen::Index columns);

}  // namespace excursion
