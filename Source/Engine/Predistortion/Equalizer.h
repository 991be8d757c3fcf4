// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "Engine/Predistortion/Glide.h"
#include "Engine/Predistortion/ThirdOctaves.h"

#include <Eigen/Core>

#include <array>
#include <complex>

namespace excursion {

/// A gain for each third of an octave: one bell a band, in series,
///     H(s) = (s^2 + (A/Q) s w + w^2)/(s^2 + s w/(A Q) + w^2),   A^2 the gain at the band's centre w,
/// in the trapezoidal form (Zavalishin, The Art of VA Filter Design, 2012, section 4), so there is no delay and the
/// phase is the least that belongs to the gain. A bell is felt in the bands beside its own; the gains of the bells are
/// chosen so that all of them together have the wanted gains at the centres: what each adds in dB at each centre is
/// nearly proportional to its own gain, so three steps of Newton's method with one fixed matrix are enough. With gains
/// of 0 dB a sample goes through as it is, bit by bit. Bands above 0.4 of the sample rate are left alone. New gains are
/// followed within some 50 ms.
///
/// Thread: after construction nothing allocates, locks or throws.
class Equalizer {
public:
    explicit Equalizer(double sampleRate);

    void aim(const ThirdOctaves& gainDb);
    void jump();   ///< to where it was aimed
    void reset();  ///< as jump(), and as after silence
    double step(double u);
    bool plain() const { return plain_; }  ///< a sample goes through as it is

    /// Of what it was aimed at. For any thread but that of the audio.
    std::complex<double> at(double frequency) const;

private:
    static constexpr std::size_t count = std::tuple_size_v<ThirdOctaves>;
    static constexpr int follow = 16;  ///< samples from one change of gains on their way to the next
    using Square = Eigen::Matrix<double, count, count>;

    struct Bell {
        double a1 = 0.0, a2 = 0.0, a3 = 0.0, byFirst = 0.0;
        double first = 0.0, second = 0.0;  ///< states of the integrators
        double step(double u);
    };
    void set(std::size_t band, double gainDb);
    std::complex<double> bell(std::size_t band, double gainDb, double frequency) const;
    ThirdOctaves together(const ThirdOctaves& bells) const;

    double sampleRate_;
    std::size_t bands_;  ///< that are used
    Square inverse_;     ///< dB of the bells per dB at the centres
    std::array<double, count> tangent_ {};
    ThirdOctaves wanted_ {}, target_ {};  ///< at the centres, and of the bells
    std::array<Glide, count> gain_;
    std::array<Bell, count> bells_;
    bool plain_ = true, settled_ = true;
    int wait_ = 0;
};

}  // namespace excursion
