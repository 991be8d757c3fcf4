// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Check/TakeResponse.h"
#include "Engine/Linear/FrequencyData.h"
#include "Engine/Linear/Stabilization.h"
#include "Engine/Linear/StateSpace.h"
#include "Engine/Progress.h"
#include "Plots/ModelPlots.h"

#include <nlohmann/json_fwd.hpp>

#include <optional>
#include <string>
#include <vector>

namespace excursion::plugin {

// What the page Identify asks for and shows: models that know no physics, of the take that is loaded. All numbers come
// from the layers Linear, Fractional and Polynomial; this puts their verbs one after the other, as `identify`,
// `stabilize`, `reduce` and `pnlss` do.

enum class ModelTime { continuous, discrete, fractionalFree, fractional };

struct IdentifyWish {
    ResponsePorts ports;
    int order = 0;  ///< 0: the best of 1 to 8
    ModelTime time = ModelTime::continuous;
    double alpha = 0.9;     ///< of a given fractional order
    bool unstable = false;  ///< poles may lie beyond the border, in whole orders
};

enum class Reducing { none, pruned, balanced, polesAndZeros };

/// What is made of the model that was identified: first stable, then smaller.
struct ShapeWish {
    std::optional<StabilizingMethod> stabilizing;
    Reducing reducing = Reducing::none;
    int order = 0;  ///< that it is reduced to
};

/// A linear model of a response. It does not change once it is handed out.
struct Identified {
    IdentifyWish asked;
    ShapeWish shape;
    TakeResponse response;  ///< as it was measured
    FrequencyData data;     ///< the same, as it is fitted
    std::string name;       ///< of the take
    StateSpace base;        ///< as it was identified; of fractional order in lambda = s^alpha
    StateSpace model;       ///< as it was shaped
    double alpha = 1.0, alphaStandardError = 0.0;
    double delay = 0.0;  ///< s: the model has the response times exp(-j w delay)
    Frf shown;           ///< its response without that delay, on the measured frequencies
    double errorDb = 0.0;
    bool stable = false;
    std::string sentence;  ///< why this order, and how the shaping ended
    ErrorsByOrder orders;  ///< empty where one order was asked for
};

/// Throws Error as sweepOrders() and sweepFractional() do, (data) without a response.
Identified identifiedOf(const PreparedTake&, const IdentifyWish&, const std::string& name, const Progress& = {});

/// The model as it was identified, shaped in this way. Throws Error as stabilized(), prune(), balanced() and
/// reduceByPolesAndZeros() do.
Identified shapedOf(const Identified&, const ShapeWish&, const Progress& = {});

/// For a person: order, error, alpha, stability; with the sentence behind it.
std::string shortWordsOf(const Identified&);
std::string wordsOf(const Identified&);

/// As `identify --out` writes it.
nlohmann::ordered_json documentOf(const Identified&);

}  // namespace excursion::plugin
