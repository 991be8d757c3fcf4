// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Estimate/Record.h"
#include "Engine/Numerics/NormalEquations.h"

#include <Eigen/Core>

#include <complex>
#include <cstddef>
#include <limits>
#include <vector>

namespace excursion {

/// Error power and measured power of a channel, unweighted; noise power in the same window.
struct ErrorPower {
    double error = 0.0, measured = 0.0, noise = 0.0;

    static constexpr double most = 2.0;  ///< largest ratio of error to noise that still counts as noise: 3 dB

    void add(const ErrorPower&);
    double overNoise() const { return noise > 0.0 ? error / noise : std::numeric_limits<double>::infinity(); }
};

/// The share of the noise's cost that is disregarded while a channel's error is above its noise. Most lines of a take
/// hold only noise, so the error of a few lines with high power hardly changes a mean over all of them.
inline constexpr double sureNoise = 0.9;

/// Residuals of a section: all lines of the take's band, their real parts first. They are (model - measured)/deviation,
/// of unit variance each if only noise is left; NormalEquations sums those of one channel over some sections.
class Residual {
public:
    Residual(const Record&, const Section&);

    static constexpr Eigen::Index bands = 48;

    std::size_t firstLine() const { return first_; }
    std::size_t lastLine() const { return last_; }
    Eigen::Index rows() const { return 2 * lines_; }

    /// The residual of a channel after a predicted spectrum.
    Eigen::VectorXd of(std::size_t channel, const std::vector<std::complex<double>>& predicted) const;
    ErrorPower power(std::size_t channel, const std::vector<std::complex<double>>& predicted) const;
    /// J^T r of each band, one column a band. Bands are equally wide in log frequency, as what tells of a parameter
    /// lies around its resonance or at an end of the range.
    Eigen::MatrixXd pulls(const Eigen::MatrixXd& J, const Eigen::VectorXd& r) const;
    /// By how much the covariance of g = sum_c J_c^T r_c exceeds that of channels whose noise is their own, which is
    /// sum_c J_c^T J_c: noise of the input comes through all of them,
    ///     sum_lines sum_{c != d} Re(a_c a_d^H),   a_c = conj(j_c) inputNoise_c/deviation_c,
    /// with the row j_c = J_c,re + i J_c,im of a line. Empty where that noise is not known.
    /// @param J  [channel]
    Eigen::MatrixXd shared(const std::vector<Eigen::MatrixXd>& J) const;
    /// The derivative of the residuals, from that of the predicted spectrum.
    void fill(std::size_t channel, const std::vector<std::complex<double>>& derivative,
              Eigen::Ref<Eigen::VectorXd> column) const;

private:
    const Section& section_;
    std::size_t first_ = 0, last_ = 0;
    Eigen::Index lines_ = 0;
    std::vector<Eigen::VectorXd> weight_;  ///< [channel], of both parts of a line
};

}  // namespace excursion
