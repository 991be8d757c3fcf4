// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/MatchSound.h"

#include "Engine/Loudspeaker/SmallSignal.h"

#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>
#include <vector>

namespace excursion {
namespace {

/// The delays that are tried, s: from 0 on, to the usual ones or twice the present one, in steps of an eighth of the
/// shortest period. Those are left out that look like an earlier one: a model starts from rest, and its sound would
/// arrive too late.
struct Delays {
    double step, longest;

    Delays(double present, const ResponseTarget& pressure)
        : step(0.125 / pressure.frequency.back()),
          longest(std::min(std::max(0.03, 2.0 * present), pressure.delayPeriod))
    {
    }
};

/// The strengths that only the sound shows.
std::vector<Parameter*> heardStrengths(Model& model)
{
    std::vector<Parameter*> heard;
    for (auto* p : parametersOf(model))
        if (p->heard && p->strength && p->free)
            heard.push_back(p);
    return heard;
}

/// Real and imaginary parts over the deviations, one after the other.
Eigen::VectorXd weighted(const Eigen::VectorXcd& values, const std::vector<double>& deviation)
{
    Eigen::VectorXd rows(2 * values.size());
    for (Eigen::Index k = 0; k < values.size(); ++k) {
        rows[2 * k] = values[k].real() / deviation[static_cast<std::size_t>(k)];
        rows[2 * k + 1] = values[k].imag() / deviation[static_cast<std::size_t>(k)];
    }
    return rows;
}

}  // namespace

void matchArrival(Model& model, const ResponseTarget& pressure)
{
    double &area = model.path.parameters[0].value, &delay = model.path.parameters[1].value;
    const Delays delays(delay, pressure);
    const auto response = respond(model, {Quantity::pressure}, pressure.frequency).front();
    std::vector<std::complex<double>> turned(pressure.frequency.size()), step(turned.size());
    for (std::size_t k = 0; k < turned.size(); ++k) {
        const double omega = 2.0 * std::numbers::pi * pressure.frequency[k];
        const auto ratio = pressure.value[k] / response.value[k] * std::polar(1.0, -omega * delay);
        const double size = std::abs(ratio);
        turned[k] = size > 0.0 && std::isfinite(size) ? ratio / size : 0.0;
        step[k] = std::polar(1.0, omega * delays.step);
    }
    double best = 0.0;
    for (double tau = 0.0; tau < delays.longest; tau += delays.step) {
        double agreement = 0.0;
        for (std::size_t k = 0; k < turned.size(); ++k) {
            agreement += turned[k].real();
            turned[k] *= step[k];
        }
        if (std::abs(agreement) > std::abs(best)) {
            best = agreement;
            delay = tau;
        }
    }
    if (best < 0.0)
        area = -area;
}

void matchSound(Model& matched, const ResponseTarget& pressure)
{
    auto model = matched;
    auto &area = model.path.parameters[0], &delay = model.path.parameters[1];
    if (!delay.free || area.value == 0.0)
        return;
    const Delays delays(delay.value, pressure);
    const auto heard = heardStrengths(model);
    const auto points = static_cast<Eigen::Index>(pressure.frequency.size());
    delay.value = 0.0;
    for (auto* p : heard)
        p->value = 0.0;
    const auto sound = [&] {
        const auto response = respond(model, {Quantity::pressure}, pressure.frequency).front();
        return Eigen::VectorXcd(Eigen::Map<const Eigen::VectorXcd>(response.value.data(), points) / area.value);
    };
    const Eigen::VectorXcd cone = sound();
    Eigen::MatrixXd columns(2 * points, 1 + static_cast<Eigen::Index>(heard.size()));
    columns.col(0) = weighted(cone, pressure.deviation);
    for (std::size_t k = 0; k < heard.size(); ++k) {
        heard[k]->value = 1.0;
        columns.col(1 + static_cast<Eigen::Index>(k)) = weighted(sound() - cone, pressure.deviation);
        heard[k]->value = 0.0;
    }
    const Eigen::HouseholderQR<Eigen::MatrixXd> factors(columns);
    const Eigen::MatrixXd basis = factors.householderQ() * Eigen::MatrixXd::Identity(columns.rows(), columns.cols());

    double most = -1.0;
    Eigen::VectorXd best = Eigen::VectorXd::Zero(columns.cols());
    for (double tau = 0.0; tau < delays.longest; tau += delays.step) {
        Eigen::VectorXcd early(points);
        for (Eigen::Index k = 0; k < points; ++k) {
            const auto n = static_cast<std::size_t>(k);
            early[k] = pressure.value[n] * std::polar(1.0, 2.0 * std::numbers::pi * pressure.frequency[n] * tau);
        }
        const Eigen::VectorXd explained = basis.transpose() * weighted(early, pressure.deviation);
        if (explained.squaredNorm() > most) {
            most = explained.squaredNorm();
            best = explained;
            delay.value = tau;
        }
    }
    const Eigen::VectorXd sizes = factors.matrixQR().topRows(columns.cols()).triangularView<Eigen::Upper>().solve(best);
    if (!sizes.allFinite() || sizes[0] == 0.0)
        return;
    area.value = area.free ? sizes[0] : std::copysign(area.value, sizes[0]);
    for (std::size_t k = 0; k < heard.size(); ++k)
        heard[k]->value = std::clamp(sizes[1 + static_cast<Eigen::Index>(k)] / sizes[0], heard[k]->lower,
                                     heard[k]->upper);
    matched = std::move(model);
}

}  // namespace excursion
