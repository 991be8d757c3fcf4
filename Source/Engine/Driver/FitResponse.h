// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Driver/LeastSquares.h"
#include "Engine/Driver/Model.h"
#include "Engine/Driver/Record.h"
#include "Engine/Measurement/Measurement.h"

#include <complex>
#include <vector>

namespace excursion {

/// A measured frequency response that the linear part of a model is to follow.
struct ResponseTarget {
    Quantity quantity = Quantity::current;      ///< output, per unit of input; of an impedance the current
    bool impedance = false;                     ///< compare the reciprocal: volts per ampere
    std::vector<double> frequency;              ///< Hz
    std::vector<std::complex<double>> value;
    std::vector<double> deviation;              ///< of value, weights the fit
};

/// Responses of every channel of a record at one level (all levels when -1), on a logarithmic grid of frequencies: in each
/// band the cross-spectrum over the input's power, averaged over lines and realizations,
///     G = sum Y conj(U) / sum |U|^2,   deviation from the part of Y that this leaves (noise, distortion, curvature).
std::vector<ResponseTarget> responsesOf(const Record&, int level, int pointsPerOctave = 12);

/// Targets of a take that is a frequency response only: the impedance from voltage and current, the mechanical
/// quantities per volt. All points of a target weigh the same, as in the relative rms error (seed 4.26).
std::vector<ResponseTarget> responsesOf(const Spectra&);

/// Relative rms error of a model's response, dB (seed 4.26).
double responseErrorDb(const Model&, const ResponseTarget&);

/// Fits the free parameters of the model's linear components; positive ones move on a logarithmic scale.
LeastSquaresSummary fitResponse(Model&, const std::vector<ResponseTarget>&, const LeastSquaresOptions& = {});

/// A linear base model with start values that need no tuning, from a micro speaker to a subwoofer: candidates over the
/// resonance frequency, its quality and the electrical damping are fitted and the best is kept. Parameters that the channels cannot
/// see (without a mechanical channel only Bl^2/m is seen) are held at typical values and marked as not free.
Model startModel(const std::vector<ResponseTarget>&, bool electrical, const DriverInfo&);

} // namespace excursion
