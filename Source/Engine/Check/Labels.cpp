// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Check/Labels.h"

#include "Engine/Estimate/Bla.h"
#include "Engine/Numerics/QrFactors.h"
#include "Engine/Take/Motion.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

namespace excursion {
namespace {

using Complex = std::complex<double>;
constexpr double bad = 1.0;

/// Derivatives from a motion to the velocity.
int toVelocity(Quantity q) { return q == Quantity::displacement ? 1 : q == Quantity::acceleration ? -1 : 0; }

/// What one channel is per volt, and where its noise lets it be seen.
struct Answer {
    std::vector<double> frequency;
    std::vector<Complex> value;
    std::vector<bool> seen;
};

Answer answerOf(const Measurement& take, Quantity quantity)
{
    const int loudest = take.excitation->loudest();
    const auto frf = bla(take, quantity, loudest, Quantity::voltage).frf;
    Answer answer {frf.frequency, frf.value, {}};
    constexpr double clear = 0.01;  // of the power
    for (std::size_t k = 0; k < frf.value.size(); ++k)
        answer.seen.push_back(frf.noiseVariance.empty() || frf.noiseVariance[k] < clear * std::norm(frf.value[k]));
    return answer;
}

/// Rms of 1 - sum_j c_j B_kj with the best real c, which are told.
double relativeErrorOf(const std::vector<std::vector<Complex>>& columns, Eigen::VectorXd& c)
{
    const auto F = static_cast<Eigen::Index>(columns.front().size());
    Eigen::MatrixXd A(2 * F, static_cast<Eigen::Index>(columns.size()));
    for (Eigen::Index j = 0; j < A.cols(); ++j)
        for (Eigen::Index k = 0; k < F; ++k) {
            const auto value = columns[static_cast<std::size_t>(j)][static_cast<std::size_t>(k)];
            A(k, j) = value.real();
            A(F + k, j) = value.imag();
        }
    Eigen::VectorXd one = Eigen::VectorXd::Zero(2 * F);
    one.head(F).setOnes();
    const Eigen::VectorXd size = A.colwise().norm();
    const Eigen::MatrixXd scaled = A * size.cwiseInverse().asDiagonal();
    c = pivotedSolveVector(scaled, one);
    const double relativeError = (one - scaled * c).norm() / std::sqrt(static_cast<double>(F));
    c = c.cwiseQuotient(size);
    return relativeError;
}

/// How badly a loudspeaker explains these channels, 0 .. 1.
/// @param kind      of the motion
/// @param pressure  may be empty
double relativeErrorOf(const Answer& current, const Answer& motion, Quantity kind, const Answer* pressure)
{
    constexpr std::size_t fewest = 12;
    const auto omega = [&](std::size_t k) { return Complex(0.0, 2.0 * std::numbers::pi * current.frequency[k]); };
    const auto velocity = [&](std::size_t k) { return motion.value[k] * std::pow(omega(k), toVelocity(kind)); };

    std::vector<std::vector<Complex>> coil(4);
    std::size_t resonance = 0;
    for (std::size_t k = 0; k < current.value.size(); ++k) {
        if (!current.seen[k] || !motion.seen[k])
            continue;
        const auto s = omega(k);
        coil[0].push_back(current.value[k]);
        coil[1].push_back(s * current.value[k]);
        coil[2].push_back(std::pow(s, 0.7) * current.value[k]);
        coil[3].push_back(velocity(k));
        const auto mobility = [&](std::size_t n) { return std::abs(velocity(n) / current.value[n]); };
        if (!current.seen[resonance] || !motion.seen[resonance] || mobility(k) > mobility(resonance))
            resonance = k;
    }
    if (coil[0].size() < fewest)
        return bad;
    Eigen::VectorXd c, without;
    double sum = relativeErrorOf(coil, c);
    if (!(c[0] * c[3] != 0.0) || c[0] < 0.0)
        return bad;
    const double counterVoltage = c[3];
    constexpr double told = 2.0;  // times worse without the voltage of the moving coil: its sign is known
    const bool signKnown = relativeErrorOf({coil[0], coil[1], coil[2]}, without) > told * sum;

    constexpr double around = 6.0;
    std::vector<std::vector<Complex>> cone(3);
    std::vector<double> ratio;
    const double f0 = current.frequency[resonance];
    for (std::size_t k = 0; k < current.value.size(); ++k) {
        if (!current.seen[k] || !motion.seen[k] || current.frequency[k] > around * f0
            || current.frequency[k] < f0 / around)
            continue;
        const auto mobility = velocity(k) / current.value[k];
        cone[0].push_back(omega(k) * mobility);
        cone[1].push_back(mobility);
        cone[2].push_back(mobility / omega(k));
        if (pressure && pressure->seen[k])
            ratio.push_back(std::log(std::abs(pressure->value[k] / (omega(k) * velocity(k)))));
    }
    if (cone[0].size() < fewest)
        return bad;
    sum += relativeErrorOf(cone, c);
    if (!(c[0] * c[2] > 0.0))  // no resonance
        return bad;
    // The force factor that drives the cone is the one that brakes the coil: with voltage and current exchanged all
    // else fits, but its sign.
    if (signKnown && counterVoltage * c[0] < 0.0)
        return bad;
    if (ratio.size() >= fewest) {
        double mean = 0.0, square = 0.0;
        for (const double r : ratio)
            mean += r / static_cast<double>(ratio.size());
        for (const double r : ratio)
            square += (r - mean) * (r - mean) / static_cast<double>(ratio.size());
        sum += 0.3 * std::sqrt(square);  // a room bends it by a few dB
    }
    return std::min(bad, sum);
}

/// What the answers would be were voltage and current exchanged: per that current.
std::vector<Answer> perCurrent(const std::vector<Answer>& answers, std::size_t current)
{
    auto result = answers;
    for (std::size_t j = 0; j < answers.size(); ++j)
        for (std::size_t k = 0; k < answers[j].value.size(); ++k) {
            const auto i = answers[current].value[k];
            result[j].seen[k] = answers[j].seen[k] && answers[current].seen[k];
            result[j].value[k] = i == 0.0 ? 0.0 : (j == current ? 1.0 : answers[j].value[k]) / i;
        }
    return result;
}

Problem mislabelled(Quantity label, Quantity truth, double relativeError)
{
    return {"mislabelled",
            label,
            100.0 * relativeError,
            "%",
            true,
            "The " + std::string(name(label)) + " channel behaves like the " + std::string(name(truth))
                + " of a loudspeaker: cables or columns are mixed up; map it as " + std::string(name(truth)) + "."};
}

}  // namespace

bool checkLabels(const Measurement& take, const std::vector<bool>& alive, std::vector<Problem>& problems)
{
    std::vector<Quantity> labels;
    std::vector<Answer> answers;
    int motions = 0;
    for (std::size_t c = 0; c < take.channels.size(); ++c) {
        const auto quantity = take.channels[c].quantity;
        if (!alive[c] && quantity == Quantity::voltage)
            return true;
        if (!alive[c] || (quantity != Quantity::current && quantity != Quantity::pressure && !isMotion(quantity)))
            continue;
        labels.push_back(quantity);
        motions += isMotion(quantity);
    }
    const bool judged = take.find(Quantity::voltage) && take.input().quantity == Quantity::voltage && motions == 1
                        && std::count(labels.begin(), labels.end(), Quantity::current) == 1;
    if (!judged)
        return true;
    for (const auto label : labels)
        answers.push_back(answerOf(take, label));

    const auto relativeError = [&](const std::vector<Answer>& told, const std::vector<Quantity>& named) {
        const Answer *current = nullptr, *motion = nullptr, *pressure = nullptr;
        Quantity kind = Quantity::displacement;
        for (std::size_t k = 0; k < named.size(); ++k) {
            (named[k] == Quantity::current ? current : named[k] == Quantity::pressure ? pressure : motion) = &told[k];
            if (isMotion(named[k]))
                kind = named[k];
        }
        return relativeErrorOf(*current, *motion, kind, pressure);
    };
    constexpr double implausible = 0.3, plausible = 0.15, farBetter = 3.0;
    const double asTold = relativeError(answers, labels);
    if (!(asTold > implausible))
        return true;
    std::vector<std::size_t> order(labels.size());
    for (std::size_t k = 0; k < order.size(); ++k)
        order[k] = k;
    double least = std::numeric_limits<double>::infinity();
    std::vector<Quantity> best;
    do {
        std::vector<Quantity> named(labels.size());
        for (std::size_t k = 0; k < order.size(); ++k)
            named[k] = labels[order[k]];
        for (const auto kind : {Quantity::displacement, Quantity::velocity, Quantity::acceleration}) {
            auto other = named;
            for (auto& q : other)
                if (isMotion(q))
                    q = kind;
            // Kinds are exchanged only where nothing else is: one mistake at a time.
            const bool sameKind = std::find(labels.begin(), labels.end(), kind) != labels.end();
            if (!sameKind && named != labels)
                continue;
            if (const double left = relativeError(answers, other); left < least) {
                least = left;
                best = other;
            }
        }
    } while (std::next_permutation(order.begin(), order.end()));
    const auto current = static_cast<std::size_t>(std::find(labels.begin(), labels.end(), Quantity::current)
                                                  - labels.begin());
    if (const double left = relativeError(perCurrent(answers, current), labels);
        left < least && left < plausible && farBetter * left < asTold) {
        problems.push_back(mislabelled(Quantity::voltage, Quantity::current, asTold));
        problems.push_back(mislabelled(Quantity::current, Quantity::voltage, asTold));
        return false;
    }
    if (best == labels || !(least < plausible && farBetter * least < asTold))
        return true;
    for (std::size_t k = 0; k < labels.size(); ++k)
        if (best[k] != labels[k])
            problems.push_back(mislabelled(labels[k], best[k], asTold));
    return false;
}

}  // namespace excursion
