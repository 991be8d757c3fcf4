// SPDX-License-Identifier: GPL-3.0-or-later
#include "Cli/Pnlss.h"

#include "Engine/Polynomial/Pnlss/ResidualTest.h"

#include <cmath>
#include <string_view>

namespace excursion::cli {
namespace {

constexpr std::string_view tryThis = "Try";  // what an advice begins with

double judgedSamples(const std::vector<InputOutputRecord>& records)
{
    double samples = 0.0;
    for (const auto& record : records)
        samples += static_cast<double>((record.output.rows() - record.skip) * record.output.cols());
    return samples;
}

Arrival atNoise(const PnlssArguments& options, const PnlssTake& data, const PnlssOutcome& outcome)
{
    Arrival told;
    told.noiseDb = data.records.noiseDb;
    if (!told.noiseDb && outcome.untold)
        told.noiseDb = outcome.untold->db;
    told.noiseFrom = data.records.noiseDb ? "periods" : "residual";
    const auto &estimation = data.records.estimation, &validation = data.records.validation;
    const bool validated = !validation.empty();
    const auto fewer = std::string("a longer take that goes everywhere early on, or fewer coefficients: --mask, "
                                   "--terms, a lower --order or --degree.");
    if (!validated && 2.0 * static_cast<double>(outcome.parameters) >= judgedSamples(estimation)) {
        told.sentence = "It is not known whether the error is at the noise: " + std::to_string(outcome.parameters)
                        + " coefficients can follow almost any "
                        + std::to_string(static_cast<long>(judgedSamples(estimation)))
                        + " samples, and no records are held out.";
        told.advice = "Try " + fewer;
        return told;
    }
    if (outcome.estimationDb <= exactDb) {
        if (!validated || isHeld(outcome.estimationDb, estimation, outcome.validationDb, validation)) {
            told.arrived = true;
            told.sentence = "The error is below what any recording resolves.";
            return told;
        }
        told.sentence = "It is not known whether this is the system: the error is below what any recording resolves on "
                        "the records of the estimation, and on those held out "
                        + (std::isfinite(outcome.validationDb) ? "it is " + errorText(outcome.validationDb) + " dB."
                                                               : "the model runs away.");
        told.advice = "Try " + fewer;
        return told;
    }
    if (!told.noiseDb) {
        told.sentence =
            "It is not known whether the error is at the noise: neither periods nor the residual show the noise.";
        return told;
    }
    // What was held out tells by itself what coefficients took of the noise.
    const double samples = judgedSamples(estimation), spent = static_cast<double>(outcome.parameters);
    const double error = outcome.estimationDb + (validated ? 0.0 : 10.0 * std::log10(samples / (samples - spent)));
    const double above = error - *told.noiseDb;
    told.arrived = data.records.noiseDb ? above <= atNoiseDb : outcome.untold->reachedBy(error);
    if (!told.arrived) {
        told.sentence = "It is not known whether the error is at the noise: what is left is as slow as the motion, and "
                        "may be noise or something that the model lacks.";
        told.advice = "Try " + fewer;
        return told;
    }
    if (*told.arrived) {
        const auto noise = "The error is at the noise, " + errorText(*told.noiseDb) + " dB";
        const double over = validated ? heldOutDb(outcome.estimationDb, estimation, outcome.validationDb, validation)
                                      : 0.0;
        told.sentence = noise + ".";
        if (over <= heldOutMostDb)
            return told;
        told.arrived.reset();
        told.sentence = noise + ", on the records of the estimation. On those held out "
                        + (std::isfinite(over) ? "it is " + errorText(over) + " dB larger" : "the model runs away")
                        + ", so it is not known whether this is the system.";
        told.advice = "Try " + fewer;
        return told;
    }
    told.sentence = (options.model.empty() ? "The fit did not arrive: its error is " : "The error is ")
                    + errorText(above) + " dB above the noise, "
                    + (data.records.noiseDb ? errorText(*told.noiseDb) + " dB by the scatter of the periods"
                                            : "as the input still tells that much of it; what it does not tell is "
                                                  + errorText(*told.noiseDb) + " dB or less")
                    + (options.model.empty()
                               && (validated ? outcome.validationDb : outcome.estimationDb) > outcome.startDb - 1.0
                           ? ", and no better than its start."
                           : ".");
    const auto more = options.mask != "full" ? std::string(", --mask full") : std::string();
    told.advice = "Try "
                  + (options.model.empty() && outcome.search.termination == Termination::maximumIterations
                         ? "--iterations " + std::to_string(4 * options.iterations) + ", "
                         : std::string())
                  + (outcome.alpha.empty() ? "--start with a model of identify or of another take, " : "")
                  + "a higher --order or --degree" + more + ".";
    return told;
}

}  // namespace

Arrival arrivalOf(const PnlssArguments& options, const PnlssTake& data, const PnlssOutcome& outcome)
{
    auto told = atNoise(options, data, outcome);
    if (!told.arrived.value_or(false) && outcome.constantShare > 0.5)
        told.advice = "Try " + std::string(options.terms.empty() ? "--offset" : "the monomial 1 among --terms")
                      + ": most of what the start leaves is a constant, as a sensor's offset is."
                      + (told.advice.empty() ? "" : " Otherwise try" + told.advice.substr(tryThis.size()));
    return told;
}

double constantShareOf(const Exponents& exponents, const std::vector<InputOutputRecord>& records,
                       const std::vector<Eigen::MatrixXd>& played)
{
    if ((exponents.rowwise().sum().array() == 0).any())
        return 0.0;
    double constant = 0.0, all = 0.0;
    for (std::size_t k = 0; k < records.size(); ++k) {
        const Eigen::VectorXd error = judgedError(records[k], played[k]).col(0);
        constant += static_cast<double>(error.size()) * std::pow(error.mean(), 2);
        all += error.squaredNorm();
    }
    return std::isfinite(all) && all > 0.0 ? constant / all : 0.0;
}

}  // namespace excursion::cli
