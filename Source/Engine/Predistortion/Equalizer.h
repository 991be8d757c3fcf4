// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Predistortion/Glide.h"
#include "Engine/Predistortion/ThirdOctaves.h"

#include <Eigen/Core>

#include <array>
#include <complex>

namespace excursion {

/// A gain for each third-octave band: one bell filter per band, in series,
///     H(s) = (s^2 + (A/Q) s w + w^2)/(s^2 + s w/(A Q) + w^2),   A^2 the gain at the band's centre w,
/// in the trapezoidal form (Zavalishin, The Art of VA Filter Design, 2012, section 4), so there is no delay and the
/// phase is minimum phase. A bell also acts in the neighbouring bands. So the gains of the bells are chosen such that
/// all of them together have the wanted gains at the centres. The contribution of a bell at each centre, in dB, is
/// nearly proportional to its own gain, so three steps of Newton's method with one fixed matrix are enough. With gains
/// of 0 dB the samples pass bit-exact. Bands above 0.4 of the sample rate are not changed. New gains are followed
/// within some 50 ms.
///
/// Thread: after construction nothing allocates, locks or throws.
class Equalizer {
public:
    explicit Equalizer(double sampleRate);

    void aim(const ThirdOctaves& gainDb);
    void jump();   ///< to where it was aimed
    void reset();  ///< as jump(), and as after silence
    double step(double u);
    bool plain() const { return plain_; }  ///< the samples pass bit-exact

    /// The response of the target. For any thread but the audio thread.
    std::complex<double> at(double frequency) const;

private:
    static constexpr std::size_t count = std::tuple_size_v<ThirdOctaves>;
    static constexpr int follow = 16;  ///< samples between two updates of moving gains
    using Square = Eigen::Matrix<double, count, count>;

    struct Bell {
        double a1 = 0.0, a2 = 0.0, a3 = 0.0, byFirst = 0.0;
        double first = 0.0, second = 0.0;  ///< states of the integrators
        double step(double u);
    };
    void set(std::size_t band, double gainDb);
    std::complex<double> bell(std::size_t band, double gainDb, double frequency) const;
    double slope(std::size_t band, double frequency) const;
    ThirdOctaves together(const ThirdOctaves& bells) const;

    double sampleRate_;
    std::size_t bands_;  ///< number of bands that are used
    Square inverse_;     ///< dB of the bells per dB at the centres
    std::array<double, count> tangent_ {};
    /// of each bell (column) at each centre (row), with s as the trapezoids have it: (1 - s^2)^2 and (s/Q)^2
    Square still_, turning_;
    ThirdOctaves wanted_ {}, target_ {};  ///< wanted_: gains at the centres; target_: gains of the bells
    std::array<Glide, count> gain_;
    std::array<Bell, count> bells_;
    bool plain_ = true, settled_ = true;
    int wait_ = 0;
};

}  // namespace excursion
