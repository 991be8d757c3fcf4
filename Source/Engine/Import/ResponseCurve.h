// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Import/PlanClock.h"

#include <complex>
#include <filesystem>
#include <vector>

namespace excursion {

/// The response of a sensor or an interface, known at some frequencies and as between its neighbours elsewhere: linear
/// in dB and in phase over the logarithm of the frequency, and as at the ends beyond them.
class ResponseCurve {
public:
    /// @param frequency  Hz, ascending, positive; as many as values, one at least
    ResponseCurve(std::vector<double> frequency, const std::vector<std::complex<double>>& value);

    std::complex<double> operator()(double frequency) const;
    double db(double frequency) const;

private:
    std::vector<double> logFrequency_, db_, phase_;  ///< phase in radians, unwrapped
};

/// Reads the correction of a microphone: lines of frequency in Hz, dB and, maybe, phase in degrees (.cal, .txt, .frd).
/// The values are the microphone's own response, as makers give them: what it hears too loud is positive, and is taken
/// off. Without phases, or with none but zero, the response is that of minimum phase (MinimumPhase.h), as a pressure
/// microphone's is within the band where it is used. Only its shape counts: it is 0 dB at `reference`.
/// @param reference   Hz, where the channel's full scale holds
/// Throws Error (input).
ResponseCurve readMicrophoneCurve(const std::filesystem::path&, double reference);

}  // namespace excursion
