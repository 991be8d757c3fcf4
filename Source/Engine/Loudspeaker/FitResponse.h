// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Loudspeaker/Model.h"
#include "Engine/Estimate/Record.h"
#include "Engine/Numerics/LeastSquares.h"
#include "Engine/Take/Measurement.h"

#include <complex>
#include <limits>
#include <string>
#include <vector>

namespace excursion {

/// A measured frequency response that the linear part of a model is fitted to.
struct ResponseTarget {
    Quantity quantity = Quantity::current;  ///< output, per unit of input; for an impedance the current
    bool impedance = false;                 ///< compare the reciprocal: volts per ampere
    std::vector<double> frequency;          ///< Hz
    std::vector<std::complex<double>> value;
    std::vector<double> deviation;  ///< of value, weights the fit
    /// s: lines that lie evenly, its inverse apart, show a delay but for multiples of this and a phase that all lines
    /// share (of odd lines a sign)
    double delayPeriod = std::numeric_limits<double>::infinity();
};

/// Responses of every channel of a record at one level (all levels when -1), on a logarithmic grid of frequencies: in
/// each band the cross-spectrum over the input's power, averaged over lines and realizations,
///     G = sum Y conj(U) / sum |U|^2,   deviation from the part of Y that this leaves (noise, distortion, curvature),
/// of a pressure without its time of flight, which G has again at the mean frequency of the band.
std::vector<ResponseTarget> responsesOf(const Record&, int level, int pointsPerOctave = 12);

/// The responses nearest to those of a linear driver: of each channel from all levels together where that is no other
/// response than the quietest level's, as far as that one's noise tells, as the louder ones have less noise. From the
/// quietest level elsewhere, as what distorts does least there; from all if it is lost in noise.
std::vector<ResponseTarget> linearResponsesOf(const Record&, int pointsPerOctave = 12);

/// Targets of a take that is only a frequency response: the impedance from voltage and current, the other quantities
/// per unit of input, on a logarithmic grid. The deviation of an impedance is its magnitude. That of any other response
/// is the curve's rms, or four times the rms for a motion, which is measured at one point of the cone. It is divided by
/// the square root of the octaves that a point stands for, so that every octave has equal weight. Ends that repeat one
/// value exactly, or where the excitation has died away, are not measurements and are left out. So is a motion above
/// the band in which the cone moves rigidly (see PistonBand.h). Throws Error (data) without an input or an output.
std::vector<ResponseTarget> responsesOf(const Spectra&, int pointsPerOctave = 48);

/// A response with at most this many points per octave: the mean of value and frequency in each band, or the middle
/// point if the phase turns within the band. Sparser responses are unchanged.
ResponseTarget thinned(const ResponseTarget&, int pointsPerOctave);
std::vector<ResponseTarget> thinned(const std::vector<ResponseTarget>&, int pointsPerOctave);

/// Relative rms error of a model's response over the whole curve, dB [B 4.26], with the target's weights:
///     10 log10( sum |G - G_measured|^2/sigma^2 / sum |G_measured|^2/sigma^2 ).
/// For an impedance of a frequency-response take that is the rms of |Z - Z_measured|/|Z_measured| over log f.
double responseErrorDb(const Model&, const ResponseTarget&);
/// The mean of that over several responses, dB: an improvement of one counts the same next to another with a larger
/// error.
double responseErrorDb(const Model&, const std::vector<ResponseTarget>&);

/// Fits the free parameters of the model's linear components; positive ones change on a logarithmic scale. Priors are
/// weighed against the error at the start. Leaves standard errors and the covariance in the model, scaled by the
/// remaining error.
SearchSummary fitResponse(Model&, const std::vector<ResponseTarget>&, const LeastSquaresOptions& = {});

/// The predicted cost after one Gauss-Newton step of the parameters that fitResponse() changes. The strengths of the
/// newest effect make the step, and all other values stay: from a strength of zero this is a linear least-squares fit,
/// in which the rest of the model may follow. Bounds are ignored.
double stepOnResponses(Model&, const std::vector<ResponseTarget>&);

/// Adds a linear effect: it is fitted from each of its starts on a coarse grid, then from the best one on all points.
/// An effect with parts is fitted part by part, on all points. The model is unchanged if the fit is not usable.
SearchSummary addByResponse(Model&, const Effect&, const std::vector<ResponseTarget>&);

/// The same for a linear effect that the model already has, as its newest: its present values are ignored.
SearchSummary fitNewestByResponse(Model&, const std::vector<ResponseTarget>&);
/// The same for component k.
SearchSummary fitByResponse(Model&, std::size_t k, const std::vector<ResponseTarget>&);

/// Whether an effect that relaxes departs farther from its law than is plausible beforehand.
bool hasUnusualShape(const Component&);

/// Fits component k, which relaxes, from its starts beside a base that has taken over what the component did, first
/// without departures from its law and with all else held. An inductance beside relaxations with rates and weights of
/// their own has several shapes that no linear response tells apart; this one is the nearest to the law. The model is
/// unchanged if the fit is not usable.
SearchSummary fitUsualShape(Model&, std::size_t k, const std::vector<ResponseTarget>&);

/// Fits a model that has a new effect. Of effects that have several parts more are looked for from where they are, and
/// of the older ones also all of them anew, as the new effect may have uncovered more. The parts are unchanged if that
/// brings little, unless they stand for something else.
SearchSummary refineByResponse(Model&, const std::vector<ResponseTarget>&);

/// Whether a component has plausible values (Effect::plausible()) beside the model's base.
bool isPlausible(const Model&, std::size_t component);

/// Whether a component is what its name says: no parameter of its shape is at a bound, and not all of them have
/// implausible values, which would stand for something else.
bool isItself(const Model&, std::size_t component);

/// Puts those parts of an effect at rest (Effect::parts), no longer free, that are implausible by themselves: one part
/// too many stands for something else, and the others are what they are. What remains of such a part far above the band
/// is its mass, which the base takes over in the next fit. Does nothing if no plausible part would stay.
/// @returns whether a part was put at rest
bool restImplausibleParts(Model&, std::size_t component);

/// Whether a fit is also sure that the component is present: one of its strengths exceeds four standard errors. The
/// errors are those for the shape that was found: data that shows a spectrum need not show its distribution, nor its
/// value far beyond the band.
bool isSeen(const Model&, std::size_t component);

/// A linear base model with start values that need no tuning, from a micro speaker to a subwoofer: candidates over
/// resonance frequency, quality factor and electrical damping are fitted, and the best is kept. Parameters that the
/// channels do not determine (without a mechanical channel only Bl^2/m, Rms/m and K/m are determined; without a current
/// only Bl/m, K/m and Rms + Bl^2/Re over m, for an Re that is a guess) are held at typical values and marked as not
/// free.
Model startModel(const std::vector<ResponseTarget>&, bool electrical, const DriverInfo&);

/// The same motion, but for the inductance and the laws, of a driver with another coil: this many times the resistance,
/// and this many times the share of the damping Rms + Bl^2/Re. Without a current all of these are as likely.
Model withCoil(Model, double resistance, double share);

/// The assumptions behind the parameters, in sentences that begin with a blank: a mass held by convention, a motion
/// used only up to some frequency. Empty if the take determined everything.
std::string caveatsOf(const Model&, const std::vector<ResponseTarget>& = {});

}  // namespace excursion
