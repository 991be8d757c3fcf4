// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Signal/Resample.h"

#include "Engine/Error.h"

#include <soxr.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace excursion {
namespace {

constexpr std::size_t reflectedSamples = 1024;  // longer than the interpolation filter

/// x with `pad` samples reflected about its first and its last one.
std::vector<double> extended(std::span<const double> x, std::size_t pad)
{
    std::vector<double> longer(x.size() + 2 * pad);
    std::copy(x.begin(), x.end(), longer.begin() + static_cast<std::ptrdiff_t>(pad));
    for (std::size_t n = 1; n <= pad; ++n) {
        longer[pad - n] = 2 * x.front() - x[n];
        longer[pad + x.size() - 1 + n] = 2 * x.back() - x[x.size() - 1 - n];
    }
    return longer;
}

}  // namespace

std::vector<double> upsample(std::span<const double> x, int factor)
{
    if (factor < 1 || factor > 256)
        throw Error(Error::Kind::usage,
                    "A record can be upsampled by a factor of 1 to 256, not " + std::to_string(factor) + ".");
    if (factor == 1 || x.empty())
        return {x.begin(), x.end()};

    const auto L = static_cast<std::size_t>(factor);
    const std::size_t pad = std::min(reflectedSamples, x.size() - 1);
    const auto input = extended(x, pad);
    std::vector<double> output(input.size() * L);

    const auto io = soxr_io_spec(SOXR_FLOAT64_I, SOXR_FLOAT64_I);
    const auto quality = soxr_quality_spec(SOXR_VHQ, 0);
    const auto runtime = soxr_runtime_spec(1);
    std::size_t done = 0;
    const auto failure = soxr_oneshot(1.0, static_cast<double>(factor), 1, input.data(), input.size(), nullptr,
                                      output.data(), output.size(), &done, &io, &quality, &runtime);
    if (failure || done < (pad + x.size()) * L)
        throw Error(Error::Kind::numerical,
                    std::string("Upsampling failed: ") + (failure ? failure : "too few samples came out"));

    const auto first = output.begin() + static_cast<std::ptrdiff_t>(pad * L);
    return {first, first + static_cast<std::ptrdiff_t>(x.size() * L)};
}

std::vector<double> resampled(std::span<const double> x, double step)
{
    if (!(step >= 0.01 && step <= 100.0))
        throw Error(Error::Kind::usage,
                    "A record can be read in steps of 0.01 to 100 of its samples, not " + std::to_string(step) + ".");
    if (x.empty())
        return {};
    const auto count = static_cast<std::size_t>(std::floor(static_cast<double>(x.size() - 1) / step)) + 1;
    std::vector<double> output(count + 64);
    const auto io = soxr_io_spec(SOXR_FLOAT64_I, SOXR_FLOAT64_I);
    auto quality = soxr_quality_spec(SOXR_VHQ, SOXR_HI_PREC_CLOCK);
    quality.passband_end = 0.96;
    const auto runtime = soxr_runtime_spec(1);
    std::size_t done = 0;
    const auto failure = soxr_oneshot(step, 1.0, 1, x.data(), x.size(), nullptr, output.data(), output.size(), &done,
                                      &io, &quality, &runtime);
    if (failure || done + 2 < count)
        throw Error(Error::Kind::numerical,
                    std::string("Resampling failed: ") + (failure ? failure : "too few samples came out"));
    output.resize(count);  // one that rounding left out is zero
    return output;
}

}  // namespace excursion
