// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>

#include <cmath>
#include <string>

namespace excursion {

/// What it is worth to invert a class, see predistortionOf(). Distortion is the power of what is not the linear
/// part's output, over that.
struct RankedPredistortion {
    double beforeDb = 0.0;  ///< as the model was fitted
    double modelDb = 0.0;   ///< left of it on the model itself
    double leftDb = 0.0;    ///< left of it on the take, with what the model does not explain
    double load = 0.0;  ///< share of a core that predistorting one channel takes, in blocks of 64, at the take's rate
    double latency = 0.0;  ///< s
    std::string trouble;   ///< why it is not inverted, one sentence; the figures then mean nothing
    double gainDb() const { return beforeDb - leftDb; }
};

/// One class of models, fitted to the take and judged on records that it has not seen.
struct RankedModel {
    std::string name;           ///< of modelClasses()
    std::string description;    ///< "order 3, degree 3", "Bl(x), K(x)"
    int parameters = 0;         ///< that the fit moved
    double estimationDb = 0.0;  ///< relative rms error of a simulation [B 4.26]; +infinity: it ran away
    double validationDb = 0.0;  ///< the same; NaN without validation records
    /// core time to simulate over the signal's length; the physical driver's run with half the step, which tells its
    /// accuracy, included
    double load = 0.0;
    double fitSeconds = 0.0;
    bool stable = false;  ///< around rest, and no record made it run away
    /// of the model, with the stimulus of its fit, as `predistort` plays it; null of the linear fractional class
    nlohmann::ordered_json document = nullptr;
    std::string kept;  ///< path of the file that holds it; empty where it was not kept
    double judgedDb() const { return std::isnan(validationDb) ? estimationDb : validationDb; }
    /// a sentence where the class could not be fitted; the figures then mean nothing
    std::string trouble;
    RankedPredistortion predistortion;
};

}  // namespace excursion
