// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Predistortion/Equalizer.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace excursion {
namespace {

constexpr double quality = 3.0;       // of a bell, so that it is a third of an octave wide
constexpr double highest = 0.4;       // of the sample rate
constexpr double prototype = 6.0;     // dB
constexpr double followTime = 0.005;  // s, see Glide
constexpr int steps = 3;

double decibels(std::complex<double> gain) { return 10.0 * std::log10(std::norm(gain)); }

template <std::size_t... K>
std::array<Glide, sizeof...(K)> glides(double rate, std::index_sequence<K...>)
{
    return {(static_cast<void>(K), Glide(followTime, rate))...};
}

}  // namespace

Equalizer::Equalizer(double sampleRate)
    : sampleRate_(sampleRate),
      bands_(0),
      inverse_(Square::Identity()),
      gain_(glides(sampleRate / follow, std::make_index_sequence<count> {}))
{
    while (bands_ < count && thirdOctave(bands_) <= highest * sampleRate)
        tangent_[bands_] = std::tan(std::numbers::pi * thirdOctave(bands_) / sampleRate), ++bands_;
    Square felt = Square::Identity();
    still_ = turning_ = Square::Zero();
    for (std::size_t k = 0; k < bands_; ++k)
        for (std::size_t j = 0; j < bands_; ++j) {
            const auto row = static_cast<Eigen::Index>(j), column = static_cast<Eigen::Index>(k);
            const double s = slope(k, thirdOctave(j));
            felt(row, column) = decibels(bell(k, prototype, thirdOctave(j))) / prototype;
            still_(row, column) = (1.0 - s * s) * (1.0 - s * s);
            turning_(row, column) = s * s / (quality * quality);
        }
    inverse_ = felt.inverse();
    reset();
}

/// s/j of a bell at a frequency, as the trapezoids have it.
double Equalizer::slope(std::size_t band, double frequency) const
{
    return std::tan(std::numbers::pi * std::min(frequency / sampleRate_, 0.4999)) / tangent_[band];
}

std::complex<double> Equalizer::bell(std::size_t band, double gainDb, double frequency) const
{
    const double A = std::pow(10.0, gainDb / 40.0), s = slope(band, frequency);
    return std::complex<double>(1.0 - s * s, s * A / quality) / std::complex<double>(1.0 - s * s, s / (A * quality));
}

/// A host may automate a gain, so that this is asked for in every block: no more than a logarithm per centre.
ThirdOctaves Equalizer::together(const ThirdOctaves& bells) const
{
    using Column = Eigen::Array<double, count, 1>;
    Column product = Column::Ones();
    for (std::size_t k = 0; k < bands_; ++k) {
        if (bells[k] == 0.0)
            continue;
        const double A2 = std::pow(10.0, bells[k] / 20.0);
        const auto column = static_cast<Eigen::Index>(k);
        const auto still = still_.col(column).head(static_cast<Eigen::Index>(bands_)).array(),
                   turning = turning_.col(column).head(static_cast<Eigen::Index>(bands_)).array();
        product.head(static_cast<Eigen::Index>(bands_)) *= (still + A2 * turning) / (still + turning / A2);
    }
    ThirdOctaves sum {};
    for (std::size_t j = 0; j < bands_; ++j)
        sum[j] = 10.0 * std::log10(product[static_cast<Eigen::Index>(j)]);
    return sum;
}

void Equalizer::aim(const ThirdOctaves& gainDb)
{
    if (gainDb == wanted_)
        return;
    wanted_ = gainDb;
    target_ = {};
    if (std::any_of(gainDb.begin(), gainDb.end(), [](double gain) { return gain != 0.0; })) {
        for (int k = 0; k < steps; ++k) {
            const auto now = together(target_);
            Eigen::Matrix<double, count, 1> missing = Eigen::Matrix<double, count, 1>::Zero();
            for (std::size_t j = 0; j < bands_; ++j)
                missing[static_cast<Eigen::Index>(j)] = gainDb[j] - now[j];
            for (std::size_t j = 0; j < bands_; ++j)
                target_[j] += inverse_.row(static_cast<Eigen::Index>(j)).dot(missing);
        }
    }
    for (std::size_t k = 0; k < count; ++k)
        gain_[k].aim(target_[k]);
    settled_ = plain_ = false;
}

void Equalizer::jump()
{
    plain_ = settled_ = true;
    for (std::size_t k = 0; k < count; ++k) {
        gain_[k].jump();
        set(k, target_[k]);
        plain_ = plain_ && target_[k] == 0.0;
    }
}

void Equalizer::reset()
{
    jump();
    wait_ = 0;
    for (auto& bell : bells_)
        bell.first = bell.second = 0.0;
}

void Equalizer::set(std::size_t band, double gainDb)
{
    if (band >= bands_)
        return;
    const double A = std::pow(10.0, gainDb / 40.0), g = tangent_[band], k = 1.0 / (A * quality);
    auto& bell = bells_[band];
    bell.a1 = 1.0 / (1.0 + g * (g + k));
    bell.a2 = g * bell.a1;
    bell.a3 = g * bell.a2;
    bell.byFirst = gainDb == 0.0 ? 0.0 : A / quality - k;
}

double Equalizer::Bell::step(double u)
{
    const double high = u - second, v1 = a1 * first + a2 * high, v2 = second + a2 * first + a3 * high;
    first = 2.0 * v1 - first;
    second = 2.0 * v2 - second;
    return u + byFirst * v1;
}

double Equalizer::step(double u)
{
    if (plain_)
        return u;
    if (!settled_ && --wait_ <= 0) {
        wait_ = follow;
        settled_ = true;
        bool plain = true;
        for (std::size_t k = 0; k < bands_; ++k) {
            const double gain = gain_[k].step();
            set(k, gain);
            settled_ = settled_ && gain_[k].still();
            plain = plain && gain == 0.0;
        }
        if (settled_ && plain) {
            plain_ = true;
            for (auto& bell : bells_)
                bell.first = bell.second = 0.0;
            return u;
        }
    }
    for (std::size_t k = 0; k < bands_; ++k)
        u = bells_[k].step(u);
    return u;
}

std::complex<double> Equalizer::at(double frequency) const
{
    std::complex<double> product = 1.0;
    for (std::size_t k = 0; k < bands_; ++k)
        if (target_[k] != 0.0)
            product *= bell(k, target_[k], frequency);
    return product;
}

}  // namespace excursion
