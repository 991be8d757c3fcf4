// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/BlackBox/Stimulus.h"

#include "Engine/Error.h"
#include "Engine/Signal/Fft.h"
#include "Engine/Validity.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <numbers>
#include <numeric>
#include <random>

namespace excursion {
namespace {

constexpr double noiseDensity = 1e-6;  // of the largest one

/// Bands are counted from the one around 1 kHz.
int bandOf(double frequency) { return static_cast<int>(std::lround(3.0 * std::log2(frequency / 1000.0))); }
double centreOf(int band) { return 1000.0 * std::exp2(band / 3.0); }
double widthOf(double centre) { return centre * (std::exp2(1.0 / 6.0) - std::exp2(-1.0 / 6.0)); }

}  // namespace

double Stimulus::lowest() const { return frequency.front() * std::exp2(-1.0 / 6.0); }
double Stimulus::highest() const { return frequency.back() * std::exp2(1.0 / 6.0); }

bool Stimulus::isValid(std::string* reason) const
{
    if (!(rms > 0.0 && std::isfinite(rms)) || !(peak >= rms && std::isfinite(peak)))
        return refuse(reason, "a stimulus has an rms value above 0 and a peak that is not below it");
    if (frequency.empty() || frequency.size() != power.size())
        return refuse(reason, "a stimulus has at least one band, and one power a band");
    for (std::size_t k = 0; k < frequency.size(); ++k)
        if (!(frequency[k] > 0.0 && std::isfinite(frequency[k])) || (k > 0 && frequency[k] <= frequency[k - 1])
            || !(power[k] > 0.0 && std::isfinite(power[k])))
            return refuse(reason, "the bands of a stimulus ascend from above 0 Hz, and hold power");
    return true;
}

Stimulus stimulusOf(const std::vector<InputOutputRecord>& records, double sampleRate)
{
    Stimulus result;
    std::map<int, double> bands;
    double samples = 0.0, power = 0.0;
    for (const auto& record : records) {
        const auto judged = record.input.rows() - record.skip;
        if (record.input.cols() != 1 || judged < 2)
            throw Error(Error::Kind::data, "A stimulus is one of a single input, of at least two samples.");
        result.peak = std::max(result.peak, record.input.cwiseAbs().maxCoeff());
        Eigen::VectorXd u = record.input.bottomRows(judged);
        u.array() -= u.mean();
        // A stretch of a signal without period is windowed, so that its ends do not fill all bands.
        double window = 1.0;
        if (!record.periodic) {
            const Eigen::ArrayXd phase = Eigen::ArrayXd::LinSpaced(judged, 0.0, 2.0 * std::numbers::pi);
            u.array() *= 0.5 - 0.5 * phase.cos();
            window = 8.0 / 3.0;
        }
        const auto N = static_cast<std::size_t>(judged);
        const auto X = fft({u.data(), N});
        for (std::size_t k = 1; 2 * k < N; ++k) {
            const double one = window * 2.0 * std::norm(X[k]) / static_cast<double>(N);
            bands[bandOf(static_cast<double>(k) * sampleRate / static_cast<double>(N))] += one;
            power += one;
        }
        samples += static_cast<double>(N);
    }
    if (!(power > 0.0))
        throw Error(Error::Kind::data, "The input of the records is silent.");
    double most = 0.0;
    for (const auto& [band, sum] : bands)
        most = std::max(most, sum / widthOf(centreOf(band)));
    for (const auto& [band, sum] : bands)
        if (sum / widthOf(centreOf(band)) > noiseDensity * most) {
            result.frequency.push_back(centreOf(band));
            result.power.push_back(sum / samples);
        }
    result.rms = std::sqrt(power / samples);
    result.peak = std::max(result.peak, result.rms);
    return result;
}

std::vector<double> playedAs(const Stimulus& stimulus, double sampleRate, int period, std::uint64_t seed,
                             std::vector<int>* excited)
{
    std::map<int, double> power;
    for (std::size_t b = 0; b < stimulus.frequency.size(); ++b)
        power[bandOf(stimulus.frequency[b])] += stimulus.power[b];
    std::mt19937_64 random(seed);
    const auto draw = [&random] { return static_cast<double>(random() >> 11) * 0x1p-53; };
    std::vector<int> lines;
    std::map<int, int> members;
    int group = 0, missing = 0;
    for (int k = 1; 2 * k < period - 1; k += 2, ++group) {
        if (group % 4 == 0)
            missing = static_cast<int>(4.0 * draw());
        const int band = bandOf(k * sampleRate / period);
        if (group % 4 == missing || !power.contains(band))
            continue;
        lines.push_back(k);
        ++members[band];
    }
    if (lines.size() < 3)
        throw Error(Error::Kind::usage,
                    "A period of " + std::to_string(period) + " samples holds no lines of the stimulus.");
    std::vector<std::complex<double>> X(static_cast<std::size_t>(period / 2 + 1));
    double sum = 0.0;
    for (const int k : lines) {
        const int band = bandOf(k * sampleRate / period);
        const double amplitude = std::sqrt(2.0 * power[band] / members[band]);
        X[static_cast<std::size_t>(k)] = std::polar(0.5 * amplitude * period, 2.0 * std::numbers::pi * draw());
        sum += 0.5 * amplitude * amplitude;
    }
    // The bands that no line fell into give theirs to the others.
    double playable = 0.0;
    for (const auto& [band, one] : power)
        if (centreOf(band) < 0.5 * sampleRate)
            playable += one;
    const double scale = std::sqrt(playable / sum);
    for (auto& value : X)
        value *= scale;
    if (excited)
        *excited = lines;
    return inverseFft(X, static_cast<std::size_t>(period));
}

int periodFor(const Stimulus& stimulus, double sampleRate)
{
    int period = 4096;
    while (period < 1 << 16 && sampleRate / period > 0.25 * stimulus.lowest())
        period *= 2;
    return period;
}

nlohmann::ordered_json toJson(const Stimulus& stimulus)
{
    return {
        {"rms", stimulus.rms}, {"peak", stimulus.peak}, {"frequency", stimulus.frequency}, {"power", stimulus.power}};
}

std::optional<Stimulus> stimulusFrom(const JsonField& document)
{
    if (!document.has("stimulus"))
        return std::nullopt;
    const auto field = document.at("stimulus");
    Stimulus stimulus;
    stimulus.rms = field.at("rms").number();
    stimulus.peak = field.at("peak").number();
    stimulus.frequency = field.at("frequency").numbers();
    stimulus.power = field.at("power").numbers();
    if (std::string reason; !stimulus.isValid(&reason))
        field.refuse("a stimulus, but " + reason);
    return stimulus;
}

}  // namespace excursion
