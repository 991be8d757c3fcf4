// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Estimate/Record.h"
#include "Engine/Loudspeaker/Model.h"

#include <complex>
#include <map>
#include <vector>

namespace excursion {

/// What the departures of the input from a periodic one (InputDeparture.h) add to the averaged periods of the
/// channels, through the linear part G of a model:
///     M_k = 1/P sum_{n = S N}^{(S+P) N - 1} y(n) exp(-2 pi j k n/N),   y = IDFT_L{G D}
///         = sum_l G_l D_l w(l - k (S+P+1)),   w(q) = 1/(P L) sum_n exp(2 pi j q n/L), over the same n.
/// Most of it rings from one period into the next. A pressure has passed a microphone's high-pass, which was taken off
/// line by line: s_l/(s_l + w) before and (s_k + w)/s_k behind the sum (SensorResponse.h). Slopes of fits leave M out.
class DepartureResponse {
public:
    /// For sections of one window, which are alike in all but what departs.
    DepartureResponse(const Model&, const Record&, const Section&, unsigned threads);

    /// Adds M to the predicted spectra of a section. @param predicted  [channel]
    void addTo(std::vector<std::vector<std::complex<double>>>& predicted, const Section&) const;

private:
    std::vector<std::vector<std::complex<double>>> path_;      ///< [channel], G_l
    std::vector<std::vector<std::complex<double>>> takenOff_;  ///< [channel], of line k; empty: nothing
    std::vector<std::complex<double>> kernel_;                 ///< w(q) from q = -2 lines on
};

/// By window; none of windows whose sections have no departure.
using DepartureResponses = std::map<std::size_t, DepartureResponse>;
DepartureResponses departureResponses(const Model&, const Record&, const std::vector<std::size_t>& sections,
                                      unsigned threads);

/// What a map has for the window of a section; null: nothing.
template <class Value>
const Value* ofWindow(const std::map<std::size_t, Value>& byWindow, const Section& section)
{
    const auto found = byWindow.find(section.window);
    return found == byWindow.end() ? nullptr : &found->second;
}

}  // namespace excursion
