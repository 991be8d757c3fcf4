// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"
#include "Engine/Loudspeaker/Record.h"
#include "Engine/Numerics/LeastSquares.h"
#include "Engine/Take/Measurement.h"

#include <complex>
#include <string>
#include <vector>

namespace excursion {

/// A measured frequency response that the linear part of a model is to follow.
struct ResponseTarget {
    Quantity quantity = Quantity::current;  ///< output, per unit of input; of an impedance the current
    bool impedance = false;                 ///< compare the reciprocal: volts per ampere
    std::vector<double> frequency;          ///< Hz
    std::vector<std::complex<double>> value;
    std::vector<double> deviation;  ///< of value, weights the fit
};

/// Responses of every channel of a record at one level (all levels when -1), on a logarithmic grid of frequencies: in
/// each band the cross-spectrum over the input's power, averaged over lines and realizations,
///     G = sum Y conj(U) / sum |U|^2,   deviation from the part of Y that this leaves (noise, distortion, curvature).
std::vector<ResponseTarget> responsesOf(const Record&, int level, int pointsPerOctave = 12);

/// Those that come nearest to a linear driver's: of the quietest level, or of all levels where that one is drowned in
/// noise.
std::vector<ResponseTarget> linearResponsesOf(const Record&, int pointsPerOctave = 12);

/// Targets of a take that is a frequency response only: the impedance from voltage and current, the other quantities
/// per unit of input, on a logarithmic grid. The deviation of an impedance is its magnitude, that of any other response
/// the curve's rms, four times that for a motion, which is measured at one point of the cone; divided by the root of
/// the octaves that a point stands for, so that every octave counts alike. Ends that repeat one value exactly, or where
/// the excitation has died away, are no measurement and are left out, and so is a motion above the band in which the
/// cone moves as one piece (see PistonBand.h). Throws Error (data) without an input or an output.
std::vector<ResponseTarget> responsesOf(const Spectra&, int pointsPerOctave = 48);

/// A response with at most so many points an octave: mean of value and frequency in each band, or its middle point
/// where the phase turns within the band. Sparser responses stay as they are.
ResponseTarget thinned(const ResponseTarget&, int pointsPerOctave);
std::vector<ResponseTarget> thinned(const std::vector<ResponseTarget>&, int pointsPerOctave);

/// Relative rms error of a model's response over the whole curve, dB [B 4.26], weighted as the target says:
///     10 log10( sum |G - G_measured|^2/sigma^2 / sum |G_measured|^2/sigma^2 ).
/// For an impedance of a frequency-response take that is the rms of |Z - Z_measured|/|Z_measured| over log f.
double responseErrorDb(const Model&, const ResponseTarget&);
/// The mean of that over several responses, dB: what helps one counts as much beside another that errs more.
double responseErrorDb(const Model&, const std::vector<ResponseTarget>&);

/// Fits the free parameters of the model's linear components; positive ones move on a logarithmic scale. Priors count
/// against the error at the start. Leaves standard errors and the covariance in the model, scaled by the error that
/// is left.
SearchSummary fitResponse(Model&, const std::vector<ResponseTarget>&, const LeastSquaresOptions& = {});

/// What one Gauss-Newton step of the parameters that fitResponse() moves would leave of its cost, predicted. The
/// strengths of the newest effect make the step, all else stays: from a strength of zero that is a linear least-squares
/// fit, in which the rest of the model may follow. Bounds are not asked.
double stepOnResponses(Model&, const std::vector<ResponseTarget>&);

/// Adds a linear effect: fitted from each of its starts on a thin grid, the best of them on all points; one with parts
/// part by part, on all points. The model is left as it was when the fit is not usable.
SearchSummary addByResponse(Model&, const Effect&, const std::vector<ResponseTarget>&);

/// The same for a linear effect that the model has already, as its newest: its present values do not count.
SearchSummary fitNewestByResponse(Model&, const std::vector<ResponseTarget>&);
/// On the responses of a record, as finely as the effect asks for.
SearchSummary fitNewestByResponse(Model&, const Record&);
/// The same for component k.
SearchSummary fitByResponse(Model&, std::size_t k, const std::vector<ResponseTarget>&);
SearchSummary fitByResponse(Model&, std::size_t k, const Record&);

/// Fits a model that has got a new effect. Those of the others that have several parts are found anew as well, as the
/// new one may have uncovered more of them; the parts stay as they were where that brings little.
SearchSummary refineByResponse(Model&, const std::vector<ResponseTarget>&);

/// Whether a component is what its name says: no parameter of its shape was driven to a bound, nor all of them to
/// implausible values, where they would stand for something else.
bool isItself(const Model&, std::size_t component);

/// Whether a fit is also sure that it is there: one of its strengths exceeds four standard errors. The errors are those
/// for the shape that was found: data that shows that there is a spectrum need not show how it is distributed, nor what
/// it comes to far beyond the band.
bool isSeen(const Model&, std::size_t component);

/// A linear base model with start values that need no tuning, from a micro speaker to a subwoofer: candidates over the
/// resonance frequency, its quality and the electrical damping are fitted and the best is kept. Parameters that the
/// channels cannot see (without a mechanical channel only Bl^2/m, Rms/m and K/m are seen) are held at typical values
/// and marked as not free.
Model startModel(const std::vector<ResponseTarget>&, bool electrical, const DriverInfo&);

/// What the parameters rest on besides the data, in sentences that begin with a blank: a mass that is held by
/// convention, a motion that was only used up to some frequency. Empty when the take showed everything.
std::string caveatsOf(const Model&, const std::vector<ResponseTarget>& = {});

}  // namespace excursion
