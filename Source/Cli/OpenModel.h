// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Linear/StateSpaceFile.h"

#include <string>

namespace excursion::cli {

/// A linear model of either document, of integer order or in lambda = s^alpha: what reduces and stabilizes models does
/// both alike.
struct OpenModel {
    NamedStateSpace named;  ///< of a fractional one its form in lambda
    double alpha = 1.0;
    bool fractional = false;
};

/// Reads "excursion-state-space" or "excursion-fractional-state-space". Throws Error (input) for anything else.
OpenModel openModel(const std::string& path);

/// The document that it came from.
nlohmann::ordered_json documentOf(const OpenModel&);

bool isStable(const OpenModel&);

}  // namespace excursion::cli
