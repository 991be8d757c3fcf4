// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Check/PreparedTake.h"
#include "Engine/Polynomial/TakeRecords.h"
#include "Engine/Progress.h"

#include <nlohmann/json.hpp>

#include <optional>
#include <string>
#include <vector>

namespace excursion {

struct RankOptions {
    std::optional<Quantity> output;    ///< the channel to explain; empty: the first beside the input
    int level = -1;                    ///< index into Excitation::levels; below 0: the last
    int order = 0;                     ///< states of the polynomial models; 0: as the linear model has, at most 4
    int degree = 3;                    ///< of monomials and powers
    int iterations = 30;               ///< of each search in the time domain, at most
    std::vector<std::string> classes;  ///< names of modelClasses(); empty: all

    bool isValid(std::string* reason = nullptr) const;
};

/// What it is worth to turn a class around, see linearizationOf(). Distortion is the power of what is not the linear
/// part's output, over that.
struct RankedLinearization {
    double beforeDb = 0.0;  ///< as the model was fitted
    double modelDb = 0.0;   ///< left of it on the model itself
    double leftDb = 0.0;    ///< left of it on the take, with what the model does not explain
    double load = 0.0;  ///< share of a core that predistorting one channel takes, in blocks of 64, at the take's rate
    double latency = 0.0;  ///< s
    std::string trouble;   ///< why it is not turned around, one sentence; the figures then mean nothing
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
    /// a sentence where the class could not be fitted; the figures then mean nothing
    std::string trouble;
    RankedLinearization linearization;
};

struct Ranking {
    Quantity input = Quantity::voltage, output = Quantity::current;
    /// noise of the judged records relative to the output, where periods tell it: the floor of every error
    std::optional<double> noiseDb;
    /// by ascending error on the validation records (without any: on the estimation records), troubled ones last
    std::vector<RankedModel> models;
    std::string best;              ///< the class that explains most; empty: none is stable
    std::string sentence;          ///< which one explains most, and what its peers lack
    std::string straightest;       ///< the class that leaves least distortion on the take; empty: none takes 3 dB away
    std::string straightSentence;  ///< which one it is, what it leaves, load and latency; or that there is none
};

struct ModelClass {
    std::string name;
    std::string sentence;  ///< what it is
};

/// "linear", "fractional", "hammerstein", "block", "narx", "pnlss", "fractional-pnlss", "driver" (linear, physical),
/// "driver-with-effects" (as `improve` leaves it).
const std::vector<ModelClass>& modelClasses();

/// All classes on the same records of one take (recordsOf), errors by simulation. The physical driver is fitted to all
/// channels and levels of the take, as always; the others see the one channel and level alone. Throws Error (usage) for
/// options, (data) for a take without the channel or too short to be cut.
Ranking rank(const PreparedTake&, const RankOptions& = {}, const Progress& = {});

}  // namespace excursion
