// SPDX-License-Identifier: GPL-3.0-or-later
#include "Engine/Loudspeaker/ShownMotion.h"

#include "Engine/Loudspeaker/SensorResponse.h"
#include "Engine/Signal/Fft.h"
#include "Engine/Take/Motion.h"

#include <cmath>
#include <cstdlib>
#include <numbers>

namespace excursion {
namespace {

using Complex = std::complex<double>;

constexpr double sure = 3.0;  // times its noise: a line that is told

/// s^n, n times over: a power of complex numbers costs a logarithm.
Complex repeated(Complex s, int n)
{
    Complex result = 1.0;
    for (int k = 0; k < std::abs(n); ++k)
        result *= s;
    return n < 0 ? 1.0 / result : result;
}

/// A measured value with its variance.
struct Told {
    Complex value;
    double variance;

    bool isSure() const { return std::norm(value) > sure * sure * variance; }
};

/// A measured line as it is before its sensor.
Complex unsensed(const Model& model, const Record& record, const Section& section, std::size_t channel,
                 std::size_t line)
{
    const auto sensor = sensorOf(model, record.channels[channel]);
    const auto measured = section.measured[channel][line];
    return sensor.immediate()
               ? measured
               : measured / sensor(Complex(0.0, 2.0 * std::numbers::pi * record.frequency(section, line)));
}

/// The mean of a line of displacement over the channels that tell it.
Told displacementAt(const Model& model, const Record& record, const Section& section, std::size_t line)
{
    const Complex s(0.0, 2.0 * std::numbers::pi * record.frequency(section, line));
    Complex sum = 0.0;
    double weights = 0.0;
    for (std::size_t c = 0; c < record.channels.size(); ++c)
        if (const auto order = integrationsToDisplacement(record.channels[c])) {
            const auto scale = repeated(s, -*order);
            const Told told {scale * unsensed(model, record, section, c, line),
                             std::norm(scale) * section.deviation[c][line] * section.deviation[c][line]};
            if (told.isSure()) {
                sum += told.value / told.variance;
                weights += 1.0 / told.variance;
            }
        }
    return weights > 0.0 ? Told {sum / weights, 1.0 / weights} : Told {0.0, 1.0};
}

/// The record of a derivative of a spectrum of N/2 + 1 lines, ShownMotion::fine values a sample.
std::vector<double> played(const Spectrum& spectrum, std::size_t N, int derivative, double sampleRate)
{
    constexpr auto fine = ShownMotion::fine;
    Spectrum wide(fine * N / 2 + 1, 0.0);
    const double step = 2.0 * std::numbers::pi * sampleRate / static_cast<double>(N);
    for (std::size_t k = 0; k < std::min(spectrum.size(), (N + 1) / 2); ++k)
        wide[k] = spectrum[k] * static_cast<double>(fine)
                  * repeated(Complex(0.0, step * static_cast<double>(k)), derivative);
    if (derivative > 0)
        wide[0] = 0.0;
    return inverseFft(wide, fine * N);
}

}  // namespace

ShownMotion shownMotion(const Model& model, const Record& record, const Section& section, const Spectrum& current,
                        const Spectrum& displacement)
{
    const std::size_t N = section.window;
    Spectrum I = current, X = displacement;
    const auto coil = record.channelIndex(Quantity::current);
    const auto [first, last] = record.lineRange(section);
    for (std::size_t k = first; k <= last; ++k) {
        if (coil)
            if (const Told told {unsensed(model, record, section, *coil, k), std::pow(section.deviation[*coil][k], 2)};
                told.isSure())
                I[k] = told.value;
        if (const auto told = displacementAt(model, record, section, k); told.isSure())
            X[k] = told.value;
    }
    const auto motion = [&](const Spectrum& of, int derivative) {
        return played(of, N, derivative, record.sampleRate);
    };
    return {motion(I, 0), motion(I, 1), motion(X, 0), motion(X, 1), motion(X, 2)};
}

PeriodicMotion everySample(const ShownMotion& motion)
{
    const auto thinned = [](const std::vector<double>& values) {
        std::vector<double> result(values.size() / ShownMotion::fine);
        for (std::size_t n = 0; n < result.size(); ++n)
            result[n] = values[n * ShownMotion::fine];
        return result;
    };
    return {thinned(motion.i), thinned(motion.x), thinned(motion.v)};
}

}  // namespace excursion
