// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Cli/OpenResponse.h"
#include "Cli/Terminal.h"

#include "Engine/Polynomial/Pnlss/PnlssFit.h"
#include "Engine/Polynomial/TakeRecords.h"

#include <nlohmann/json.hpp>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace excursion::cli {

struct PnlssArguments {
    ResponseChoice response;
    std::string model, start, out, played, volterra, mask = "full", terms, alpha;
    std::vector<int> memory {1024, 128, 24};  ///< samples of the Volterra kernels of order 1, 2, 3
    int order = 0, degree = 3, iterations = 50;
    bool noOutputTerms = false, offset = false, mixed = false, laws = false;
    bool chosenTerms = false;  ///< --degree, --mask, --terms or --offset was given
};

/// What the two kinds of polynomial models tell alike.
struct PnlssOutcome {
    /// error of the linear part alone, on the validation records where there are any; not of a model that was kept
    double startDb = 0.0;
    double estimationDb = 0.0, validationDb = 0.0;
    bool stable = false;
    SearchSummary search;  ///< not of a model that was kept
    std::vector<double> history;
    std::string alpha;                                                  ///< in words; empty for integer order
    nlohmann::ordered_json model;                                       ///< its document
    std::function<Eigen::MatrixXd(const Eigen::MatrixXd& input)> play;  ///< the output from rest
    /// of a take without periods: what is left that the input does not tell
    std::optional<UntoldNoise> untold {};
    Eigen::Index parameters = 0;  ///< that the fit moved; not of a model that was kept
    double constantShare = 0.0;   ///< of a fit, see constantShareOf()
};

/// A take with what is to be explained by what.
struct PnlssTake {
    Measurement take;
    const Channel* input = nullptr;
    const Channel* output = nullptr;
    InputOutputRecords records;

    Eigen::MatrixXd wholeInput() const;
    bool periodic() const { return take.hasPeriods(); }
};

/// Whether a fit came as far as the noise lets it, and what to try where it did not.
struct Arrival {
    std::optional<double> noiseDb;  ///< dB of the output; empty: not known
    const char* noiseFrom = "";     ///< "periods", "residual"
    std::optional<bool> arrived;    ///< empty: that cannot be told
    std::string sentence, advice;   ///< no advice where it arrived
};

Arrival arrivalOf(const PnlssArguments&, const PnlssTake&, const PnlssOutcome&);

/// Of the power that a start leaves of the records, the share of a constant, which no model without the monomial 1
/// follows; 0 of a model that has it. @param played  what the start plays, one a record
double constantShareOf(const Exponents&, const std::vector<InputOutputRecord>&,
                       const std::vector<Eigen::MatrixXd>& played);

TermMask maskNamed(const std::string&);

/// Where a fit sets out: the model of --start, or linear ones that are identified from the take.
std::vector<PnlssStart> startsFor(const PnlssArguments&, const PnlssTake&);

/// A model of integer, or of fractional order: fitted, or read and judged; kept where --out says.
PnlssOutcome integerPnlss(const PnlssArguments&, const PnlssTake&, Terminal&);
PnlssOutcome fractionalPnlss(const PnlssArguments&, const PnlssTake&, Terminal&);

}  // namespace excursion::cli
