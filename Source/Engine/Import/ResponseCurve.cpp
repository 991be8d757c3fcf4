// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Import/ResponseCurve.h"

#include "Engine/Error.h"
#include "Engine/Import/CurveTable.h"
#include "Engine/Signal/MinimumPhase.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace excursion {
namespace {

constexpr double largestCorrection = 60.0;  // dB; beyond it a file is no microphone's

double toDb(std::complex<double> value) { return 20.0 * std::log10(std::max(std::abs(value), 1e-20)); }

}  // namespace

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
    const auto above = static_cast<std::size_t>(std::upper_bound(logFrequency_.begin(), logFrequency_.end(), x)
                                                - logFrequency_.begin());
    const auto low = above == 0 ? 0 : above - 1, high = std::min(above, logFrequency_.size() - 1);
    const double width = logFrequency_[high] - logFrequency_[low];
    const double part = width > 0 ? std::clamp((x - logFrequency_[low]) / width, 0.0, 1.0) : 0.0;
    const double db = db_[low] + part * (db_[high] - db_[low]),
                 phase = phase_[low] + part * (phase_[high] - phase_[low]);
    return std::polar(std::pow(10.0, db / 20.0), phase);
}

double ResponseCurve::db(double frequency) const { return toDb((*this)(frequency)); }

ResponseCurve readMicrophoneCurve(const std::filesystem::path& path, double reference)
{
    constexpr double radian = std::numbers::pi / 180.0;
    const auto table = readCurveTable(path, 3, "a microphone's curve has frequencies in Hz and its response in dB");
    const auto frequency = table.column(0), db = table.column(1);
    const auto degrees = table.titles().size() > 2 ? table.column(2) : std::vector<double>();
    std::vector<double> magnitude;
    for (std::size_t k = 0; k < frequency.size(); ++k) {
        if (std::abs(db[k]) > largestCorrection)
            throw Error(Error::Kind::input, "'" + path.string() + "' has a correction beyond 60 dB at "
                                                + std::to_string(frequency[k])
                                                + " Hz; a microphone's response in dB is expected.");
        magnitude.push_back(std::pow(10.0, db[k] / 20.0));
    }
    const bool phases = std::any_of(degrees.begin(), degrees.end(), [](double d) { return d != 0.0; });
    const auto minimum = phases ? std::vector<double>() : minimumPhase(frequency, magnitude);
    std::vector<std::complex<double>> value;
    for (std::size_t k = 0; k < frequency.size(); ++k)
        value.push_back(std::polar(magnitude[k], phases ? degrees[k] * radian : minimum[k]));
    const double there = std::abs(ResponseCurve(frequency, value)(reference));
    for (auto& v : value)
        v /= there;
    return {frequency, value};
}

}  // namespace excursion
