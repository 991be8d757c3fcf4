// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Driver/FitResponse.h"

#include "Engine/Driver/Catalogue.h"
#include "Engine/Driver/Linearize.h"
#include "Engine/Signal/Fft.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace excursion {
namespace {

using Complex = std::complex<double>;

bool positive(const Parameter& p) { return p.lower >= 0.0 && p.value > 0.0 && !p.strength; }

/// Residuals of one target at the model's present parameters, added to the normal equations in the scale of the search.
void add(const ResponseTarget& target, const Response& response, const std::vector<Eigen::Index>& active,
         const Eigen::VectorXd& chain, bool gradient, NormalEquations& sum)
{
    const auto P = static_cast<Eigen::Index>(active.size());
    if (gradient && sum.N.size() == 0) {
        sum.N = Eigen::MatrixXd::Zero(P, P);
        sum.g = Eigen::VectorXd::Zero(P);
    }
    Eigen::VectorXcd row(P);
    for (std::size_t f = 0; f < target.frequency.size(); ++f) {
        const Complex model = target.impedance ? 1.0 / response.value[f] : response.value[f];
        const Complex residual = (model - target.value[f]) / target.deviation[f];
        sum.cost += std::norm(residual);
        sum.rows += 2.0;
        if (!gradient)
            continue;
        const Complex outer = (target.impedance ? -model * model : Complex(1.0)) / target.deviation[f];
        for (Eigen::Index k = 0; k < P; ++k)
            row[k] = outer * response.gradient(static_cast<Eigen::Index>(f), active[static_cast<std::size_t>(k)]) * chain[k];
        sum.N += (row.conjugate() * row.transpose()).real();
        sum.g += (row.conjugate() * residual).real();
    }
}

struct Cell {
    Complex cross {};
    double input = 0.0, output = 0.0, weightedFrequency = 0.0;
    int count = 0;
};

} // namespace

std::vector<ResponseTarget> responsesOf(const Record& record, int level, int pointsPerOctave)
{
    std::vector<ResponseTarget> targets;
    const double low = std::max(record.bandLow * 0.99, 1e-3);
    const int cells = std::max(4, static_cast<int>(std::ceil(std::log2(record.bandHigh * 1.01 / low) * pointsPerOctave)));
    for (std::size_t c = 0; c < record.channels.size(); ++c) {
        std::vector<Cell> grid(static_cast<std::size_t>(cells) + 1);
        double totalInput = 0.0;
        std::size_t lines = 0;
        for (const auto& section : record.sections) {
            if (section.validation || (level >= 0 && section.level >= 0 && section.level != level))
                continue;
            const auto U = fft(std::span(section.input).last(section.window));
            const auto take = [&](std::size_t k) {
                const double f = record.frequency(section, k);
                if (f < low || f > record.bandHigh * 1.01)
                    return;
                auto& cell = grid[static_cast<std::size_t>(std::log2(f / low) * pointsPerOctave)];
                cell.cross += section.measured[c][k] * std::conj(U[k]);
                cell.input += std::norm(U[k]);
                cell.output += std::norm(section.measured[c][k]);
                cell.weightedFrequency += f * std::norm(U[k]);
                ++cell.count;
                totalInput += std::norm(U[k]);
                ++lines;
            };
            if (!section.excited.empty())
                for (const int k : section.excited)
                    take(static_cast<std::size_t>(k));
            else
                for (std::size_t k = 1; k < section.window / 2; ++k)
                    take(k);
        }
        ResponseTarget target;
        target.quantity = record.channels[c];
        for (const auto& cell : grid) {
            // A cell with next to no input power says nothing.
            if (cell.count == 0 || cell.input < 1e-7 * totalInput * cell.count / static_cast<double>(std::max<std::size_t>(lines, 1)))
                continue;
            const Complex G = cell.cross / cell.input;
            const double left = std::max(0.0, cell.output - std::norm(cell.cross) / cell.input);
            const double variance = cell.count > 1 ? left / (cell.count - 1) / cell.input : 0.0;
            target.frequency.push_back(cell.weightedFrequency / cell.input);
            target.value.push_back(G);
            // One percent besides: the linear model is a start, not a truth.
            target.deviation.push_back(std::sqrt(variance + 1e-4 * std::norm(G)));
        }
        if (target.frequency.size() >= 3)
            targets.push_back(std::move(target));
    }
    return targets;
}

std::vector<ResponseTarget> responsesOf(const Spectra& spectra)
{
    const auto* voltage = spectra.find(Quantity::voltage);
    const auto* input = voltage ? voltage : spectra.find(Quantity::force);
    if (!input)
        throw Error(Error::Kind::data, "The frequency response names no voltage and no force, so it is not known what it is a response to.");
    std::vector<ResponseTarget> targets;
    for (const auto& channel : spectra.channels) {
        if (&channel == input)
            continue;
        ResponseTarget target;
        target.quantity = channel.quantity;
        target.impedance = channel.quantity == Quantity::current;
        double power = 0.0;
        for (std::size_t k = 0; k < spectra.frequency.size(); ++k) {
            if (spectra.frequency[k] <= 0.0)
                continue;
            const Complex value = target.impedance ? input->values[k] / channel.values[k] : channel.values[k] / input->values[k];
            if (!std::isfinite(std::norm(value)))
                throw Error(Error::Kind::data, "The frequency response is zero where it is divided by, at "
                                                   + std::to_string(spectra.frequency[k]) + " Hz.");
            target.frequency.push_back(spectra.frequency[k]);
            target.value.push_back(value);
            power += std::norm(value);
        }
        target.deviation.assign(target.value.size(), std::sqrt(power / static_cast<double>(std::max<std::size_t>(1, target.value.size()))));
        targets.push_back(std::move(target));
    }
    return targets;
}

double responseErrorDb(const Model& model, const ResponseTarget& target)
{
    const auto response = respond(model, {target.quantity}, target.frequency).front();
    double error = 0.0, power = 0.0;
    for (std::size_t f = 0; f < target.frequency.size(); ++f) {
        const Complex value = target.impedance ? 1.0 / response.value[f] : response.value[f];
        error += std::norm(value - target.value[f]);
        power += std::norm(target.value[f]);
    }
    return 10.0 * std::log10(std::max(error / power, 1e-40));
}

LeastSquaresSummary fitResponse(Model& model, const std::vector<ResponseTarget>& targets, const LeastSquaresOptions& options)
{
    std::vector<Eigen::Index> active;
    const auto all = parametersOf(model);
    std::vector<bool> logarithmic;
    for (std::size_t k = 0, component = 0, inside = 0; k < all.size(); ++k) {
        while (component < model.components.size() && inside == model.components[component].parameters.size()) {
            ++component;
            inside = 0;
        }
        const bool isPath = component == model.components.size();
        if (all[k]->free && (isPath || model.components[component].effect->linear())) {
            active.push_back(static_cast<Eigen::Index>(k));
            logarithmic.push_back(positive(*all[k]));
        }
        ++inside;
    }
    const auto P = static_cast<Eigen::Index>(active.size());
    Eigen::VectorXd x(P), lower(P), upper(P);
    for (Eigen::Index k = 0; k < P; ++k) {
        const auto& p = *all[static_cast<std::size_t>(active[static_cast<std::size_t>(k)])];
        const bool log = logarithmic[static_cast<std::size_t>(k)];
        x[k] = log ? std::log(p.value) : p.value;
        lower[k] = log ? x[k] - std::log(1e3) : p.lower;
        upper[k] = log ? x[k] + std::log(1e3) : p.upper;
    }
    const auto place = [&](const Eigen::VectorXd& at) {
        for (Eigen::Index k = 0; k < P; ++k)
            all[static_cast<std::size_t>(active[static_cast<std::size_t>(k)])]->value
                = logarithmic[static_cast<std::size_t>(k)] ? std::exp(at[k]) : at[k];
    };
    // The search divides by |x| where it is not zero; offset logarithms so that their scale is one.
    const Eigen::VectorXd origin = x.array() - 1.0;
    const auto shifted = [&](const Eigen::VectorXd& y) {
        Eigen::VectorXd at = y;
        for (Eigen::Index k = 0; k < P; ++k)
            if (logarithmic[static_cast<std::size_t>(k)])
                at[k] += origin[k];
        return at;
    };
    Eigen::VectorXd y = x;
    for (Eigen::Index k = 0; k < P; ++k)
        if (logarithmic[static_cast<std::size_t>(k)]) {
            y[k] = 1.0;
            lower[k] -= origin[k];
            upper[k] -= origin[k];
        }
    const auto evaluate = [&](const Eigen::VectorXd& at, bool gradient, NormalEquations& sum) {
        place(shifted(at));
        Eigen::VectorXd chain = Eigen::VectorXd::Ones(P);
        for (Eigen::Index k = 0; k < P; ++k)
            if (logarithmic[static_cast<std::size_t>(k)])
                chain[k] = all[static_cast<std::size_t>(active[static_cast<std::size_t>(k)])]->value;
        for (const auto& target : targets)
            add(target, respond(model, {target.quantity}, target.frequency, gradient).front(), active, chain, gradient, sum);
        return std::isfinite(sum.cost);
    };
    const Eigen::VectorXd start = y;
    const auto summary = minimize(evaluate, y, lower, upper, options);
    place(shifted(summary.usable ? y : start));
    return summary;
}

Model startModel(const std::vector<ResponseTarget>& targets, bool electrical, const DriverInfo& driver)
{
    if (targets.empty())
        throw Error(Error::Kind::data, "The take gives no frequency response to start from; excite it in the band of the loudspeaker's resonance.");
    double low = targets.front().frequency.front(), high = targets.front().frequency.back();
    bool seesMotion = false, seesCurrent = false, seesPressure = false;
    for (const auto& target : targets) {
        low = std::min(low, target.frequency.front());
        high = std::max(high, target.frequency.back());
        seesCurrent |= target.quantity == Quantity::current;
        seesPressure |= target.quantity == Quantity::pressure;
        seesMotion |= target.quantity != Quantity::current && target.quantity != Quantity::pressure;
    }
    const double area = driver.coneArea.value_or(0.01);
    const double distance = driver.microphoneDistance.value_or(1.0);
    constexpr double speedOfSound = 343.0;

    // The magnitude of the response sets the scale of the start, so that only dimensionless numbers are searched.
    const auto typical = [](const ResponseTarget& t) {
        std::vector<double> magnitudes;
        for (const auto& v : t.value)
            magnitudes.push_back(std::abs(v));
        std::nth_element(magnitudes.begin(), magnitudes.begin() + static_cast<std::ptrdiff_t>(magnitudes.size() / 2), magnitudes.end());
        return magnitudes[magnitudes.size() / 2];
    };
    Model best;
    double bestCost = std::numeric_limits<double>::infinity();
    LeastSquaresOptions rough;
    rough.maximumIterations = 12;
    rough.costTolerance = 1e-3;

    const auto consider = [&](Model candidate) {
        for (auto& p : candidate.base().effect->parameters({}))
            if (!(candidate.baseParameter(p.name).value > 0.0))
                return;
        const auto summary = fitResponse(candidate, targets, rough);
        if (summary.usable && summary.finalCost < bestCost) {
            bestCost = summary.finalCost;
            best = candidate;
        }
    };
    for (double f0 = std::max(low, 2.0) * 1.1; f0 < std::min(high, 3000.0); f0 *= 1.45)
        for (const double Q : {1.0, 5.0}) {
            const double omega = 2.0 * std::numbers::pi * f0;
            Model model = makeModel(electrical ? "electrodynamic" : "mechanical");
            model.microphoneDistance = distance;
            model.path[0].value = area;
            model.path[1].value = distance / speedOfSound;
            model.path[1].free = seesPressure;
            model.path[0].free = seesPressure && seesMotion;
            if (!electrical) {
                // x/F is 1/K below resonance.
                const double K = 1.0 / std::abs(targets.front().value.front());
                const auto& t = targets.front();
                const double order = t.quantity == Quantity::velocity ? 1 : t.quantity == Quantity::displacement ? 0 : 2;
                model.baseParameter("K").value = K * std::pow(2.0 * std::numbers::pi * t.frequency.front(), order);
                model.baseParameter("m").value = model.baseParameter("K").value / (omega * omega);
                model.baseParameter("Rms").value = omega * model.baseParameter("m").value / Q;
                consider(model);
                continue;
            }
            double Re = 6.0;
            for (const auto& t : targets)
                if (t.quantity == Quantity::current) {
                    const double magnitude = typical(t);
                    Re = 0.8 * (t.impedance ? magnitude : 1.0 / magnitude);
                }
            for (const double coupling : {0.5, 4.0}) {   // Bl^2/(Re Rms): the height of the impedance peak
                for (const double mass : {1e-4, 1e-2}) {
                    model.baseParameter("Re").value = Re;
                    model.baseParameter("Le").value = Re / (2.0 * std::numbers::pi * 3000.0);
                    model.baseParameter("m").value = mass;
                    model.baseParameter("K").value = mass * omega * omega;
                    model.baseParameter("Rms").value = omega * mass / Q;
                    model.baseParameter("Bl").value = std::sqrt(coupling * Re * model.baseParameter("Rms").value);
                    // Without a mechanical channel (or a microphone at a known distance from a known area) the mass is a convention.
                    model.baseParameter("m").free = seesMotion || (seesPressure && driver.coneArea && driver.microphoneDistance);
                    model.baseParameter("Re").free = seesCurrent;
                    consider(model);
                }
            }
        }
    if (!std::isfinite(bestCost))
        throw Error(Error::Kind::numerical, "No linear driver could be fitted to the frequency response of the take; run the check of the take first.");
    fitResponse(best, targets, {60, 1e-8});
    best.name = driver.name;
    return best;
}

} // namespace excursion
