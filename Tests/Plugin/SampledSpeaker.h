// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <random>

namespace excursion::plugin {

/// A midbass with a suspension that hardens, K(x) = 1852 (1 + |x/4 mm|^1.7) N/m, by Runge-Kutta steps, one sample after
/// the other, with sensors that have noise. It shares no code with the models.
class SampledSpeaker {
public:
    explicit SampledSpeaker(double sampleRate) : h_(1.0 / (steps * sampleRate)) {}

    struct Reading {
        double voltage, current, displacement;
    };

    /// @param u  V; the voltage between the samples is a cubic through four of them, so the reading is of two samples
    /// ago
    Reading next(double u)
    {
        u_ = {u_[1], u_[2], u_[3], u};
        for (int k = 0; k < steps; ++k) {
            const double s = static_cast<double>(k) / steps, d = 1.0 / steps;
            const auto a = rates(z_, at(s)), b = rates(plus(z_, a, 0.5 * h_), at(s + 0.5 * d)),
                       c = rates(plus(z_, b, 0.5 * h_), at(s + 0.5 * d)), e = rates(plus(z_, c, h_), at(s + d));
            for (std::size_t n = 0; n < 3; ++n)
                z_[n] += h_ / 6.0 * (a[n] + 2.0 * b[n] + 2.0 * c[n] + e[n]);
        }
        return {u_[2] + noise(1e-3), z_[0] + noise(3e-4), z_[1] + noise(3e-7)};
    }

private:
    static constexpr int steps = 2;
    using State = std::array<double, 3>;  // i, x, v

    static State rates(const State& z, double u)
    {
        const double K = 1852.0 * (1.0 + std::pow(std::abs(z[1]) / 4e-3, 1.7));
        return {(u - 3.3 * z[0] - 4.95 * z[2]) / 266e-6, z[2], (4.95 * z[0] - 0.786 * z[2] - K * z[1]) / 0.01435};
    }
    static State plus(State z, const State& rate, double h)
    {
        for (std::size_t n = 0; n < 3; ++n)
            z[n] += h * rate[n];
        return z;
    }
    /// Between the second and the third of the last four samples.
    double at(double s) const
    {
        return u_[1] + s * (-u_[0] / 3.0 - u_[1] / 2.0 + u_[2] - u_[3] / 6.0)
               + s * s * (u_[0] / 2.0 - u_[1] + u_[2] / 2.0)
               + s * s * s * (-u_[0] / 6.0 + u_[1] / 2.0 - u_[2] / 2.0 + u_[3] / 6.0);
    }
    double noise(double rms) { return rms * normal_(random_); }

    double h_;
    std::array<double, 4> u_ {};
    State z_ {};
    std::mt19937_64 random_ {5};
    std::normal_distribution<double> normal_;
};

}  // namespace excursion::plugin
