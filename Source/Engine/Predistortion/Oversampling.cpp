// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Predistortion/Oversampling.h"

#include "Engine/Error.h"

#include <algorithm>

namespace excursion {
namespace {

constexpr double attenuation = 110.0;  // dB, below what 16 significant bits and the physics leave

/// Between 1 and 2: from 0.45 to 0.55 of the lower rate.
const HalfBandTaps& narrow()
{
    static const HalfBandTaps taps(0.05, attenuation);
    return taps;
}

/// Between 2 and 4: what the narrow one passes ends at 0.55 / 2 of its rate, and images begin at the same distance from
/// the top.
const HalfBandTaps& wide()
{
    static const HalfBandTaps taps(0.225, attenuation);
    return taps;
}

}  // namespace

Oversampling::Oversampling(int factor) : factor_(factor)
{
    if (factor != 1 && factor != 2 && factor != 4)
        throw Error(Error::Kind::usage, "Oversampling can be 1, 2 or 4, not " + std::to_string(factor) + ".");
    if (factor >= 2) {
        firstUp_.emplace(narrow(), longestBlock);
        firstDown_.emplace(narrow(), longestBlock);
        latency_ = narrow().reach();
    }
    if (factor == 4) {
        secondUp_.emplace(wide(), 2 * longestBlock);
        secondDown_.emplace(wide(), 2 * longestBlock);
        latency_ += (wide().reach() + 1) / 2;
        middle_.resize(2 * longestBlock);
    }
}

void Oversampling::reset()
{
    for (auto* stage : {&firstUp_, &secondUp_})
        if (*stage)
            (*stage)->reset();
    for (auto* stage : {&firstDown_, &secondDown_})
        if (*stage)
            (*stage)->reset();
    late_ = 0.0;
}

void Oversampling::up(const double* in, std::size_t n, double* out)
{
    if (factor_ == 1) {
        std::copy(in, in + n, out);
    } else if (factor_ == 2) {
        firstUp_->process(in, n, out);
    } else {
        firstUp_->process(in, n, middle_.data());
        secondUp_->process(middle_.data(), 2 * n, out);
    }
}

void Oversampling::down(const double* in, std::size_t n, double* out)
{
    if (factor_ == 1) {
        std::copy(in, in + n, out);
    } else if (factor_ == 2) {
        firstDown_->process(in, n, out);
    } else {
        secondDown_->process(in, 2 * n, middle_.data());
        for (std::size_t j = 0; j < 2 * n; ++j)
            std::swap(late_, middle_[j]);
        firstDown_->process(middle_.data(), n, out);
    }
}

}  // namespace excursion
