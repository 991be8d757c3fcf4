// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Document/JsonField.h"
#include "Engine/Ranking/Agreement.h"

#include <nlohmann/json.hpp>

#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace excursion {

/// A polynomial state space, of whole or fractional order, fitted to a take or judged on it.
struct PolynomialFit {
    std::string take;                                                ///< its path
    double estimationDb = 0.0;                                       ///< relative rms error of a simulation [B 4.26]
    double validationDb = std::numeric_limits<double>::quiet_NaN();  ///< the same; NaN without records for it
    std::optional<double> noiseDb;                                   ///< of the output; empty: not known
    std::string noiseFrom;                                           ///< "periods" or "residual"; empty with it
    std::optional<bool> arrived;  ///< whether the error is at the noise; empty: that cannot be told
    std::string advice;           ///< what to try where it is not; may be empty
    int iterations = 0;
    std::string stopped;  ///< why the search ended, a clause
    bool stable = false;
    std::vector<double> history;  ///< dB, the error after each step that was taken
    std::optional<AgreedLaws> laws;
    nlohmann::ordered_json model;  ///< its document
};

/// The document "excursion-pnlss-fit" 1 (Docs/Formats.md).
nlohmann::ordered_json toJson(const PolynomialFit&);
PolynomialFit polynomialFitFromJson(const JsonField&);

}  // namespace excursion
