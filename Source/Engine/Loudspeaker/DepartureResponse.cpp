// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/DepartureResponse.h"

#include "Engine/Loudspeaker/SensorResponse.h"
#include "Engine/Loudspeaker/SmallSignal.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace excursion {
namespace {

using Complex = std::complex<double>;

/// w(q) with L = windows N.
Complex kernelAt(std::ptrdiff_t q, const InputDeparture& of, std::size_t N)
{
    const double m = of.windows(), L = m * static_cast<double>(N), P = of.averaged;
    if (q == 0)
        return static_cast<double>(N) / L;
    // Phases of whole windows repeat with q, so that no digit is lost.
    const auto turns = static_cast<double>(q % of.windows());
    const auto turn = [](double cycles) { return std::polar(1.0, 2.0 * std::numbers::pi * cycles); };
    return turn(turns * of.settling / m) * (1.0 - turn(turns * P / m))
           / (P * L * (1.0 - turn(static_cast<double>(q) / L)));
}

}  // namespace

DepartureResponse::DepartureResponse(const Model& model, const Record& record, const Section& section, unsigned threads)
{
    const auto& departure = section.departure;
    const auto lines = departure.spectrum.size();
    const double step = record.frequency(section, 1) / departure.windows();
    std::vector<double> frequency(lines);
    for (std::size_t l = 0; l < lines; ++l)
        frequency[l] = step * std::max(static_cast<double>(l), 1e-3);
    const auto s = [step](std::size_t l) {
        return Complex(0.0, 2.0 * std::numbers::pi * step * std::max(static_cast<double>(l), 1e-3));
    };
    const auto responses = respondToEach(model, record.channels, frequency, {Drives::terminals}, false, threads);
    for (std::size_t c = 0; c < record.channels.size(); ++c) {
        path_.push_back(responses.front()[c].value);
        takenOff_.emplace_back();
        const double w = sensorOf(model, record.channels[c]).rolledOff;
        if (w == 0.0)
            continue;
        for (std::size_t l = 0; l < lines; ++l)
            path_[c][l] *= s(l) / (s(l) + w);
        for (std::size_t l = 0; l < lines; l += static_cast<std::size_t>(departure.windows()))
            takenOff_[c].push_back((s(l) + w) / s(l));
    }
    const auto reach = static_cast<std::ptrdiff_t>(2 * lines);
    for (std::ptrdiff_t q = -reach; q <= reach; ++q)
        kernel_.push_back(kernelAt(q, departure, section.window));
}

void DepartureResponse::addTo(std::vector<std::vector<Complex>>& predicted, const Section& section) const
{
    const auto& D = section.departure.spectrum;
    const auto m = static_cast<std::size_t>(section.departure.windows()), lines = D.size();
    if (lines == 0)
        return;
    const auto origin = kernel_.begin() + static_cast<std::ptrdiff_t>(2 * lines);
    std::vector<Complex> Y(lines);
    for (std::size_t c = 0; c < predicted.size(); ++c) {
        for (std::size_t l = 0; l < lines; ++l)
            Y[l] = path_[c][l] * D[l];
        for (std::size_t k = 1; k * m < lines; ++k) {
            const auto at = origin - static_cast<std::ptrdiff_t>(k * m);
            Complex sum = Y[0].real() * at[0];
            for (std::size_t l = 1; l < lines; ++l)
                sum += Y[l] * at[static_cast<std::ptrdiff_t>(l)]
                       + std::conj(Y[l]) * at[-static_cast<std::ptrdiff_t>(l)];
            predicted[c][k] += takenOff_[c].empty() ? sum : sum * takenOff_[c][k];
        }
    }
}

DepartureResponses departureResponses(const Model& model, const Record& record,
                                      const std::vector<std::size_t>& sections, unsigned threads)
{
    DepartureResponses responses;
    for (const auto s : sections)
        if (const auto& section = record.sections[s]; !section.departure.spectrum.empty())
            responses.try_emplace(section.window, model, record, section, threads);
    return responses;
}

}  // namespace excursion
