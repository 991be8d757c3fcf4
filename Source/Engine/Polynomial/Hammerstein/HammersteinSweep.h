// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Polynomial/Hammerstein/ParallelHammerstein.h"
#include "Engine/Signal/ExponentialSweep.h"

#include <span>
#include <string>
#include <vector>

namespace excursion {

struct HammersteinSweepOptions {
    int degree = 3;              ///< N, branches and harmonics that are told apart, 1 .. 20
    Eigen::Index length = 1024;  ///< K, taps of a branch
    /// s that are kept ahead of a harmonic's response, and beyond its K taps, under half cosines: what rings there,
    /// from where the sweep begins and ends, is smeared over some 1 / edge in frequency.
    double edge = 0.02;
    double regularization = 1e-8;  ///< r, of the branch filters: see identifyHammerstein()

    bool isValid(std::string* reason = nullptr) const;
};

/// Hz, between which the answer to a sweep is known: the sweep is not faded there, and its end, which rings at all
/// frequencies that were played shortly before, is as long away as a response lasts.
struct SweepBand {
    double low = 0.0, high = 0.0;
};
SweepBand knownBand(const ExponentialSweep&, const HammersteinSweepOptions&);

/// The window under which a response is cut out: 1 inside, half cosines of `edge` samples at both ends.
double sweepWindow(std::size_t at, std::size_t length, std::size_t edge);

/// The higher harmonic frequency responses of an answer to a synchronized sweep (Novak et al. 2015). The answer is
/// divided by the analytic spectrum,
///     h = F^-1[Y/X] = sum_m h_m(t + L ln m):   one response a harmonic, each at its own time,
/// and what stands around -L ln m is cut out, transformed, and moved to 0 (L ln m need not be whole samples).
struct HarmonicResponses {
    double sampleRate = 0.0;
    std::vector<double> frequency;  ///< Hz, 0 .. fs/2 in even steps
    /// lines x N, H_m, output unit / input unit: of sin(m phi) in the answer to a sin(phi)
    Eigen::MatrixXcd value;
    double separation = 0.0;  ///< s between the last two harmonics: what a response may last
};

/// @param output  sampled with the sweep, from its first sample on; with what comes after it, else the last frequencies
/// are cut short
/// Throws Error (usage) for options that make no sense, (data) for an output that is shorter than the sweep or not
/// finite, or where the responses would overlap: then the sweep has to last longer, or degree or length be lower.
HarmonicResponses harmonicResponses(const ExponentialSweep&, std::span<const double> output,
                                    const HammersteinSweepOptions& = {});

/// The branch responses G_n, lines x N, output unit / input unit^n, from the harmonic ones. As
///     sin^n phi = sum_m B_nm sin(m phi)  (n odd),  const + sum_m B_nm cos(m phi)  (n even),   m = n, n-2, .. > 0,
///     B_nm = 2^(1-n) binom(n, (n-m)/2) (-1)^floor(m/2)        (de Moivre)
/// and a cosine is j times a sine at positive frequencies, H_m = sum_{n >= m} B_nm (j if n even) a^(n-1) G_n:
/// triangular, solved from the last up.
Eigen::MatrixXcd branchResponses(const HarmonicResponses&, double peak);

struct HammersteinSweepFit {
    ParallelHammerstein model;
    /// relative rms error [B 4.26] while the sweep runs where all branches are known; means removed
    double estimationDb = 0.0;
};

/// The whole of it: harmonic responses, branch responses, and filters that fit branch n by least squares on the lines
/// where it is known,
///     sum_f |G_n(f) - sum_k g_n(k) exp(-2 pi j f k / fs)|^2 + r lines sum_k g_n(k)^2 -> min,
///         M f1' + 1/edge <= f <= n f2' - 1/edge,
/// M <= N the last harmonic of n's parity, f1' and f2' the frequencies between which the sweep is not faded, f2' also
/// earlier than the end by what a response lasts: the end rings at all frequencies that were played so shortly before.
/// Outside nothing is asked of a filter but to be small, so what the model says there is a guess. The constant that
/// even powers have is filtered by such a guess as well: of a record's mean value the model knows nothing.
HammersteinSweepFit identifyHammerstein(const ExponentialSweep&, std::span<const double> output,
                                        const HammersteinSweepOptions& = {});

}  // namespace excursion
