// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Diagnosis/Compare.h"
#include "Engine/Diagnosis/Diagnosis.h"

#include <algorithm>
#include <string>
#include <vector>

namespace excursion {

/// What of a mean squared residual is not noise; never quite zero, as two models at the noise are equally good.
class Excess {
public:
    explicit Excess(const Comparison& comparison)
        : noiseKnown_(comparison.noiseKnown), least_(isNoise(comparison) ? 0.02 : 0.002)
    {
    }
    double operator()(double chiSquaredPerValue) const
    {
        return noiseKnown_ ? std::max(chiSquaredPerValue - 1.0, least_) : std::max(chiSquaredPerValue, 1e-12);
    }

private:
    bool noiseKnown_;
    double least_;
};

/// Those that cannot be it, as they do not pay or have been bent to stand for something else, come behind those that
/// can. Of these the ones come first that the catalogue as a whole speaks for, as others may only borrow what belongs
/// to one that is not in yet; unless another leaves far less: several that explain the same have little each that is
/// theirs alone, and one of them is there.
void putInOrder(std::vector<RankedEffect>&, const Excess&);

/// Confidence of the tried effects: the first is sure when it explains at least half of the excess and the second
/// leaves much more.
/// @param chiSquaredPerValue  before any of them
/// @param diagnosis  is told which it cannot tell apart
void judge(std::vector<RankedEffect>&, double chiSquaredPerValue, const Excess&, Diagnosis& diagnosis);

/// Whether something that cannot be it does far better than the first: then it is not the first whose shape is missing.
bool outdone(const std::vector<RankedEffect>&, const Excess&);

/// The verdict once the ranking is made.
/// @param smallestShare  of what is not noise that the first must explain
Verdict verdictOf(const std::vector<RankedEffect>&, const Comparison&, double smallestShare);

/// The verdict of a diagnosis in words, with the effects that it cannot tell apart.
std::string sentenceFor(const Diagnosis&);

}  // namespace excursion
