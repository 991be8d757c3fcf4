// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Signal/Fft.h"

#include <algorithm>
#include <fftw3.h>

#include <map>
#include <memory>
#include <mutex>
#include <stdexcept>

namespace excursion {
namespace {

// Planning is not thread-safe in FFTW and costs more than a transform; executing a plan on other
// arrays is thread-safe. So plans are made once a length, unaligned, and kept.
fftw_plan plan(std::size_t N, bool forward)
{
    struct Destroy {
        void operator()(fftw_plan p) const { fftw_destroy_plan(p); }
    };
    using Plan = std::unique_ptr<std::remove_pointer_t<fftw_plan>, Destroy>;
    static std::mutex mutex;
    static std::map<std::pair<std::size_t, bool>, Plan> plans;

    const std::lock_guard lock(mutex);
    auto& kept = plans[{N, forward}];
    if (!kept) {
        std::vector<double> x(N);
        std::vector<std::complex<double>> X(N / 2 + 1);
        auto* spectrum = reinterpret_cast<fftw_complex*>(X.data());
        const auto n = static_cast<int>(N);
        const unsigned flags = FFTW_ESTIMATE | FFTW_UNALIGNED;
        kept.reset(forward ? fftw_plan_dft_r2c_1d(n, x.data(), spectrum, flags | FFTW_PRESERVE_INPUT)
                           : fftw_plan_dft_c2r_1d(n, spectrum, x.data(), flags));
    }
    return kept.get();
}

}  // namespace

std::vector<std::complex<double>> fft(std::span<const double> x)
{
    if (x.empty())
        return {};
    std::vector<std::complex<double>> X(x.size() / 2 + 1);
    // A plan made with PRESERVE_INPUT does not write to x.
    fftw_execute_dft_r2c(plan(x.size(), true), const_cast<double*>(x.data()),
                         reinterpret_cast<fftw_complex*>(X.data()));
    return X;
}

std::vector<double> inverseFft(std::span<const std::complex<double>> X, std::size_t N)
{
    if (X.size() != N / 2 + 1)
        throw std::invalid_argument("inverseFft: a real record of length N has N/2 + 1 spectral values");
    std::vector<std::complex<double>> scratch(X.begin(), X.end());
    std::vector<double> x(N);
    fftw_execute_dft_c2r(plan(N, false), reinterpret_cast<fftw_complex*>(scratch.data()), x.data());
    for (auto& value : x)
        value /= static_cast<double>(N);
    return x;
}

std::size_t quickLength(std::size_t n)
{
    for (n = std::max<std::size_t>(2, n + n % 2);; n += 2) {
        auto rest = n;
        for (const std::size_t prime : {2u, 3u, 5u})
            while (rest % prime == 0)
                rest /= prime;
        if (rest == 1)
            return n;
    }
}

}  // namespace excursion
