// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Driver/Record.h"

#include <Eigen/Core>

#include <complex>
#include <cstddef>
#include <limits>
#include <vector>

namespace excursion {

/// Error power and measured power of a channel, not weighted; noise power in the same window.
struct ErrorPower {
    double error = 0.0, measured = 0.0, noise = 0.0;

    static constexpr double most = 2.0;  ///< of error over noise that still is noise: 3 dB

    void add(const ErrorPower&);
    double overNoise() const { return noise > 0.0 ? error / noise : std::numeric_limits<double>::infinity(); }
};

/// The share of the noise's cost that is left out of account while a channel's error stands above its noise. Most lines
/// of a take hold nothing but noise, and what a few with much power miss hardly moves a mean over all of them.
inline constexpr double sureNoise = 0.9;

/// The least-squares problem min |r + J d|^2 of residuals r (one channel, over some sections) in its normal form.
/// Residuals are (model - measured)/deviation, real and imaginary part, each with unit variance if only noise is left.
struct NormalEquations {
    Eigen::MatrixXd N;  ///< J^T J
    Eigen::VectorXd g;  ///< J^T r
    double cost = 0.0;  ///< r^T r
    double rows = 0.0;  ///< number of real residuals
    /// of the cost, what is noise for sure: a search takes no falls relative to it (sureNoise)
    double sure = 0.0;

    NormalEquations() = default;
    explicit NormalEquations(const Eigen::VectorXd& r);
    void differentiateBy(const Eigen::MatrixXd& J, const Eigen::VectorXd& r);  ///< sets N and g
    void add(const NormalEquations&);
};

/// Residuals of a section: all lines of the take's band, their real parts first.
class Residual {
public:
    Residual(const Record&, const Section&);

    std::size_t firstLine() const { return first_; }
    std::size_t lastLine() const { return last_; }
    Eigen::Index rows() const { return 2 * lines_; }

    /// What a predicted spectrum leaves of a channel.
    Eigen::VectorXd of(std::size_t channel, const std::vector<std::complex<double>>& predicted) const;
    ErrorPower power(std::size_t channel, const std::vector<std::complex<double>>& predicted) const;
    /// The derivative of the residuals, from that of the predicted spectrum.
    void fill(std::size_t channel, const std::vector<std::complex<double>>& derivative,
              Eigen::Ref<Eigen::VectorXd> column) const;

private:
    const Section& section_;
    std::size_t first_ = 0, last_ = 0;
    Eigen::Index lines_ = 0;
};

}  // namespace excursion
