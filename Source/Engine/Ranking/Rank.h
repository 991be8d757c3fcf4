// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Check/PreparedTake.h"
#include "Engine/Progress.h"
#include "Engine/Ranking/RankedModel.h"
#include "Engine/Take/Measurement.h"

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

struct Ranking {
    std::string take;  ///< its path; empty where nobody has told
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

/// Of models in the order of their errors the one that explains most: a tenth of a decibel is no reason, so of the
/// stable ones within half a decibel of the best stable one that with the fewest parameters. Null if none is stable.
const RankedModel* explainingMost(const std::vector<RankedModel>&);

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
