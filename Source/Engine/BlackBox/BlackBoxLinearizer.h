// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/BlackBox/BlackBoxStep.h"
#include "Engine/BlackBox/PreviewControl.h"

#include <cstddef>
#include <limits>
#include <vector>

namespace excursion {

/// How a black box is inverted.
struct BlackBoxDesign {
    PreviewControl control;
    int preview = 0;  ///< samples of the model, per pass
    int passes = 2;   ///< at least 1
};

/// The correction to add to the input of a black box so that its output is that of its linear part alone, sample by
/// sample at the model's rate.
///
/// With x_r the states of the linear part, e = x - x_r the difference of the box from it, and w the correction,
///     e(t+1) = A e + B w + E (q - q_r),   y - y_r = C e + D w + F (q - q_r)
/// is a linear system with the nonlinearity's q as disturbance. PreviewControl keeps its output at zero. The future q
/// depends on w, which is not known yet. So the first pass takes the q of the linear part's own trajectory. Each later
/// pass takes the q of the pass before, which runs `preview` samples ahead of it. Every pass is a simulation of the box
/// with its own correction, so an error of the predicted q is fed back and does not accumulate. (This is a fixed-point
/// iteration like the Picard form of Schetzen's p-th order inverse, with passes in place of orders, but closed by
/// feedback.)
///
/// The mean of q is not distortion. q_r is q low-passed by two poles at a twentieth of the lowest frequency of the
/// stimulus. It drives the linear part as well, so the correction asks for no constant voltage.
///
/// Nothing allocates after construction.
class BlackBoxLinearizer {
public:
    BlackBoxLinearizer(const BlackBox&, const Region&, const Rest&, const BlackBoxDesign&);

    int latency() const { return static_cast<int>(passes_.size()) * static_cast<int>(preview_); }
    void reset();

    struct Sample {
        double input = 0.0;       ///< the input of `latency()` samples ago
        double correction = 0.0;  ///< to be added to the input
        double wanted = 0.0;      ///< input plus correction, without any bound
        double output = 0.0;      ///< output of the model for both
        double residual = 0.0;    ///< remaining distortion, according to the model
        double distance = 0.0;    ///< how far out in the region the box is; 1: at its border
    };

    /// The slow part of q, q_r: for the latest input, not for the output.
    const std::vector<double>& slow() const { return slow_; }

    /// @param u              finite
    /// @param largest        the correction is kept to this
    /// @param voltageLimit   input and correction together are kept to this, as far as the correction can
    Sample step(double u, double largest = std::numeric_limits<double>::infinity(),
                double voltageLimit = std::numeric_limits<double>::infinity());

private:
    /// A fixed number of values for each of the latest samples, contiguous from the oldest to the newest.
    class Window {
    public:
        Window(std::size_t each, std::size_t samples) : each_(each), samples_(samples), values_(2 * each * samples, 0.0)
        {
        }
        void clear() { std::fill(values_.begin(), values_.end(), 0.0); }
        double* next();  ///< the place of a new sample; fill it before settle()
        void settle();
        const double* oldest() const { return values_.data() + at_ * each_; }
        /// the sample that came `ago` samples before the newest
        const double* past(std::size_t ago) const { return oldest() + (samples_ - 1 - ago) * each_; }

    private:
        std::size_t each_, samples_, at_ = 0;
        std::vector<double> values_;
    };

    struct Pass {
        std::vector<double> e, q;
        Window ahead;  ///< q - q_r of the pass before, preview + 1 samples
    };

    BlackBoxStep step_;
    Rest rest_;
    std::size_t preview_, width_;  // width_: of q, padded
    std::vector<double> K_, g_;    // g_: as Window::oldest() lies
    double slowShare_;
    std::vector<double> reference_, z_, q_, slowFirst_, slow_, moved_;
    std::vector<Pass> passes_;
    Window past_;  ///< u, z_r, q_r and y_r
};

}  // namespace excursion
