// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/BlackBox/RateConverter.h"

#include "Engine/BlackBox/BlackBoxStep.h"
#include "Engine/Error.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>

namespace excursion {
namespace {

constexpr double flat = 0.41, stop = 0.5;              // of the lower rate
constexpr double beta = 8.96, reachTimesWidth = 2.88;  // for -90 dB; width: of the transition, cycles a sample

/// Of first kind and order zero.
double bessel(double x)
{
    double sum = 1.0, term = 1.0;
    for (int k = 1; term > 1e-18 * sum; ++k) {
        term *= 0.25 * x * x / (static_cast<double>(k) * k);
        sum += term;
    }
    return sum;
}

}  // namespace

RateConverter::RateConverter(double from, double to, double highest)
    : from_(std::llround(1000.0 * from)), to_(std::llround(1000.0 * to))
{
    if (!(from_ > 0 && to_ > 0 && from <= 16.0 * to && to <= 16.0 * from))
        throw Error(Error::Kind::usage, "A signal at " + std::to_string(from) + " Hz cannot be turned into one at "
                                            + std::to_string(to) + " Hz: the rates differ by more than 16 times.");
    const auto common = std::gcd(from_, to_);
    from_ /= common;
    to_ /= common;
    // Cycles an input sample.
    constexpr double longest = 0.02;  // s, of the reach
    const double share = std::min(1.0, to / from), known = highest / from,
                 unknown = std::max(2.0 * known, known + reachTimesWidth / (longest * from));
    const bool knowsLess = unknown < stop * share;
    const double first = knowsLess ? known : flat * share, last = knowsLess ? unknown : stop * share,
                 cut = 0.5 * (first + last);
    unchanged_ = from_ == to_ && !knowsLess;
    if (unchanged_) {
        reset();
        return;
    }
    reach_ = static_cast<int>(std::ceil(reachTimesWidth / (last - first) - 1e-9));
    const int taps = 2 * reach_;
    history_.assign(2 * static_cast<std::size_t>(taps), 0.0);
    for (int phase = 0; phase <= phases; ++phase) {
        double sum = 0.0;
        const auto row = table_.size();
        for (int k = 0; k < taps; ++k) {
            // Distance of tap k from the output, which lies between taps reach_ - 1 and reach_.
            const double t = k - (reach_ - 1) - static_cast<double>(phase) / phases;
            const double x = 2.0 * std::numbers::pi * cut * t, place = t / reach_;
            const double window = std::abs(place) < 1.0 ? bessel(beta * std::sqrt(1.0 - place * place)) / bessel(beta)
                                                        : 0.0;
            table_.push_back(2.0 * cut * (std::abs(x) < 1e-12 ? 1.0 : std::sin(x) / x) * window);
            sum += table_.back();
        }
        for (std::size_t k = row; k < table_.size(); ++k)
            table_[k] /= sum;  // a constant goes through as it is
    }
    reset();
}

void RateConverter::reset()
{
    std::fill(history_.begin(), history_.end(), 0.0);
    at_ = 0;
    ahead_ = -1;
    fraction_ = 0;
    if (unchanged_)
        history_.assign(1, 0.0);
}

void RateConverter::push(double sample)
{
    ++ahead_;
    if (unchanged_) {
        history_[0] = sample;
        return;
    }
    const auto taps = 2 * static_cast<std::size_t>(reach_);
    history_[at_] = history_[at_ + taps] = sample;
    at_ = at_ + 1 == taps ? 0 : at_ + 1;
}

bool RateConverter::pull(double& out)
{
    if (ahead_ < reach_)
        return false;
    if (unchanged_) {
        out = history_[0];
        ahead_ = -1;
        return true;
    }
    const auto taps = 2 * static_cast<std::size_t>(reach_);
    // push() is followed by pull() until nothing comes, so the newest sample is the last that this output needs.
    const double place = static_cast<double>(fraction_) / static_cast<double>(to_) * phases;
    const auto phase = static_cast<std::size_t>(place);
    const double* const row = table_.data() + phase * taps;
    const double first = innerProduct(row, history_.data() + at_, taps),
                 second = innerProduct(row + taps, history_.data() + at_, taps);
    out = first + (place - static_cast<double>(phase)) * (second - first);
    fraction_ += from_;
    ahead_ -= fraction_ / to_;
    fraction_ %= to_;
    return true;
}

}  // namespace excursion
