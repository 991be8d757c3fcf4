// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Import/ResponseCurve.h"

#include "Engine/Error.h"
#include "Engine/Measurement/ImportImpedance.h"
#include "Engine/Signal/Fft.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace excursion {
namespace {

constexpr double largestCorrection = 60.0;   // dB; beyond it a file is no microphone's

double toDb(std::complex<double> value) { return 20.0 * std::log10(std::max(std::abs(value), 1e-20)); }

/// The minimum phase that belongs to a magnitude, by its cepstrum, on `length` bins of the unit circle.
std::vector<std::complex<double>> withMinimumPhase(const ResponseCurve& magnitude, double sampleRate, std::size_t length)
{
    std::vector<std::complex<double>> logarithm(length / 2 + 1);
    for (std::size_t k = 0; k < logarithm.size(); ++k) {
        const double frequency = std::max<double>(static_cast<double>(k), 0.5) * sampleRate / static_cast<double>(length);
        logarithm[k] = magnitude.db(frequency) * std::numbers::ln10 / 20.0;
    }
    auto cepstrum = inverseFft(logarithm, length);
    for (std::size_t n = 1; n < length / 2; ++n) {
        cepstrum[n] *= 2.0;
        cepstrum[length - n] = 0.0;
    }
    auto response = fft(cepstrum);
    for (auto& value : response)
        value = std::exp(value);
    return response;
}

} // namespace

ResponseCurve::ResponseCurve(std::vector<double> frequency, const std::vector<std::complex<double>>& value)
{
    double before = 0.0;
    for (std::size_t k = 0; k < frequency.size(); ++k) {
        logFrequency_.push_back(std::log(frequency[k]));
        db_.push_back(toDb(value[k]));
        const double phase = std::arg(value[k]);
        before = k == 0 ? phase : before + std::remainder(phase - before, 2.0 * std::numbers::pi);
        phase_.push_back(before);
    }
}

std::complex<double> ResponseCurve::operator()(double frequency) const
{
    const double x = std::log(std::max(frequency, 1e-6));
    const auto above = static_cast<std::size_t>(std::upper_bound(logFrequency_.begin(), logFrequency_.end(), x) - logFrequency_.begin());
    const auto low = above == 0 ? 0 : above - 1, high = std::min(above, logFrequency_.size() - 1);
    const double width = logFrequency_[high] - logFrequency_[low];
    const double part = width > 0 ? std::clamp((x - logFrequency_[low]) / width, 0.0, 1.0) : 0.0;
    const double db = db_[low] + part * (db_[high] - db_[low]), phase = phase_[low] + part * (phase_[high] - phase_[low]);
    return std::polar(std::pow(10.0, db / 20.0), phase);
}

double ResponseCurve::db(double frequency) const { return toDb((*this)(frequency)); }

ResponseCurve readMicrophoneCurve(const std::filesystem::path& path, double reference, double sampleRate)
{
    const auto file = readFrd(path);
    const bool phases = std::any_of(file.value.begin(), file.value.end(), [](const auto& v) { return v.imag() != 0.0; });
    for (std::size_t k = 0; k < file.frequency.size(); ++k)
        if (std::abs(toDb(file.value[k])) > largestCorrection)
            throw Error(Error::Kind::input, "'" + path.string() + "' has a correction beyond 60 dB at " + std::to_string(file.frequency[k])
                                                + " Hz; a microphone's response in dB is expected.");
    const ResponseCurve given(file.frequency, file.value);
    auto frequency = file.frequency;
    std::vector<std::complex<double>> value;
    if (phases) {
        value = file.value;
    } else {
        constexpr std::size_t length = 1u << 17;
        const auto minimum = withMinimumPhase(given, sampleRate, length);
        frequency.clear();
        for (std::size_t k = 1; k < minimum.size(); ++k) {
            frequency.push_back(static_cast<double>(k) * sampleRate / static_cast<double>(length));
            value.push_back(minimum[k]);
        }
    }
    const double there = std::abs(given(reference));
    for (auto& v : value)
        v /= there;
    return {std::move(frequency), value};
}

} // namespace excursion
