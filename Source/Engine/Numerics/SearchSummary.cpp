// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Numerics/SearchSummary.h"

namespace excursion {

const char* sentenceFor(Termination termination)
{
    switch (termination) {
    case Termination::notRun: break;
    case Termination::nothingFree: return "no parameter is free";
    case Termination::startUndefined: return "the model cannot be computed at its start";
    case Termination::brokeDown: return "the search broke down";
    case Termination::maximumIterations: return "the largest number of iterations was reached";
    case Termination::noSlopes: return "the derivatives gave out on the way";
    case Termination::notAsked: return "no refinement was asked for";
    case Termination::severalInputs: return "models with several inputs are not refined";
    case Termination::undetermined: return "the error does not tell what was searched for";
    case Termination::costSettled: return "the error no longer falls";
    case Termination::noBetterStep: return "no step lowers the error any further";
    case Termination::valuesSettled: return "the steps have become too small to matter";
    case Termination::rounding: return "the error is no more than rounding";
    case Termination::atBound: return "the lowest error lies at an end of the range that was searched";
    case Termination::validationSettled: return "the validation error no longer falls";
    case Termination::solvedAtOnce: return "all that was unknown was solved for at once";
    }
    return "the search was not run";
}

void SearchSummary::end(Termination why, const std::string& detail)
{
    termination = why;
    message = sentenceFor(why);
    if (!detail.empty())
        message += ": " + detail;
}

bool SearchSummary::usable() const { return termination >= Termination::maximumIterations; }

bool SearchSummary::converged() const { return termination >= Termination::costSettled; }

}  // namespace excursion
