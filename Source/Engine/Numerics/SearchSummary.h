// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace excursion {

/// Why a search ended. The order is that of the three groups that converged() and usable() tell apart.
enum class Termination {
    // It failed: what it returns is its start, nothing, or how far it had come.
    notRun,          ///< nobody ran it; the default
    nothingFree,     ///< no parameter may move
    startUndefined,  ///< the model cannot be computed at its start
    brokeDown,       ///< the arithmetic gave out; `message` may tell more

    // It came to something that is at least as good as its start, and might have come further.
    maximumIterations,
    noSlopes,       ///< the best step leads to a place without finite derivatives: the search ended before it
    notAsked,       ///< options say that nothing is refined
    severalInputs,  ///< the refinement knows models with one input only
    undetermined,   ///< what is searched for does not show in the error

    // It found what it was looking for.
    costSettled,        ///< accepted steps hardly lower the error
    noBetterStep,       ///< no step lowers it at all
    valuesSettled,      ///< steps are too small to matter
    rounding,           ///< the error is that of the arithmetic
    atBound,            ///< the lowest error lies at an end of the range that was searched
    validationSettled,  ///< the error on records that were held out no longer falls
    solvedAtOnce        ///< all that was unknown could be solved for
};

/// A clause without a full stop, such as "the error no longer falls".
const char* sentenceFor(Termination);

/// How a search ended. The default is failure. What a search returns is derived from it, or holds it where the search
/// is a part of the work.
struct SearchSummary {
    Termination termination = Termination::notRun;
    int iterations = 0;
    double initialCost = 0.0, finalCost = 0.0;  ///< sum of squares, in the unit of the problem
    std::string message = sentenceFor(Termination::notRun);

    /// Sets termination and message. @param detail  follows a colon
    void end(Termination, const std::string& detail = {});

    bool usable() const;     ///< what it returns is at least as good as its start
    bool converged() const;  ///< and going on would gain nothing
};

}  // namespace excursion
